// Set-up of many small triangles at a time: what the geometry and the raster stage share. Included
// once for every vector width (Google Highway), within HWY_NAMESPACE.
//
// Corners lie within 2^14 units of each other, so 32 bits hold their edge functions exactly. Planes
// are computed in double precision, whose integers are exact below 2^53: these are the quotients of
// depth_gradient(), to the bit.
#if defined(SIGHTLINE_ZBUFFER_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_ZBUFFER_LANES_INL
#undef SIGHTLINE_ZBUFFER_LANES_INL
#else
#define SIGHTLINE_ZBUFFER_LANES_INL
#endif

#include <hwy/highway.h>

#include <bit>

#include "visibility/zbuffer_stages.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::zbuffer::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Ints = hn::CappedTag<std::int32_t, 16>;
using Floats = hn::Rebind<float, Ints>;
using Uints = hn::Rebind<std::uint32_t, Ints>;
#if HWY_TARGET == HWY_SCALAR
using Doubles = hn::Rebind<double, Ints>;
#else
using Doubles = hn::Repartition<double, Ints>;
#endif
using VI = hn::Vec<Ints>;
using VF = hn::Vec<Floats>;
using VD = hn::Vec<Doubles>;
using M = hn::Mask<Ints>;

inline constexpr Ints kI;
inline constexpr Floats kF;
inline constexpr Uints kU;
inline constexpr Doubles kD;
inline constexpr std::size_t kLanes = hn::MaxLanes(Ints());

/// Corners within this distance of each other: 32 bits hold their edge functions.
inline constexpr std::int32_t kSmallExtent = 1 << 14;

HWY_INLINE VI set(std::int32_t value) { return hn::Set(kI, value); }

HWY_INLINE std::uint32_t bits_of(M mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kI, mask, bytes);
    return bytes[0] | std::uint32_t{bytes[1]} << 8;
}

HWY_INLINE VI least(const VI v[3]) { return hn::Min(v[0], hn::Min(v[1], v[2])); }
HWY_INLINE VI greatest(const VI v[3]) { return hn::Max(v[0], hn::Max(v[1], v[2])); }

/// Triangles in lanes: number, sheet (-1: none), indices of the corners and where these are.
struct Triangles {
    VI number, sheet, corner[3];
    VI x[3], y[3], z[3];
};

// A coordinate of the points at these indices.
HWY_INLINE VI gather_axis(const ScreenScene& screen, int axis, VI index) {
    static_assert(sizeof(ScreenPoint) == 4 * sizeof(std::int32_t));
    const auto* points = reinterpret_cast<const std::int32_t*>(screen.points().data());
    return hn::GatherIndex(kI, points + axis, hn::ShiftLeft<2>(index));
}

#if HWY_TARGET != HWY_SCALAR
// Points at(j), at(j + 4), ..., one in each block of 128 bits.
template <std::size_t kBlocks, class At>
HWY_INLINE auto load_blocks(const At& at, std::size_t j) {
    const hn::CappedTag<std::int32_t, 4 * kBlocks> d;
    if constexpr (kBlocks == 1)
        return hn::Load(d, at(j));
    else
        return hn::Combine(d, load_blocks<kBlocks / 2>(at, j + 2 * kBlocks),
                           load_blocks<kBlocks / 2>(at, j));
}
#endif

// Where one corner of as many triangles as a vector has lanes is. The indices are found in memory,
// `stride` apart. Points are loaded whole and transposed, which takes half as long as gathering
// their coordinates.
HWY_INLINE void load_points(const ScreenScene& screen, const std::uint32_t* index,
                            std::size_t stride, VI& x, VI& y, VI& z) {
    const ScreenPoint* points = screen.points().data();
    const auto at = [=](std::size_t i) HWY_ATTR {
        return reinterpret_cast<const std::int32_t*>(points + index[i * stride]);
    };
#if HWY_TARGET == HWY_SCALAR
    x = set(at(0)[0]);
    y = set(at(0)[1]);
    z = set(at(0)[2]);
#else
    constexpr std::size_t kBlocks = kLanes / 4;
    const hn::Repartition<std::uint64_t, Ints> d64;
    const auto pairs = [&](VI v) HWY_ATTR { return hn::BitCast(d64, v); };
    const VI a = load_blocks<kBlocks>(at, 0), b = load_blocks<kBlocks>(at, 1);
    const VI c = load_blocks<kBlocks>(at, 2), d = load_blocks<kBlocks>(at, 3);
    const auto xy0 = pairs(hn::InterleaveLower(kI, a, b));
    const auto xy1 = pairs(hn::InterleaveLower(kI, c, d));
    x = hn::BitCast(kI, hn::InterleaveLower(d64, xy0, xy1));
    y = hn::BitCast(kI, hn::InterleaveUpper(d64, xy0, xy1));
    z = hn::BitCast(kI, hn::InterleaveLower(d64, pairs(hn::InterleaveUpper(kI, a, b)),
                                            pairs(hn::InterleaveUpper(kI, c, d))));
#endif
}

// Boxes of samples: the first one, and how many further ones.
struct Boxes {
    VI column0, row0, columns, rows;
};

// The samples of an area that the triangles' boxes hold, from the area's first one; `held` gets the
// lanes where there are any.
HWY_INLINE Boxes boxes_in(const Triangles& t, const GridUnits& grid, const Area& area, M& held) {
    const VI up = set((1 << grid.step_bits) - 1 - grid.offset), down = set(-grid.offset);
    const auto sample = [&](VI v, VI shift, std::int32_t first) {
        return hn::Sub(hn::ShiftRightSame(hn::Add(v, shift), grid.step_bits), set(first));
    };
    Boxes b;
    b.column0 = hn::Max(sample(least(t.x), up, area.column), set(0));
    b.row0 = hn::Max(sample(least(t.y), up, area.row), set(0));
    b.columns =
        hn::Sub(hn::Min(sample(greatest(t.x), down, area.column), set(area.width - 1)), b.column0);
    b.rows = hn::Sub(hn::Min(sample(greatest(t.y), down, area.row), set(area.height - 1)), b.row0);
    held = hn::Gt(hn::Min(b.columns, b.rows), set(-1));
    return b;
}

// Lanes whose corners are less than `extent` apart.
HWY_INLINE M within(const Triangles& t, std::int32_t extent) {
    const VI width = hn::Sub(greatest(t.x), least(t.x)),
             height = hn::Sub(greatest(t.y), least(t.y));
    return hn::Lt(hn::Max(width, height), set(extent));
}

HWY_INLINE VI doubled_area(const Triangles& t) {
    return hn::Sub(hn::Mul(hn::Sub(t.x[1], t.x[0]), hn::Sub(t.y[2], t.y[0])),
                   hn::Mul(hn::Sub(t.y[1], t.y[0]), hn::Sub(t.x[2], t.x[0])));
}

// Lanes of `asked` whose triangle is seen edge-on in the world: it covers nothing. One by one, but
// only those are asked that are thin enough on the screen, and who calls this asks for triangles
// that seem to cover something.
inline HWY_NOINLINE M edge_on_among(const ScreenScene& screen, VI number, M thin) {
    HWY_ALIGN std::int32_t numbers[kLanes], found[kLanes] = {};
    hn::Store(number, kI, numbers);
    for (std::uint32_t rest = bits_of(thin); rest != 0; rest &= rest - 1) {
        const int i = std::countr_zero(rest);
        found[i] = screen.is_edge_on(static_cast<std::uint32_t>(numbers[i])) ? 1 : 0;
    }
    return hn::Ne(hn::Load(kI, found), set(0));
}

HWY_INLINE M edge_on_lanes(const ScreenScene& screen, const Triangles& t, VI doubled, M asked) {
    const VI width = hn::Sub(greatest(t.x), least(t.x)),
             height = hn::Sub(greatest(t.y), least(t.y));
    // 2 (width + height) + 16, see ScreenScene::thin_area().
    static_assert(ScreenScene::thin_area(3, 4) == 2 * (3 + 4) + 16);
    const VI most = hn::Add(hn::ShiftLeft<1>(hn::Add(width, height)), set(16));
    const M thin = hn::AndNot(hn::Gt(hn::Abs(doubled), most), asked);
    if (HWY_LIKELY(hn::AllFalse(kI, thin))) return thin;
    return edge_on_among(screen, t.number, thin);
}

// Edge functions at a sample, less one where the edge does not own its points, divided by the step;
// and their increments. A sample is covered where none is negative.
struct Edges {
    VI at[3], per_column[3], per_row[3];
};

HWY_INLINE Edges edges_at(const Triangles& t, VI doubled, VI sx, VI sy, int step_bits) {
    const VI zero = set(0);
    // The other way round where the corners go round the other way.
    const M reversed = hn::Lt(doubled, zero);
    const auto second = [&](const VI v[3]) { return hn::IfThenElse(reversed, v[2], v[1]); };
    const auto third = [&](const VI v[3]) { return hn::IfThenElse(reversed, v[1], v[2]); };
    const VI x[3] = {t.x[0], second(t.x), third(t.x)}, y[3] = {t.y[0], second(t.y), third(t.y)};
    Edges edges;
    for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        const VI dx = hn::Sub(x[next], x[k]), dy = hn::Sub(y[next], y[k]);
        const VI value = hn::Sub(hn::Mul(dx, hn::Sub(sy, y[k])), hn::Mul(dy, hn::Sub(sx, x[k])));
        const M top_left = hn::Or(hn::Lt(dy, zero), hn::And(hn::Eq(dy, zero), hn::Gt(dx, zero)));
        const VI biased = hn::Sub(value, hn::IfThenElse(top_left, zero, set(1)));
        edges.at[k] = hn::ShiftRightSame(biased, step_bits);
        edges.per_column[k] = hn::Sub(zero, dy);
        edges.per_row[k] = dx;
    }
    return edges;
}

// Planes of depth: gradients, depth at the anchor, and where a first sample is from there.
struct Planes {
    VF gx, gy, z0;
    VI dx, dy;
};

// Gradients of the planes with these edges u, v from the first corner, for as many lanes as a
// vector has doubles.
template <class VInts>
HWY_INLINE void own_gradient(const VInts u[3], const VInts v[3], VD& gx, VD& gy) {
    VD a[3], b[3];
    for (int k = 0; k < 3; ++k) {
        a[k] = hn::PromoteTo(kD, u[k]);
        b[k] = hn::PromoteTo(kD, v[k]);
    }
    const VD na = hn::Sub(hn::Mul(a[2], b[1]), hn::Mul(a[1], b[2]));
    const VD nb = hn::Sub(hn::Mul(a[0], b[2]), hn::Mul(a[2], b[0]));
    const VD nc = hn::Sub(hn::Mul(a[0], b[1]), hn::Mul(a[1], b[0]));
    gx = hn::Div(na, nc);
    gy = hn::Div(nb, nc);
}

HWY_INLINE Planes own_planes(const Triangles& t, VI sx, VI sy) {
    Planes plane;
    plane.z0 = hn::ConvertTo(kF, t.z[0]);
    plane.dx = hn::Sub(sx, t.x[0]);
    plane.dy = hn::Sub(sy, t.y[0]);
    const VI* axes[3] = {t.x, t.y, t.z};
    VI u[3], v[3];
    for (int k = 0; k < 3; ++k) {
        u[k] = hn::Sub(axes[k][1], axes[k][0]);
        v[k] = hn::Sub(axes[k][2], axes[k][0]);
    }
#if HWY_TARGET == HWY_SCALAR
    VD gx, gy;
    own_gradient(u, v, gx, gy);
    plane.gx = hn::DemoteTo(kF, gx);
    plane.gy = hn::DemoteTo(kF, gy);
#else
    // A vector holds half as many doubles.
    using HalfInts = hn::Half<Ints>;
    constexpr hn::Half<Floats> kHalf;
    hn::Vec<HalfInts> u_lo[3], v_lo[3], u_hi[3], v_hi[3];
    for (int k = 0; k < 3; ++k) {
        u_lo[k] = hn::LowerHalf(HalfInts(), u[k]);
        v_lo[k] = hn::LowerHalf(HalfInts(), v[k]);
        u_hi[k] = hn::UpperHalf(HalfInts(), u[k]);
        v_hi[k] = hn::UpperHalf(HalfInts(), v[k]);
    }
    VD gx_lo, gy_lo, gx_hi, gy_hi;
    own_gradient(u_lo, v_lo, gx_lo, gy_lo);
    own_gradient(u_hi, v_hi, gx_hi, gy_hi);
    plane.gx = hn::Combine(kF, hn::DemoteTo(kHalf, gx_hi), hn::DemoteTo(kHalf, gx_lo));
    plane.gy = hn::Combine(kF, hn::DemoteTo(kHalf, gy_hi), hn::DemoteTo(kHalf, gy_lo));
#endif
    return plane;
}

// Marks the numbers of those that belong to a sheet.
HWY_INLINE VI marked(const Triangles& t) {
    static_assert(kInSheet == 1u << 31);
    return hn::Or(t.number, hn::ShiftLeft<31>(hn::Not(hn::ShiftRight<31>(t.sheet))));
}

// The sheets of triangles, by marked numbers: -1 for none.
HWY_INLINE VI sheets_of(const ScreenScene& screen, VI marks) {
    const M in_sheet = hn::Lt(marks, set(0));
    if (hn::AllFalse(kI, in_sheet)) return set(-1);
    const auto* of_triangle =
        reinterpret_cast<const std::int32_t*>(screen.scene().sheets.of_triangle.data());
    const VI number = hn::And(marks, set(INT32_MAX));
    return hn::IfThenElse(
        in_sheet, hn::GatherIndex(kI, of_triangle, hn::IfThenElseZero(in_sheet, number)), set(-1));
}

// The planes that triangles share with their sheets; returns the lanes where there is one in force.
HWY_INLINE M shared_planes(const RasterInput& input, VI sheet, VI sx, VI sy, Planes& plane) {
    const M in_sheet = hn::Gt(sheet, set(-1));
    if (hn::AllFalse(kI, in_sheet)) return in_sheet;
    static_assert(sizeof(SharedGradient) == 5 * sizeof(float));
    const VI slot = hn::Mul(hn::IfThenElseZero(in_sheet, sheet), set(5));
    const auto* floats = reinterpret_cast<const float*>(input.shared.data());
    const auto* ints = reinterpret_cast<const std::int32_t*>(input.shared.data());
    plane.gx = hn::GatherIndex(kF, floats, slot);
    plane.gy = hn::GatherIndex(kF, floats + 1, slot);
    plane.z0 = hn::GatherIndex(kF, floats + 2, slot);
    plane.dx = hn::Sub(sx, hn::GatherIndex(kI, ints + 3, slot));
    plane.dy = hn::Sub(sy, hn::GatherIndex(kI, ints + 4, slot));
    return hn::And(in_sheet, hn::RebindMask(kI, hn::Eq(plane.gx, plane.gx)));  // not NaN
}

HWY_INLINE Planes choose(M mask, const Planes& yes, const Planes& no) {
    const auto floats = hn::RebindMask(kF, mask);
    return {hn::IfThenElse(floats, yes.gx, no.gx), hn::IfThenElse(floats, yes.gy, no.gy),
            hn::IfThenElse(floats, yes.z0, no.z0), hn::IfThenElse(mask, yes.dx, no.dx),
            hn::IfThenElse(mask, yes.dy, no.dy)};
}

// Depth over boxes of so many further columns and rows. How far it rises from the anchor decides
// whether floats will do; its least and greatest values are those of corners, because every
// operation is monotone. Inside: no stored depth has to be clamped.
struct DepthRange {
    M regular, inside;
    VF least;
};

HWY_INLINE DepthRange depth_over(const Planes& plane, VI columns, VI rows, int step_bits) {
    const VI dx1 = hn::Add(plane.dx, hn::ShiftLeftSame(columns, step_bits));
    const VI dy1 = hn::Add(plane.dy, hn::ShiftLeftSame(rows, step_bits));
    const VF tx0 = hn::Mul(plane.gx, hn::ConvertTo(kF, plane.dx));
    const VF tx1 = hn::Mul(plane.gx, hn::ConvertTo(kF, dx1));
    const VF ty0 = hn::Mul(plane.gy, hn::ConvertTo(kF, plane.dy));
    const VF ty1 = hn::Mul(plane.gy, hn::ConvertTo(kF, dy1));
    const VF rise =
        hn::Add(hn::Max(hn::Abs(tx0), hn::Abs(tx1)), hn::Max(hn::Abs(ty0), hn::Abs(ty1)));
    const VF least = hn::Add(plane.z0, hn::Add(hn::Min(tx0, tx1), hn::Min(ty0, ty1)));
    const VF greatest = hn::Add(plane.z0, hn::Add(hn::Max(tx0, tx1), hn::Max(ty0, ty1)));
    const auto inside =
        hn::And(hn::Ge(least, hn::Zero(kF)), hn::Le(greatest, hn::Set(kF, kStoredDepthMax)));
    return {hn::RebindMask(kI, hn::Le(rise, hn::Set(kF, kRegularRise))), hn::RebindMask(kI, inside),
            least};
}

// Stored depth from the two terms of a sample.
HWY_INLINE VF stored_depth_of(VF z0, VF tx, VF ty) {
    return hn::Min(hn::Max(hn::Add(z0, hn::Add(tx, ty)), hn::Zero(kF)),
                   hn::Set(kF, kStoredDepthMax));
}

}  // namespace
}  // namespace sightline::zbuffer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
