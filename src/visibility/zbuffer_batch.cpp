// Raster stage of the z-buffer, the common case: triangles of a few pixels, a vector of them at a
// time.
//
// Most meshes are made of triangles that own from none to ten samples, so the work is in their
// set-up. Here it is done for as many triangles as a vector has 32-bit lanes: corners are gathered,
// edge functions taken at the corner of each box (all corners lie within 2^14 units of each other,
// so 32 bits hold them exactly), planes in double precision (whose integers are exact below 2^53,
// so these are the quotients of depth_gradient()), and what is empty or hidden is dropped.
// Triangles whose box is one sample are then only compared; the others are walked row by row. What
// does not fit (large, steep, pieces of clipped triangles) goes to draw_large().
#include <algorithm>
#include <bit>
#include <limits>

#include "visibility/zbuffer_stages.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "visibility/zbuffer_batch.cpp"
#include <hwy/foreach_target.h>
// foreach_target comes first.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "visibility/zbuffer_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::zbuffer::HWY_NAMESPACE {
namespace {

/// Triangles between two updates of the hierarchical depth.
constexpr std::uint32_t kRefreshAfter = 48;

// The greatest depth that the tile holds under each box.
HWY_INLINE VF depth_behind(const Tile& tile, const Lanes& t, M kept) {
    constexpr int kBits = Tile::kBlockBits;
    const VI c0 = hn::ShiftRight<kBits>(t.column0), r0 = hn::ShiftRight<kBits>(t.row0);
    const VI c1 = hn::ShiftRight<kBits>(hn::Add(t.column0, t.columns));
    const VI r1 = hn::ShiftRight<kBits>(hn::Add(t.row0, t.rows));
    // The boxes of other lanes may lie anywhere.
    const M adjacent = hn::And(hn::Lt(hn::Sub(c1, c0), set(2)), hn::Lt(hn::Sub(r1, r0), set(2)));
    const M near_by = hn::And(kept, adjacent);
    const auto at = [&](VI c, VI r) {
        const VI block = hn::Add(hn::Mul(r, set(Tile::kBlocks)), c);
        return hn::GatherIndex(kF, tile.block_max, hn::IfThenElseZero(near_by, block));
    };
    const VF most = hn::Max(hn::Max(at(c0, r0), at(c1, r0)), hn::Max(at(c0, r1), at(c1, r1)));
    return hn::IfThenElse(hn::RebindMask(kF, near_by), most, hn::Set(kF, tile.tile_max));
}

struct Outcome {
    M regular, large, hidden;
};

HWY_INLINE Outcome judge_depth(const Tile& tile, const Lanes& t, int step_bits, M kept) {
    const DepthRange range = depth_over_box(t, step_bits);
    M hidden = hn::Ne(t.number, t.number);
    if (tile.knows_depth)
        hidden = hn::RebindMask(
            kI, hn::Gt(hn::Sub(range.least, hn::Set(kF, kUncertain)), depth_behind(tile, t, kept)));
    const M usable = hn::And(kept, range.regular);
    return {hn::AndNot(hidden, usable), hn::AndNot(range.regular, kept), hn::And(hidden, usable)};
}

// What the walk over a box needs, a triangle a lane.
struct Stored {
    HWY_ALIGN std::int32_t edges[9][kLanes];
    HWY_ALIGN std::int32_t number[kLanes], column0[kLanes], row0[kLanes], columns[kLanes],
        rows[kLanes], dx0[kLanes], dy0[kLanes];
    HWY_ALIGN float gx[kLanes], gy[kLanes], z0[kLanes];
};

HWY_INLINE void store(const Lanes& t, Stored& s) {
    for (int k = 0; k < 3; ++k) {
        hn::Store(t.edges.at[k], kI, s.edges[3 * k]);
        hn::Store(t.edges.per_column[k], kI, s.edges[3 * k + 1]);
        hn::Store(t.edges.per_row[k], kI, s.edges[3 * k + 2]);
    }
    hn::Store(t.number, kI, s.number);
    hn::Store(t.column0, kI, s.column0);
    hn::Store(t.row0, kI, s.row0);
    hn::Store(t.columns, kI, s.columns);
    hn::Store(t.rows, kI, s.rows);
    hn::Store(t.dx0, kI, s.dx0);
    hn::Store(t.dy0, kI, s.dy0);
    hn::Store(t.gx, kF, s.gx);
    hn::Store(t.gy, kF, s.gy);
    hn::Store(t.z0, kF, s.z0);
}

class Batch {
public:
    Batch(const RasterInput& input, Tile& tile, TileCounts& counts)
        : input_(input), grid_(input.grid), tile_(tile), counts_(counts) {}

    void draw(std::span<const std::uint32_t> triangles) {
        for_each_vector(
            input_.screen, triangles.size(),
            [&](std::size_t i) HWY_ATTR { return fetch_from(triangles, i); },
            [&](const Fetched& fetched, const CornerLanes& points) HWY_ATTR {
                draw_vector(fetched, points);
                if (tile_.drawn >= kRefreshAfter) refresh_depth();
            });
    }

private:
    HWY_INLINE Fetched fetch_from(std::span<const std::uint32_t> triangles, std::size_t i) const {
        const std::size_t lanes = hn::Lanes(kI);
        if (i + lanes <= triangles.size())
            return fetch(input_.screen, hn::BitCast(kI, hn::LoadU(kU, triangles.data() + i)),
                         lanes);
        HWY_ALIGN std::uint32_t tail[kLanes] = {};
        std::copy(triangles.begin() + static_cast<std::ptrdiff_t>(i), triangles.end(), tail);
        return fetch(input_.screen, hn::BitCast(kI, hn::Load(kU, tail)), triangles.size() - i);
    }

    HWY_INLINE void draw_vector(const Fetched& fetched, const CornerLanes& points) {
        draw_each(fetched.number, hn::AndNot(fetched.whole, fetched.wanted));
        Lanes t;
        M large;
        const M kept = set_up_lanes(input_, tile_.area(), fetched, points, t, large);
        draw_each(t.number, large);
        if (hn::AllFalse(kI, kept)) return;
        finish_vector(t, judge_depth(tile_, t, grid_.step_bits, kept));
    }

    void finish_vector(const Lanes& t, const Outcome& outcome) {
        const std::uint32_t regular = bits_of(outcome.regular);
        const auto drawn = static_cast<std::uint32_t>(std::popcount(regular));
        const auto hidden = static_cast<std::uint64_t>(std::popcount(bits_of(outcome.hidden)));
        counts_.triangles += drawn + hidden;
        counts_.hidden += hidden;
        tile_.drawn += drawn;
        draw_each(t.number, outcome.large);
        if (regular == 0) return;
        store(t, stored_);
        const M point = hn::Eq(hn::Or(t.columns, t.rows), set(0));
        const std::uint32_t points = bits_of(hn::And(outcome.regular, point));
        for (std::uint32_t rest = points; rest != 0; rest &= rest - 1)
            draw_point(static_cast<std::size_t>(std::countr_zero(rest)));
        for (std::uint32_t rest = regular & ~points; rest != 0; rest &= rest - 1)
            draw_box(static_cast<std::size_t>(std::countr_zero(rest)));
    }

    void draw_each(VI number, M chosen) {
        if (hn::AllFalse(kI, chosen)) return;
        HWY_ALIGN std::int32_t numbers[kLanes];
        hn::Store(number, kI, numbers);
        for (std::uint32_t rest = bits_of(chosen); rest != 0; rest &= rest - 1)
            draw_large(input_, static_cast<std::uint32_t>(numbers[std::countr_zero(rest)]), tile_,
                       counts_);
    }

    // Some of the triangle's samples are too close to call for floats: integers decide. What it
    // owns already stays as it is, for taking a minimum twice changes nothing.
    HWY_NOINLINE void settle(std::size_t lane) {
        draw_large(input_, static_cast<std::uint32_t>(stored_.number[lane]), tile_, counts_);
    }

    // The box is one sample, and no edge has excluded it: the triangle covers it.
    HWY_INLINE void draw_point(std::size_t lane) {
        const float tx = stored_.gx[lane] * static_cast<float>(stored_.dx0[lane]);
        const float ty = stored_.gy[lane] * static_cast<float>(stored_.dy0[lane]);
        const float z = std::clamp(stored_.z0[lane] + (tx + ty), 0.0f, kStoredDepthMax);
        const std::size_t at = Tile::index(stored_.column0[lane], stored_.row0[lane]);
        const float old = tile_.depth[at];
        if (z > old + kUncertain) return;
        if (z < old - kUncertain) {
            tile_.depth[at] = z;
            tile_.ids[at] = static_cast<std::uint32_t>(stored_.number[lane]);
            return;
        }
        settle(lane);
    }

    // All rows, in aligned vectors of columns: the next triangle will most likely want the same
    // ones, and a load that a masked or shifted store overlaps has to wait for it.
    HWY_INLINE void draw_box(std::size_t lane) {
        const auto lanes = static_cast<std::int32_t>(hn::Lanes(kI));
        const std::int32_t column0 = stored_.column0[lane];
        const std::int32_t last = column0 + stored_.columns[lane];
        bool doubtful = false;
        for (std::int32_t column = column0 & -lanes; column <= last; column += lanes)
            doubtful |= draw_columns(lane, column);
        if (HWY_UNLIKELY(doubtful)) settle(lane);
    }

    // Columns `column`..; those outside of the box are outside of the triangle, but for some beyond
    // the picture's border, which nobody reads. Returns whether a sample was too close to call.
    HWY_INLINE bool draw_columns(std::size_t lane, std::int32_t column) {
        const std::int32_t step = 1 << grid_.step_bits;
        const VI index = hn::Add(hn::Iota(kI, 0), set(column - stored_.column0[lane]));
        const auto along = [&](int k) {
            return hn::Add(set(stored_.edges[3 * k][lane]),
                           hn::Mul(index, set(stored_.edges[3 * k + 1][lane])));
        };
        VI e0 = along(0), e1 = along(1), e2 = along(2);
        const VI down0 = set(stored_.edges[2][lane]), down1 = set(stored_.edges[5][lane]),
                 down2 = set(stored_.edges[8][lane]);
        const VI dx = hn::Add(set(stored_.dx0[lane]), hn::Mul(index, set(step)));
        const VF tx = hn::Mul(hn::Set(kF, stored_.gx[lane]), hn::ConvertTo(kF, dx));
        const VF z0 = hn::Set(kF, stored_.z0[lane]), margin = hn::Set(kF, kUncertain);
        const auto id = hn::Set(kU, static_cast<std::uint32_t>(stored_.number[lane]));
        const float gy = stored_.gy[lane];
        std::int32_t dy = stored_.dy0[lane];
        std::size_t at = Tile::index(column, stored_.row0[lane]);
        const std::size_t end =
            at + Tile::kStride * static_cast<std::size_t>(stored_.rows[lane] + 1);
        auto doubtful = hn::Lt(margin, margin);
        for (; at != end; at += Tile::kStride, dy += step) {
            const auto covered = hn::RebindMask(kF, hn::Gt(hn::Or(e0, hn::Or(e1, e2)), set(-1)));
            const VF ty = hn::Set(kF, gy * static_cast<float>(dy));
            const VF z = stored_depth_of(z0, tx, ty);
            const VF old = hn::Load(kF, tile_.depth + at);
            const auto nearer = hn::And(covered, hn::Lt(z, hn::Sub(old, margin)));
            const auto not_farther = hn::And(covered, hn::Le(z, hn::Add(old, margin)));
            doubtful = hn::Or(doubtful, hn::AndNot(nearer, not_farther));
            hn::Store(hn::IfThenElse(nearer, z, old), kF, tile_.depth + at);
            const auto owner = hn::Load(kU, tile_.ids + at);
            hn::Store(hn::IfThenElse(hn::RebindMask(kU, nearer), id, owner), kU, tile_.ids + at);
            e0 = hn::Add(e0, down0);
            e1 = hn::Add(e1, down1);
            e2 = hn::Add(e2, down2);
        }
        return !hn::AllFalse(kF, doubtful);
    }

    // Brings block_max and tile_max up to date.
    void refresh_depth() {
        const auto lanes = static_cast<std::uint32_t>(hn::Lanes(kI));
        tile_.drawn = 0;
        tile_.knows_depth = true;
        VF all = hn::Zero(kF);
        HWY_ALIGN float columns[kTileSize];
        constexpr std::uint32_t kSide = 1u << Tile::kBlockBits;
        for (std::uint32_t r = 0; r < Tile::kBlocks; ++r) {
            for (std::uint32_t c = 0; c < kTileSize; c += lanes) {
                const float* at = tile_.depth + std::size_t{r} * kSide * Tile::kStride + c;
                VF most = hn::LoadU(kF, at);
                for (std::uint32_t k = 1; k < kSide; ++k)
                    most = hn::Max(most, hn::LoadU(kF, at + std::size_t{k} * Tile::kStride));
                hn::Store(most, kF, columns + c);
                all = hn::Max(all, most);
            }
            for (std::uint32_t b = 0; b < Tile::kBlocks; ++b) {
                const float* c = columns + b * kSide;
                const float left = std::max(std::max(c[0], c[1]), std::max(c[2], c[3]));
                const float right = std::max(std::max(c[4], c[5]), std::max(c[6], c[7]));
                tile_.block_max[r * Tile::kBlocks + b] = std::max(left, right);
            }
        }
        tile_.tile_max = hn::GetLane(hn::MaxOfLanes(kF, all));
    }

    const RasterInput& input_;
    const GridUnits& grid_;
    Tile& tile_;
    TileCounts& counts_;
    Stored stored_;
};

void draw_batches(const RasterInput& input, std::span<const std::uint32_t> triangles, Tile& tile,
                  TileCounts& counts) {
    Batch(input, tile, counts).draw(triangles);
}

void clear(Tile& tile) {
    const VF empty = hn::Set(kF, std::numeric_limits<float>::infinity());
    const auto none = hn::Set(kU, kNone);
    for (std::size_t i = 0; i < std::size(tile.depth); i += hn::Lanes(kF)) {
        hn::Store(empty, kF, tile.depth + i);
        hn::Store(none, kU, tile.ids + i);
    }
    std::fill(std::begin(tile.block_max), std::end(tile.block_max),
              std::numeric_limits<float>::infinity());
    tile.tile_max = std::numeric_limits<float>::infinity();
    tile.knows_depth = false;
    tile.drawn = 0;
}

// Copies a row. The picture is not read again soon: full lines go past the caches.
template <class D>
HWY_INLINE void write_row(D d, const hn::TFromD<D>* from, std::size_t n, hn::TFromD<D>* to) {
    const std::size_t lanes = hn::Lanes(d);
    std::size_t i = 0;
    if (reinterpret_cast<std::uintptr_t>(to) % (lanes * sizeof(hn::TFromD<D>)) == 0)
        for (; i + lanes <= n; i += lanes) hn::Stream(hn::Load(d, from + i), d, to + i);
    std::copy(from + i, from + n, to + i);
}

// The same with one value.
template <class D>
HWY_INLINE void fill_row(D d, hn::TFromD<D> value, std::size_t n, hn::TFromD<D>* to) {
    const std::size_t lanes = hn::Lanes(d);
    const auto values = hn::Set(d, value);
    std::size_t i = 0;
    if (reinterpret_cast<std::uintptr_t>(to) % (lanes * sizeof(hn::TFromD<D>)) == 0)
        for (; i + lanes <= n; i += lanes) hn::Stream(values, d, to + i);
    std::fill(to + i, to + n, value);
}

// put(row, at): a row of the tile, and where it begins in the picture.
template <class Put>
HWY_INLINE void for_each_row(const Tile& tile, const GridUnits& grid, const Put& put) {
    for (std::int32_t row = 0; row < tile.height; ++row)
        put(row, static_cast<std::size_t>(tile.row + row) * static_cast<std::size_t>(grid.columns) +
                     static_cast<std::size_t>(tile.column));
    hwy::FlushStream();
}

void write(const Tile& tile, const GridUnits& grid, std::uint32_t* ids, float* depth) {
    const auto width = static_cast<std::size_t>(tile.width);
    for_each_row(tile, grid, [&](std::int32_t row, std::size_t at) HWY_ATTR {
        const std::size_t from = Tile::index(0, row);
        write_row(kU, tile.ids + from, width, ids + at);
        write_row(kF, tile.depth + from, width, depth + at);
    });
}

void write_empty(const Tile& tile, const GridUnits& grid, std::uint32_t* ids, float* depth) {
    const auto width = static_cast<std::size_t>(tile.width);
    for_each_row(tile, grid, [&](std::int32_t, std::size_t at) HWY_ATTR {
        fill_row(kU, kNone, width, ids + at);
        fill_row(kF, std::numeric_limits<float>::infinity(), width, depth + at);
    });
}

}  // namespace
}  // namespace sightline::zbuffer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::zbuffer {

HWY_EXPORT(draw_batches);
HWY_EXPORT(clear);
HWY_EXPORT(write);
HWY_EXPORT(write_empty);

void clear_tile(Tile& tile) { HWY_DYNAMIC_DISPATCH(clear)(tile); }

void draw_triangles(const RasterInput& input, std::span<const std::uint32_t> triangles, Tile& tile,
                    TileCounts& counts) {
    if (input.observer == nullptr) {
        HWY_DYNAMIC_DISPATCH(draw_batches)(input, triangles, tile, counts);
        return;
    }
    // A watcher wants to see the steps one by one.
    for (const std::uint32_t k : triangles) draw_large(input, k, tile, counts);
}

void write_tile(const Tile& tile, const GridUnits& grid, std::uint32_t* ids, float* depth) {
    HWY_DYNAMIC_DISPATCH(write)(tile, grid, ids, depth);
}

void write_empty_tile(const Tile& tile, const GridUnits& grid, std::uint32_t* ids, float* depth) {
    HWY_DYNAMIC_DISPATCH(write_empty)(tile, grid, ids, depth);
}

}  // namespace sightline::zbuffer
#endif  // HWY_ONCE
