// Geometry stage of the z-buffer: triangles whose box is at most three by three samples. Included
// once for every vector width (Google Highway), within HWY_NAMESPACE.
//
// In dense meshes most triangles are of this kind. They wait in a queue until they fill a vector,
// and are drawn while their corners are in the nearest cache, to points: place, depth and id of
// each sample that they cover. Tiles then only compare the points that fall into them. Planes are
// set up for those alone that cover a sample; about every second one covers none.
#if defined(SIGHTLINE_ZBUFFER_TINY_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_ZBUFFER_TINY_INL
#undef SIGHTLINE_ZBUFFER_TINY_INL
#else
#define SIGHTLINE_ZBUFFER_TINY_INL
#endif

#include <hwy/highway.h>

#include <bit>

#include "visibility/compress-inl.hpp"
#include "visibility/zbuffer_lanes-inl.hpp"
#include "visibility/zbuffer_stages.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::zbuffer::HWY_NAMESPACE {
namespace {

/// Tiny triangles that wait to be drawn, of at most kSide samples a side.
template <int kSide>
class TinyQueue {
public:
    TinyQueue(const RasterInput& input, Selected& others, PointBins& points)
        : input_(input), grid_(input.grid), others_(others), points_(points) {}

    HWY_INLINE void add(const Triangles& t, M chosen) {
        if (hn::AllFalse(kI, chosen)) return;
        // Behind the chosen lanes of a vector come others, with whatever triangles they hold.
        const auto append = [&](VI v, std::int32_t* column)
                                HWY_ATTR { append_lanes(v, chosen, column + count_); };
        append(t.number, number_);
        append(t.sheet, sheet_);
        for (int k = 0; k < 3; ++k) {
            append(t.corner[k], corner_[k]);
            append(t.x[k], x_[k]);
            append(t.y[k], y_[k]);
        }
        count_ += hn::CountTrue(kI, chosen);
        const std::size_t lanes = hn::Lanes(kI);
        if (count_ < lanes) return;
        draw(lanes);
        count_ -= lanes;
        drop_first();
    }

    void finish() {
        if (count_ == 0) return;
        pad();
        draw(count_);
        count_ = 0;
    }

private:
    template <class Change>
    HWY_INLINE void for_each_column(const Change& change) {
        change(number_);
        change(sheet_);
        for (int k = 0; k < 3; ++k) {
            change(corner_[k]);
            change(x_[k]);
            change(y_[k]);
        }
    }

    HWY_INLINE void drop_first() {
        for_each_column([](std::int32_t* column) HWY_ATTR {
            hn::Store(hn::LoadU(kI, column + hn::Lanes(kI)), kI, column);
        });
    }

    // Lanes beyond the last one waiting hold what compression left there: clipped triangles, large
    // ones, even numbers that no triangle has. They become copies of a tiny triangle, so that what
    // draw() relies on is true of every lane.
    HWY_INLINE void pad() {
        const M waiting = hn::FirstN(kI, count_);
        for_each_column([waiting](std::int32_t* column) HWY_ATTR {
            hn::Store(hn::IfThenElse(waiting, hn::Load(kI, column), set(column[0])), kI, column);
        });
    }

    // Draws the first n lanes. Precondition: all lanes hold tiny triangles.
    HWY_INLINE void draw(std::size_t n) {
        Triangles t;
        t.number = hn::Load(kI, number_);
        t.sheet = hn::Load(kI, sheet_);
        for (int k = 0; k < 3; ++k) {
            t.corner[k] = hn::Load(kI, corner_[k]);
            t.x[k] = hn::Load(kI, x_[k]);
            t.y[k] = hn::Load(kI, y_[k]);
        }
        M held;
        const Boxes b = boxes_in(t, grid_, {0, 0, grid_.columns, grid_.rows}, held);
        const VI sx = hn::Add(hn::ShiftLeftSame(b.column0, grid_.step_bits), set(grid_.offset));
        const VI sy = hn::Add(hn::ShiftLeftSame(b.row0, grid_.step_bits), set(grid_.offset));
        const VI doubled = doubled_area(t);
        Edges edges = edges_at(t, doubled, sx, sy, grid_.step_bits);
        const M wanted = hn::And(hn::FirstN(kI, n), hn::Ne(doubled, set(0)));
        // Far outside: nothing is covered, for a tiny triangle's steps do not lead back in.
        static_assert(2 * (kSide - 1) * kSmallExtent < 1 << 30);
        edges.at[0] = hn::IfThenElse(wanted, edges.at[0], set(-(1 << 30)));

        M covered[kSide * kSide];
        M any = find_covered(edges, covered);
        if (hn::AllFalse(kI, any)) return;
        const M edge_on = edge_on_lanes(input_.screen, t, doubled, any);
        if (HWY_UNLIKELY(!hn::AllFalse(kI, edge_on))) {
            any = hn::AndNot(edge_on, any);
            for (M& mask : covered) mask = hn::AndNot(edge_on, mask);
        }
        const Planes plane = planes_of(t, any, sx, sy);
        const M regular =
            depth_over(plane, set(kSide - 1), set(kSide - 1), grid_.step_bits).regular;
        const M steep = hn::AndNot(regular, any);
        if (HWY_UNLIKELY(!hn::AllFalse(kI, steep))) {
            append_others(marked(t), steep);
            for (M& mask : covered) mask = hn::And(mask, regular);
        }
        emit(b, plane, covered, t.number);
    }

    HWY_INLINE M find_covered(const Edges& edges, M covered[]) {
        M any = hn::Ne(edges.at[0], edges.at[0]);
        VI row[3] = {edges.at[0], edges.at[1], edges.at[2]};
        for (int r = 0; r < kSide; ++r) {
            VI e[3] = {row[0], row[1], row[2]};
            for (int c = 0; c < kSide; ++c) {
                const M inside = hn::Gt(hn::Or3(e[0], e[1], e[2]), set(-1));
                covered[r * kSide + c] = inside;
                any = hn::Or(any, inside);
                for (int k = 0; k < 3; ++k) e[k] = hn::Add(e[k], edges.per_column[k]);
            }
            for (int k = 0; k < 3; ++k) row[k] = hn::Add(row[k], edges.per_row[k]);
        }
        return any;
    }

    HWY_INLINE Planes planes_of(Triangles& t, M wanted, VI sx, VI sy) const {
        Planes shared;
        const M served = shared_planes(input_, t.sheet, sx, sy, shared);
        if (hn::AllFalse(kI, hn::AndNot(served, wanted))) return shared;
        for (int k = 0; k < 3; ++k) t.z[k] = gather_axis(input_.screen, 2, t.corner[k]);
        const Planes own = own_planes(t, sx, sy);
        return hn::AllFalse(kI, served) ? own : choose(served, shared, own);
    }

    // Where samples are: their tile, and their place in it, which is the sum of what column and row
    // contribute.
    struct Axis {
        VI tile[kSide], place[kSide];
    };

    static HWY_INLINE Axis axis_of(VI first, std::int32_t cell_step, std::int32_t step) {
        Axis axis;
        for (int k = 0; k < kSide; ++k) {
            const VI at = hn::Add(first, set(k));
            const VI in_tile = hn::And(at, set(kTileSize - 1));
            const VI cell = hn::ShiftRight<Tile::kCellBits>(in_tile);
            const VI in_cell = hn::And(in_tile, set(Tile::kCellSide - 1));
            axis.tile[k] = hn::ShiftRight<kTileBits>(at);
            axis.place[k] = hn::Add(hn::Mul(cell, set(cell_step)), hn::Mul(in_cell, set(step)));
        }
        return axis;
    }

    HWY_INLINE void emit(const Boxes& b, const Planes& plane, const M covered[], VI number) {
        const Axis x = axis_of(b.column0, Tile::kCell, 1);
        const Axis y = axis_of(b.row0, Tile::kCellRow, Tile::kCellSide);
        VF tx[kSide];
        for (int c = 0; c < kSide; ++c) {
            const VI dx = hn::Add(plane.dx, set(c << grid_.step_bits));
            tx[c] = hn::Mul(plane.gx, hn::ConvertTo(kF, dx));
        }
        // Neighbours in a mesh are neighbours in the picture: nearly always all fall into one tile.
        const std::int32_t column = hn::GetLane(x.tile[0]), row = hn::GetLane(y.tile[0]);
        const VI other = hn::Or3(
            hn::Or(hn::Xor(x.tile[0], set(column)), hn::Xor(x.tile[kSide - 1], set(column))),
            hn::Xor(y.tile[0], set(row)), hn::Xor(y.tile[kSide - 1], set(row)));
        const bool together = hn::AllTrue(kI, hn::Eq(other, set(0)));
        const auto tile = static_cast<std::size_t>(std::int64_t{row} * grid_.tiles_x + column);
        for (int r = 0; r < kSide; ++r) {
            const VI dy = hn::Add(plane.dy, set(r << grid_.step_bits));
            const VF ty = hn::Mul(plane.gy, hn::ConvertTo(kF, dy));
            for (int c = 0; c < kSide; ++c) {
                const M mask = covered[r * kSide + c];
                if (kSide > 2 && hn::AllFalse(kI, mask)) continue;
                const VF z = stored_depth_of(plane.z0, tx[c], ty);
                const VI place = hn::Add(x.place[c], y.place[r]);
                if (HWY_LIKELY(together))
                    add_points(points_.block_of(tile), mask, place, z, number);
                else
                    spread_points(hn::Add(hn::Mul(y.tile[r], set(grid_.tiles_x)), x.tile[c]), mask,
                                  place, z, number);
            }
        }
    }

    static HWY_INLINE void add_points(PointBlock& block, M covered, VI place, VF z, VI number) {
        const auto mask = hn::RebindMask(kU, covered);
        append_lanes(hn::BitCast(kU, place), mask, block.place + block.count);
        append_lanes(z, hn::RebindMask(kF, covered), block.z + block.count);
        append_lanes(hn::BitCast(kU, number), mask, block.id + block.count);
        block.count += hn::CountTrue(kI, covered);
    }

    // The same in several tiles, one after the other.
    HWY_INLINE void spread_points(VI tile, M covered, VI place, VF z, VI number) {
        HWY_ALIGN std::int32_t tiles[kLanes];
        hn::Store(tile, kI, tiles);
        for (M rest = covered; !hn::AllFalse(kI, rest);) {
            const std::int32_t first = tiles[hn::FindKnownFirstTrue(kI, rest)];
            const M here = hn::And(rest, hn::Eq(tile, set(first)));
            add_points(points_.block_of(static_cast<std::size_t>(first)), here, place, z, number);
            rest = hn::AndNot(here, rest);
        }
    }

    // To the others: steep triangles. Rare, so one by one.
    HWY_NOINLINE void append_others(VI marks, M chosen) {
        HWY_ALIGN std::int32_t numbers[kLanes];
        hn::Store(marks, kI, numbers);
        for (std::uint32_t rest = bits_of(chosen); rest != 0; rest &= rest - 1)
            append_other(static_cast<std::uint32_t>(numbers[std::countr_zero(rest)]));
    }

    void append_other(std::uint32_t mark) {
        const Corners corners = input_.screen.corners(mark & ~kInSheet);
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
        for (std::int32_t r = r0; r <= r1; ++r)
            for (std::int32_t c = c0; c <= c1; ++c)
                others_.append(mark, static_cast<std::uint32_t>(r * grid_.tiles_x + c));
    }

    static constexpr std::size_t kRoom = 3 * kLanes;

    const RasterInput& input_;
    const GridUnits& grid_;
    Selected& others_;
    PointBins& points_;
    std::size_t count_ = 0;
    HWY_ALIGN std::int32_t number_[kRoom] = {}, sheet_[kRoom] = {};
    HWY_ALIGN std::int32_t corner_[3][kRoom] = {}, x_[3][kRoom] = {}, y_[3][kRoom] = {};
};

}  // namespace
}  // namespace sightline::zbuffer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
