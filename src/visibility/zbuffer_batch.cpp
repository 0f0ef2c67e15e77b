// Raster stage of the z-buffer, the common case: triangles of a few pixels, a vector of them at a
// time.
//
// Most meshes are made of triangles that own from none to ten samples, so the work is in their
// set-up. Here it is done for as many triangles as a vector has 32-bit lanes: corners are gathered,
// edge functions taken at the corner of each box (all corners lie within 2^14 units of each other,
// so 32 bits hold them exactly), planes in double precision (whose integers are exact below 2^53,
// so these are the quotients of depth_gradient()), and what is empty or hidden is dropped.
// Triangles whose box is one sample are then only compared; the others are walked cell by cell.
// What does not fit (large, steep, pieces of clipped triangles) goes to draw_large(). Between
// triangles a little of the tiles drawn before is written to the picture.
#include <algorithm>
#include <bit>
#include <limits>

#include "visibility/zbuffer_stages.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "visibility/zbuffer_batch.cpp"
#include <hwy/foreach_target.h>
// foreach_target comes first.
#include <hwy/highway.h>

#include "visibility/zbuffer_lanes-inl.hpp"
#include "visibility/zbuffer_write-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::zbuffer::HWY_NAMESPACE {
namespace {

/// Half-rows that are written to the picture after a vector of triangles, besides one a triangle.
constexpr int kHalfRowsAVector = 4;

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
    HWY_ALIGN std::int32_t right[3][kLanes], below[3][kLanes];  // increments a cell
    HWY_ALIGN std::int32_t number[kLanes], column0[kLanes], row0[kLanes], columns[kLanes],
        rows[kLanes], dx0[kLanes], dy0[kLanes];
    HWY_ALIGN float gx[kLanes], gy[kLanes], z0[kLanes];
};

HWY_INLINE void store(const Lanes& t, Stored& s) {
    for (int k = 0; k < 3; ++k) {
        hn::Store(t.edges.at[k], kI, s.edges[3 * k]);
        hn::Store(t.edges.per_column[k], kI, s.edges[3 * k + 1]);
        hn::Store(t.edges.per_row[k], kI, s.edges[3 * k + 2]);
        hn::Store(hn::ShiftLeft<Tile::kCellBits>(t.edges.per_column[k]), kI, s.right[k]);
        hn::Store(hn::ShiftLeft<Tile::kCellBits>(t.edges.per_row[k]), kI, s.below[k]);
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
    Batch(const RasterInput& input, Tile& tile, TileCounts& counts, TileWriter& writer)
        : input_(input), grid_(input.grid), tile_(tile), counts_(counts), writer_(writer) {}

    void draw(std::span<const std::uint32_t> triangles) {
        for_each_vector(
            input_.screen, triangles.size(),
            [&](std::size_t i) HWY_ATTR { return fetch_from(triangles, i); },
            [&](const Fetched& fetched, const CornerLanes& points) HWY_ATTR {
                draw_vector(fetched, points);
                write_some(writer_, kHalfRowsAVector);
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
        const auto look = [&](const CornerLanes& p, const Lanes& boxes, M boxed)
                              HWY_ATTR { return dismiss_hidden(p, boxes, boxed); };
        const M kept = set_up_lanes(input_, tile_.area(), fetched, points, look, t, large);
        draw_each(t.number, large);
        if (hn::AllFalse(kI, kept)) return;
        finish_vector(t, judge_depth(tile_, t, grid_.step_bits, kept));
    }

    // Hidden triangles, told by their nearest corner before planes are set up: no sample's true
    // depth is less. The conversion of z is off by at most 32, a stored depth by
    // kStoredDepthError, the difference by 64. Sheets' planes do not pass through the corners.
    static_assert(kUncertain - 64 - 32 > kStoredDepthError);
    HWY_INLINE M dismiss_hidden(const CornerLanes& p, const Lanes& t, M kept) {
        if (!tile_.knows_depth) return kept;
        const VF nearest = hn::Sub(hn::ConvertTo(kF, least(p.z)), hn::Set(kF, kUncertain));
        const M behind = hn::RebindMask(kI, hn::Gt(nearest, depth_behind(tile_, t, kept)));
        const M hidden = hn::AndNot(sheet_lanes(input_, t.number), hn::And(kept, behind));
        const auto count = static_cast<std::uint64_t>(std::popcount(bits_of(hidden)));
        counts_.triangles += count;
        counts_.hidden += count;
        return hn::AndNot(hidden, kept);
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
        for (std::uint32_t rest = regular & ~points; rest != 0; rest &= rest - 1) {
            draw_box(static_cast<std::size_t>(std::countr_zero(rest)));
            write_some(writer_, 1);
        }
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

    // All cells that the box meets: mostly no more than two by two, which are drawn to without a
    // branch. Samples of a cell outside of the box are outside of the triangle, but for some beyond
    // the picture's or the tile's border, which nobody reads.
    HWY_INLINE void draw_box(std::size_t lane) {
        bool doubtful = false;
        for (std::size_t part = 0; part < Tile::kCell; part += hn::Lanes(kI))
            doubtful |= draw_part(lane, part);
        if (HWY_UNLIKELY(doubtful)) settle(lane);
    }

    // A triangle in a vector's part of a cell.
    struct Walk {
        VI e[3];
        VI dx, dy;
        VF gx, gy, z0;
        hn::Vec<Uints> id;
        hn::Mask<Floats> doubtful;
    };

    // The samples from `part` on in each cell. Returns whether one was too close to call.
    HWY_INLINE bool draw_part(std::size_t lane, std::size_t part) {
        constexpr std::int32_t kIn = Tile::kCellSide - 1;
        const std::int32_t column0 = stored_.column0[lane], row0 = stored_.row0[lane];
        const VI in_cell = hn::Iota(kI, static_cast<std::int32_t>(part));
        const VI i = hn::Sub(hn::And(in_cell, set(kIn)), set(column0 & kIn));
        const VI j = hn::Sub(hn::ShiftRight<Tile::kCellBits>(in_cell), set(row0 & kIn));
        Walk w;
        for (int k = 0; k < 3; ++k)
            w.e[k] = hn::Add(set(stored_.edges[3 * k][lane]),
                             hn::Add(hn::Mul(i, set(stored_.edges[3 * k + 1][lane])),
                                     hn::Mul(j, set(stored_.edges[3 * k + 2][lane]))));
        w.dx = hn::Add(set(stored_.dx0[lane]), hn::ShiftLeftSame(i, grid_.step_bits));
        w.dy = hn::Add(set(stored_.dy0[lane]), hn::ShiftLeftSame(j, grid_.step_bits));
        w.gx = hn::Set(kF, stored_.gx[lane]);
        w.gy = hn::Set(kF, stored_.gy[lane]);
        w.z0 = hn::Set(kF, stored_.z0[lane]);
        w.id = hn::Set(kU, static_cast<std::uint32_t>(stored_.number[lane]));
        w.doubtful = hn::Lt(w.gx, w.gx);
        const std::size_t at = Tile::index(column0 & ~kIn, row0 & ~kIn) + part;
        const std::int32_t right = (column0 & kIn) + stored_.columns[lane];
        const std::int32_t below = (row0 & kIn) + stored_.rows[lane];
        if (HWY_LIKELY((right | below) < 2 * Tile::kCellSide))
            draw_cells(lane, at, 1, 1, w);
        else
            draw_cells(lane, at, right >> Tile::kCellBits, below >> Tile::kCellBits, w);
        return !hn::AllFalse(kF, w.doubtful);
    }

    // The first cell and `right` by `below` further ones.
    HWY_INLINE void draw_cells(std::size_t lane, std::size_t at, std::int32_t right,
                               std::int32_t below, Walk& w) {
        const VI step = set(Tile::kCellSide << grid_.step_bits);
        for (std::int32_t r = 0;; ++r, at += Tile::kCellRow) {
            VI e[3] = {w.e[0], w.e[1], w.e[2]};
            VI dx = w.dx;
            const VF ty = hn::Mul(w.gy, hn::ConvertTo(kF, w.dy));
            for (std::int32_t c = 0;; ++c) {
                const VF tx = hn::Mul(w.gx, hn::ConvertTo(kF, dx));
                offer(e, stored_depth_of(w.z0, tx, ty),
                      at + static_cast<std::size_t>(c) * Tile::kCell, w);
                if (c == right) break;
                for (int k = 0; k < 3; ++k) e[k] = hn::Add(e[k], set(stored_.right[k][lane]));
                dx = hn::Add(dx, step);
            }
            if (r == below) break;
            for (int k = 0; k < 3; ++k) w.e[k] = hn::Add(w.e[k], set(stored_.below[k][lane]));
            w.dy = hn::Add(w.dy, step);
        }
    }

    // Whole vectors are stored, not masked ones: the next triangle most likely wants the same
    // samples, and a load that a masked or shifted store overlaps has to wait for it.
    HWY_INLINE void offer(const VI e[3], VF z, std::size_t at, Walk& w) {
        const VF margin = hn::Set(kF, kUncertain);
        const auto covered = hn::RebindMask(kF, hn::Gt(hn::Or(e[0], hn::Or(e[1], e[2])), set(-1)));
        const VF old = hn::Load(kF, tile_.depth + at);
        const auto nearer = hn::And(covered, hn::Lt(z, hn::Sub(old, margin)));
        const auto not_farther = hn::And(covered, hn::Le(z, hn::Add(old, margin)));
        w.doubtful = hn::Or(w.doubtful, hn::AndNot(nearer, not_farther));
        hn::Store(hn::IfThenElse(nearer, z, old), kF, tile_.depth + at);
        const auto owner = hn::Load(kU, tile_.ids + at);
        hn::Store(hn::IfThenElse(hn::RebindMask(kU, nearer), w.id, owner), kU, tile_.ids + at);
    }

    // Brings block_max and tile_max up to date.
    void refresh_depth() {
        tile_.drawn = 0;
        tile_.knows_depth = true;
        float all = 0;
        for (std::uint32_t b = 0; b < Tile::kBlocks * Tile::kBlocks; ++b) {
            const auto column = static_cast<std::int32_t>(b % Tile::kBlocks << Tile::kBlockBits);
            const auto row = static_cast<std::int32_t>(b / Tile::kBlocks << Tile::kBlockBits);
            const float* at = tile_.depth + Tile::index(column, row);
            VF most = hn::Zero(kF);
            for (std::size_t k = 0; k < 2 * Tile::kCell; k += hn::Lanes(kF))
                most = hn::Max(
                    most, hn::Max(hn::Load(kF, at + k), hn::Load(kF, at + Tile::kCellRow + k)));
            tile_.block_max[b] = hn::GetLane(hn::MaxOfLanes(kF, most));
            all = std::max(all, tile_.block_max[b]);
        }
        tile_.tile_max = all;
    }

    const RasterInput& input_;
    const GridUnits& grid_;
    Tile& tile_;
    TileCounts& counts_;
    TileWriter& writer_;
    Stored stored_;
};

void draw_batches(const RasterInput& input, std::span<const std::uint32_t> triangles, Tile& tile,
                  TileCounts& counts, TileWriter& writer) {
    Batch(input, tile, counts, writer).draw(triangles);
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

}  // namespace
}  // namespace sightline::zbuffer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::zbuffer {

HWY_EXPORT(draw_batches);
HWY_EXPORT(clear);
HWY_EXPORT(write_all);
HWY_EXPORT(write_drawn);

void clear_tile(Tile& tile) { HWY_DYNAMIC_DISPATCH(clear)(tile); }

void draw_triangles(const RasterInput& input, std::span<const std::uint32_t> triangles, Tile& tile,
                    TileCounts& counts, TileWriter& writer) {
    if (input.observer == nullptr) {
        HWY_DYNAMIC_DISPATCH(draw_batches)(input, triangles, tile, counts, writer);
        return;
    }
    // A watcher wants to see the steps one by one.
    for (const std::uint32_t k : triangles) draw_large(input, k, tile, counts);
}

void write_rest(TileWriter& writer) { HWY_DYNAMIC_DISPATCH(write_all)(writer); }

void write_drawn_tile(TileWriter& writer) { HWY_DYNAMIC_DISPATCH(write_drawn)(writer); }

}  // namespace sightline::zbuffer
#endif  // HWY_ONCE
