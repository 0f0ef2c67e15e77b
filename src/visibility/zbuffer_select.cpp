// Geometry stage of the z-buffer: which triangles can own a sample, and in which tiles.
//
// One body for every vector width (Google Highway). Corners are gathered for as many triangles as a
// vector has 32-bit lanes; everything is integer arithmetic, so every width gives the same list.
#include "visibility/zbuffer_stages.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "visibility/zbuffer_select.cpp"
#include <hwy/foreach_target.h>
// foreach_target comes first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::zbuffer::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Ints = hn::ScalableTag<std::int32_t>;
using Uints = hn::ScalableTag<std::uint32_t>;
using V = hn::Vec<Ints>;
using M = hn::Mask<Ints>;

constexpr Ints kI;
constexpr Uints kU;

struct Triangles {
    V x0, y0, x1, y1, x2, y2;
};

// Edge p -> q admits the sample s: the same law as edge_admits(), in 32 bits, for triangles small
// enough. `sign` is -1 where the triangle runs the other way round, which reverses the edge.
HWY_INLINE M admits(V px, V py, V qx, V qy, V sx, V sy, V sign) {
    const V dx = hn::Mul(hn::Sub(qx, px), sign), dy = hn::Mul(hn::Sub(qy, py), sign);
    const V e = hn::Sub(hn::Mul(dx, hn::Sub(sy, py)), hn::Mul(dy, hn::Sub(sx, px)));
    const V zero = hn::Zero(kI);
    const M top_left = hn::Or(hn::Lt(dy, zero), hn::And(hn::Eq(dy, zero), hn::Gt(dx, zero)));
    return hn::Or(hn::Gt(e, zero), hn::And(hn::Eq(e, zero), top_left));
}

// Precondition for lanes that matter: all corners within 2^14 of each other and of the sample.
HWY_INLINE M covers_sample(const Triangles& t, V sx, V sy) {
    const V zero = hn::Zero(kI);
    const V area = hn::Sub(hn::Mul(hn::Sub(t.x1, t.x0), hn::Sub(t.y2, t.y0)),
                           hn::Mul(hn::Sub(t.y1, t.y0), hn::Sub(t.x2, t.x0)));
    const V sign = hn::IfThenElse(hn::Lt(area, zero), hn::Set(kI, -1), hn::Set(kI, 1));
    const M inside = hn::And(admits(t.x0, t.y0, t.x1, t.y1, sx, sy, sign),
                             hn::And(admits(t.x1, t.y1, t.x2, t.y2, sx, sy, sign),
                                     admits(t.x2, t.y2, t.x0, t.y0, sx, sy, sign)));
    return hn::And(inside, hn::Ne(area, zero));
}

struct Boxes {
    V column0, column1, row0, row1;  // first and last sample, clamped to the grid
    M kept, narrow;                  // narrow: small enough to be tiny
};

template <class Shift>
HWY_INLINE Boxes boxes_of(const Triangles& t, const GridUnits& grid, const Shift& shift_right) {
    const V up = hn::Set(kI, (1 << grid.step_bits) - 1 - grid.offset);
    const V down = hn::Set(kI, -grid.offset);
    const V zero = hn::Zero(kI);
    const V x_min = hn::Min(t.x0, hn::Min(t.x1, t.x2)), x_max = hn::Max(t.x0, hn::Max(t.x1, t.x2));
    const V y_min = hn::Min(t.y0, hn::Min(t.y1, t.y2)), y_max = hn::Max(t.y0, hn::Max(t.y1, t.y2));
    Boxes b;
    b.column0 = hn::Max(shift_right(hn::Add(x_min, up)), zero);
    b.row0 = hn::Max(shift_right(hn::Add(y_min, up)), zero);
    b.column1 = hn::Min(shift_right(hn::Add(x_max, down)), hn::Set(kI, grid.columns - 1));
    b.row1 = hn::Min(shift_right(hn::Add(y_max, down)), hn::Set(kI, grid.rows - 1));
    b.kept = hn::Not(hn::Or(hn::Gt(b.column0, b.column1), hn::Gt(b.row0, b.row1)));
    // A tiny box away from the borders spans less than one step more: if it is of one sample, it is
    // decided here.
    b.narrow =
        hn::And(hn::Lt(hn::Sub(x_max, x_min), hn::Set(kI, (kTinySide + 1) << grid.step_bits)),
                hn::Lt(hn::Sub(y_max, y_min), hn::Set(kI, (kTinySide + 1) << grid.step_bits)));
    const M single =
        hn::And(b.narrow, hn::And(hn::Eq(b.column0, b.column1), hn::Eq(b.row0, b.row1)));
    if (!hn::AllFalse(kI, hn::And(b.kept, single))) {
        const V bits = hn::Set(kI, 1 << grid.step_bits), offset = hn::Set(kI, grid.offset);
        const V sx = hn::Add(hn::Mul(b.column0, bits), offset);
        const V sy = hn::Add(hn::Mul(b.row0, bits), offset);
        b.kept = hn::And(b.kept, hn::Or(hn::Not(single), covers_sample(t, sx, sy)));
    }
    return b;
}

// Whether a triangle shows its back. A float's rounding may get it wrong; nothing but the order of
// drawing depends on it.
HWY_INLINE M shows_back(const Triangles& t) {
    const hn::Rebind<float, Ints> kF;
    const auto difference = [&](V a, V b) { return hn::ConvertTo(kF, hn::Sub(a, b)); };
    const auto ab = hn::Mul(difference(t.x1, t.x0), difference(t.y2, t.y0));
    const auto ba = hn::Mul(difference(t.y1, t.y0), difference(t.x2, t.x0));
    return hn::RebindMask(kI, hn::Gt(ab, ba));
}

HWY_INLINE M drawable_lanes(const std::uint8_t* skip) {
    const hn::Rebind<std::uint8_t, Ints> bytes;
    const V flags = hn::PromoteTo(kI, hn::LoadU(bytes, skip));
    return hn::Eq(flags, hn::Zero(kI));
}

// Takes Lanes(kI) triangles; appends the kept ones.
template <class Shift>
HWY_INLINE void select_vector(const ScreenScene& screen, const GridUnits& grid,
                              const std::uint32_t* corners, M wanted, std::uint32_t first,
                              const Shift& shift_right, Selected& out) {
    hn::Vec<Uints> c0, c1, c2;
    hn::LoadInterleaved3(kU, corners, c0, c1, c2);
    // Four integers a point.
    const V i0 = hn::ShiftLeft<2>(hn::BitCast(kI, c0)), i1 = hn::ShiftLeft<2>(hn::BitCast(kI, c1)),
            i2 = hn::ShiftLeft<2>(hn::BitCast(kI, c2));
    static_assert(sizeof(ScreenPoint) == 4 * sizeof(std::int32_t));
    const auto* xs = reinterpret_cast<const std::int32_t*>(screen.points().data());
    const auto* ys = xs + 1;
    const Triangles t{hn::GatherIndex(kI, xs, i0), hn::GatherIndex(kI, ys, i0),
                      hn::GatherIndex(kI, xs, i1), hn::GatherIndex(kI, ys, i1),
                      hn::GatherIndex(kI, xs, i2), hn::GatherIndex(kI, ys, i2)};
    const Boxes b = boxes_of(t, grid, shift_right);
    M kept = hn::And(b.kept, wanted);
    if (hn::AllFalse(kI, kept)) return;

    const V number = hn::Iota(kI, static_cast<std::int32_t>(first));
    const auto store = [&](V v, M mask, std::uint32_t* to) {
        return hn::CompressStore(hn::BitCast(kU, v), hn::RebindMask(kU, mask), kU, to);
    };
    const V side = hn::Set(kI, kTinySide);
    const M tiny =
        hn::And(hn::And(kept, b.narrow), hn::And(hn::Lt(hn::Sub(b.column1, b.column0), side),
                                                 hn::Lt(hn::Sub(b.row1, b.row0), side)));
    out.tiny_count += store(number, tiny, out.tiny.data() + out.tiny_count);
    kept = hn::AndNot(tiny, kept);
    if (hn::AllFalse(kI, kept)) return;

    const V tx0 = hn::ShiftRight<kTileBits>(b.column0), tx1 = hn::ShiftRight<kTileBits>(b.column1);
    const V ty0 = hn::ShiftRight<kTileBits>(b.row0), ty1 = hn::ShiftRight<kTileBits>(b.row1);
    const V behind = hn::IfThenElseZero(shows_back(t),
                                        hn::Set(kI, static_cast<std::int32_t>(grid.tile_count())));
    const V tile = hn::Add(hn::Add(hn::Mul(ty0, hn::Set(kI, grid.tiles_x)), tx0), behind);
    const V more = hn::Or(hn::Sub(tx1, tx0), hn::ShiftLeft<16>(hn::Sub(ty1, ty0)));
    store(number, kept, out.triangle.data() + out.count);
    store(tile, kept, out.tile.data() + out.count);
    out.count += store(more, kept, out.more.data() + out.count);
}

void select(const ScreenScene& screen, const GridUnits& grid, const TriangleRange& range,
            Selected& out) {
    static_assert(sizeof(Corners) == 3 * sizeof(std::uint32_t));
    const std::size_t lanes = hn::Lanes(kI), n = range.corners.size();
    const auto* corners = reinterpret_cast<const std::uint32_t*>(range.corners.data());
    const auto shift_right = [bits = grid.step_bits](V v) { return hn::ShiftRightSame(v, bits); };
    std::size_t k = 0;
    for (; k + lanes <= n; k += lanes) {
        const M wanted =
            range.skip.empty() ? hn::FirstN(kI, lanes) : drawable_lanes(range.skip.data() + k);
        select_vector(screen, grid, corners + 3 * k, wanted,
                      range.first + static_cast<std::uint32_t>(k), shift_right, out);
    }
    if (k == n) return;
    // The tail, padded with copies of a triangle that is there.
    std::uint32_t tail[3 * hn::MaxLanes(Ints())];
    std::uint8_t skip[hn::MaxLanes(Ints())] = {};
    for (std::size_t i = 0; i < lanes; ++i) {
        const std::size_t from = k + i < n ? k + i : k;
        for (std::size_t c = 0; c < 3; ++c) tail[3 * i + c] = corners[3 * from + c];
        skip[i] = k + i >= n || (!range.skip.empty() && range.skip[from] != 0) ? 1 : 0;
    }
    select_vector(screen, grid, tail, drawable_lanes(skip),
                  range.first + static_cast<std::uint32_t>(k), shift_right, out);
}

}  // namespace
}  // namespace sightline::zbuffer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::zbuffer {

HWY_EXPORT(select);

void select_triangles(const ScreenScene& screen, const GridUnits& grid, const TriangleRange& range,
                      Selected& out) {
    // Room for a whole vector behind the last triangle.
    const std::size_t room = range.corners.size() + 64;
    for (auto* column : {&out.tiny, &out.triangle, &out.tile, &out.more})
        if (column->size() < room) column->resize(room);
    out.count = out.tiny_count = 0;
    HWY_DYNAMIC_DISPATCH(select)(screen, grid, range, out);
}

}  // namespace sightline::zbuffer
#endif  // HWY_ONCE
