// Geometry stage of the z-buffer: triangles whose box is at most three by three samples.
//
// In dense meshes most triangles are of this kind. They are drawn where their corners are already
// in the cache, a vector of triangles at a time, to points: place, depth and id of each sample that
// they cover. Tiles then only compare the points that fall into them.
#include <algorithm>
#include <bit>

#include "visibility/zbuffer_stages.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "visibility/zbuffer_tiny.cpp"
#include <hwy/foreach_target.h>
// foreach_target comes first.
#include <hwy/highway.h>

#include "visibility/zbuffer_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::zbuffer::HWY_NAMESPACE {
namespace {

class TinyPainter {
public:
    TinyPainter(const RasterInput& input, Selected& selected, Points& out)
        : input_(input), grid_(input.grid), selected_(selected), out_(out) {}

    void draw() {
        if (input_.observer != nullptr) {  // who watches wants to see whole triangles
            for (std::size_t i = 0; i < selected_.tiny_count; ++i) append_other(selected_.tiny[i]);
            return;
        }
        const std::size_t lanes = hn::Lanes(kI), count = selected_.tiny_count;
        for_each_vector(
            input_.screen, count,
            [&](std::size_t i) HWY_ATTR {
                const VI number = hn::BitCast(kI, hn::LoadU(kU, selected_.tiny.data() + i));
                return fetch(input_.screen, number, std::min(lanes, count - i));
            },
            [&](const Fetched& fetched, const CornerLanes& points)
                HWY_ATTR { draw_vector(fetched, points); });
    }

private:
    HWY_INLINE void draw_vector(const Fetched& fetched, const CornerLanes& points) {
        const Area picture{0, 0, grid_.columns, grid_.rows};
        append_others(fetched.number, hn::AndNot(fetched.whole, fetched.wanted));
        Lanes t;
        M large;  // none: tiny boxes are small
        const auto all = [](const CornerLanes&, const Lanes&, M kept) HWY_ATTR { return kept; };
        const M kept = set_up_lanes(input_, picture, fetched, points, all, t, large);
        if (hn::AllFalse(kI, kept)) return;
        const M regular = depth_over_box(t, grid_.step_bits).regular;
        append_others(t.number, hn::AndNot(regular, kept));
        emit_samples(t, hn::And(kept, regular));
    }

    void emit_samples(const Lanes& t, M kept) {
        const VI step = set(1 << grid_.step_bits);
        for (int r = 0; r < kTinySide; ++r)
            for (int c = 0; c < kTinySide; ++c) {
                const VI column = set(c), row = set(r);
                const auto edge = [&](int k) {
                    VI e = t.edges.at[k];
                    for (int n = 0; n < c; ++n) e = hn::Add(e, t.edges.per_column[k]);
                    for (int n = 0; n < r; ++n) e = hn::Add(e, t.edges.per_row[k]);
                    return e;
                };
                const M inside = hn::Gt(hn::Or(edge(0), hn::Or(edge(1), edge(2))), set(-1));
                const M in_box = hn::Not(hn::Or(hn::Gt(column, t.columns), hn::Gt(row, t.rows)));
                const M covered = hn::And(kept, hn::And(inside, in_box));
                if (hn::AllFalse(kI, covered)) continue;
                const VI dx = hn::Add(t.dx0, hn::Mul(column, step));
                const VI dy = hn::Add(t.dy0, hn::Mul(row, step));
                const VF z = stored_depth_of(t.z0, hn::Mul(t.gx, hn::ConvertTo(kF, dx)),
                                             hn::Mul(t.gy, hn::ConvertTo(kF, dy)));
                emit(covered, hn::Add(t.column0, column), hn::Add(t.row0, row), z, t.number);
            }
    }

    HWY_INLINE void emit(M covered, VI column, VI row, VF z, VI number) {
        const VI tile = hn::Add(hn::Mul(hn::ShiftRight<kTileBits>(row), set(grid_.tiles_x)),
                                hn::ShiftRight<kTileBits>(column));
        constexpr int kCellBits = Tile::kCellBits;
        const VI cell = set(Tile::kLastCell), in_cell = set(Tile::kCellSide - 1);
        const VI cell_row = hn::And(hn::ShiftRight<kCellBits>(row), cell);
        const VI cell_column = hn::And(hn::ShiftRight<kCellBits>(column), cell);
        const VI rows = hn::Or(hn::ShiftLeft<kTileBits + kCellBits>(cell_row),
                               hn::ShiftLeft<kCellBits>(hn::And(row, in_cell)));
        const VI columns =
            hn::Or(hn::ShiftLeft<2 * kCellBits>(cell_column), hn::And(column, in_cell));
        const VI place = hn::Or(hn::ShiftLeft<2 * kTileBits>(tile), hn::Or(rows, columns));
        const auto mask = hn::RebindMask(kU, covered);
        hn::CompressStore(hn::BitCast(kU, place), mask, kU, out_.place.data() + out_.count);
        hn::CompressStore(z, hn::RebindMask(kF, covered), kF, out_.z.data() + out_.count);
        out_.count +=
            hn::CompressStore(hn::BitCast(kU, number), mask, kU, out_.id.data() + out_.count);
    }

    // Back to the others: steep triangles, and pieces of clipped ones. Rare, so one by one.
    void append_others(VI number, M chosen) {
        if (hn::AllFalse(kI, chosen)) return;
        HWY_ALIGN std::int32_t numbers[kLanes];
        hn::Store(number, kI, numbers);
        for (std::uint32_t rest = bits_of(chosen); rest != 0; rest &= rest - 1)
            append_other(static_cast<std::uint32_t>(numbers[std::countr_zero(rest)]));
    }

    HWY_NOINLINE void append_other(std::uint32_t number) {
        const Corners corners = input_.screen.corners(number);
        std::int32_t x[2] = {INT32_MAX, INT32_MIN}, y[2] = {INT32_MAX, INT32_MIN};
        for (int k = 0; k < 3; ++k) {
            const ScreenPoint& p = input_.screen.point(corners[k]);
            x[0] = std::min(x[0], p.x), x[1] = std::max(x[1], p.x);
            y[0] = std::min(y[0], p.y), y[1] = std::max(y[1], p.y);
        }
        const std::int32_t c0 = std::max(grid_.first_from(x[0]), 0) >> kTileBits;
        const std::int32_t r0 = std::max(grid_.first_from(y[0]), 0) >> kTileBits;
        const std::int32_t c1 = std::min(grid_.last_until(x[1]), grid_.columns - 1) >> kTileBits;
        const std::int32_t r1 = std::min(grid_.last_until(y[1]), grid_.rows - 1) >> kTileBits;
        // A tiny triangle takes a place of its own in the lists, which have room for all.
        selected_.triangle[selected_.count] = number;
        selected_.tile[selected_.count] = static_cast<std::uint32_t>(r0 * grid_.tiles_x + c0);
        selected_.more[selected_.count] = static_cast<std::uint32_t>((c1 - c0) | (r1 - r0) << 16);
        ++selected_.count;
    }

    const RasterInput& input_;
    const GridUnits& grid_;
    Selected& selected_;
    Points& out_;
};

void draw(const RasterInput& input, Selected& selected, Points& out) {
    TinyPainter(input, selected, out).draw();
}

}  // namespace
}  // namespace sightline::zbuffer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::zbuffer {

HWY_EXPORT(draw);

void draw_tiny(const RasterInput& input, Selected& selected, Points& out) {
    // Room for all samples of all boxes, and for a whole vector behind the last.
    const std::size_t room = std::size_t{kTinySide * kTinySide} * selected.tiny_count + 64;
    if (out.place.size() < room) {
        out.place.resize(room);
        out.id.resize(room);
        out.z.resize(room);
    }
    out.count = 0;
    HWY_DYNAMIC_DISPATCH(draw)(input, selected, out);
}

void draw_points(const RasterInput& input, std::span<const Point> points, Tile& tile,
                 TileCounts& counts) {
    for (const Point& p : points) {
        const std::size_t at = Tile::index(p);
        const float old = tile.depth[at];
        const bool nearer = p.z < old - kUncertain;
        if (nearer != (p.z <= old + kUncertain)) {  // too close to call
            if (!comes_before(input, p.id, tile.ids[at],
                              input.grid.position(tile.column + Tile::column_of(p)),
                              input.grid.position(tile.row + Tile::row_of(p)), counts))
                continue;
            tile.depth[at] = p.z;
            tile.ids[at] = p.id;
            continue;
        }
        // Without a branch: whether a point is hidden is anybody's guess.
        tile.depth[at] = nearer ? p.z : old;
        tile.ids[at] = nearer ? p.id : tile.ids[at];
    }
    counts.points += points.size();
    tile.drawn += static_cast<std::uint32_t>(points.size());
}

}  // namespace sightline::zbuffer
#endif  // HWY_ONCE
