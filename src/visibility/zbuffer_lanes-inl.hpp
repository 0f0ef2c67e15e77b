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

struct CornerLanes {
    VI x[3], y[3], z[3];
};

// An edge function at the first sample of a box, less one where the edge does not own its points,
// divided by the step; and its increments.
struct Edges {
    VI at[3], per_column[3], per_row[3];
};

// Triangles in a tile, in lanes.
struct Lanes {
    VI number;
    VI column0, row0, columns, rows;  // box: first sample, and how many further ones
    Edges edges;
    VF gx, gy, z0;
    VI dx0, dy0;  // from the plane's anchor to the first sample
};

// Triangles by number, with the indices of their corners.
struct Fetched {
    M wanted, whole;  // whole: no piece of a clipped triangle (those have their corners elsewhere)
    VI number, corner[3];
};

HWY_INLINE Fetched fetch(const ScreenScene& screen, VI number, std::size_t n) {
    const auto* corners = reinterpret_cast<const std::int32_t*>(screen.scene().triangles.data());
    Fetched f;
    f.number = number;
    f.wanted = hn::FirstN(kI, n);
    f.whole = hn::And(
        f.wanted, hn::Lt(number, set(static_cast<std::int32_t>(screen.scene().triangle_count()))));
    const VI safe = hn::IfThenElseZero(f.whole, number);
    const VI first = hn::Add(safe, hn::Add(safe, safe));
    for (int k = 0; k < 3; ++k) f.corner[k] = hn::GatherIndex(kI, corners + k, first);
    return f;
}

HWY_INLINE CornerLanes gather_points(const ScreenScene& screen, const Fetched& f) {
    static_assert(sizeof(ScreenPoint) == 4 * sizeof(std::int32_t));
    const auto* points = reinterpret_cast<const std::int32_t*>(screen.points().data());
    CornerLanes p;
    for (int k = 0; k < 3; ++k) {
        const VI at = hn::ShiftLeft<2>(f.corner[k]);
        p.x[k] = hn::GatherIndex(kI, points, at);
        p.y[k] = hn::GatherIndex(kI, points + 1, at);
        p.z[k] = hn::GatherIndex(kI, points + 2, at);
    }
    return p;
}

// Vectors of triangles on their way: while one is worked on, the corners of the next and the
// indices of the one after it are fetched, for they are scattered over memory.
// fetch_from(i) gives the triangles from i on.
template <class FetchFrom, class Work>
HWY_INLINE void for_each_vector(const ScreenScene& screen, std::size_t count,
                                const FetchFrom& fetch_from, const Work& work) {
    if (count == 0) return;
    const std::size_t lanes = hn::Lanes(kI);
    Fetched next = fetch_from(std::size_t{0});
    CornerLanes points = gather_points(screen, next);
    Fetched after = count > lanes ? fetch_from(lanes) : next;
    for (std::size_t i = 0; i < count; i += lanes) {
        const Fetched now = next;
        const CornerLanes corners = points;
        next = after;
        if (i + lanes < count) points = gather_points(screen, next);
        if (i + 2 * lanes < count) after = fetch_from(i + 2 * lanes);
        work(now, corners);
    }
}

HWY_INLINE VI least(const VI v[3]) { return hn::Min(v[0], hn::Min(v[1], v[2])); }
HWY_INLINE VI greatest(const VI v[3]) { return hn::Max(v[0], hn::Max(v[1], v[2])); }

// The box in a part of the picture; returns the lanes where it holds a sample, and which of all are
// small.
HWY_INLINE M set_boxes(const CornerLanes& p, const GridUnits& grid, const Area& area, Lanes& t,
                       M& small) {
    const VI x_min = least(p.x), x_max = greatest(p.x), y_min = least(p.y), y_max = greatest(p.y);
    small = hn::And(hn::Lt(hn::Sub(x_max, x_min), set(kSmallExtent)),
                    hn::Lt(hn::Sub(y_max, y_min), set(kSmallExtent)));
    const VI up = set((1 << grid.step_bits) - 1 - grid.offset), down = set(-grid.offset);
    const auto sample = [&](VI v, VI shift, std::int32_t first) {
        return hn::Sub(hn::ShiftRightSame(hn::Add(v, shift), grid.step_bits), set(first));
    };
    t.column0 = hn::Max(sample(x_min, up, area.column), set(0));
    t.row0 = hn::Max(sample(y_min, up, area.row), set(0));
    t.columns = hn::Sub(hn::Min(sample(x_max, down, area.column), set(area.width - 1)), t.column0);
    t.rows = hn::Sub(hn::Min(sample(y_max, down, area.row), set(area.height - 1)), t.row0);
    return hn::And(hn::Gt(t.columns, set(-1)), hn::Gt(t.rows, set(-1)));
}

HWY_INLINE VI doubled_area(const CornerLanes& p) {
    return hn::Sub(hn::Mul(hn::Sub(p.x[1], p.x[0]), hn::Sub(p.y[2], p.y[0])),
                   hn::Mul(hn::Sub(p.y[1], p.y[0]), hn::Sub(p.x[2], p.x[0])));
}

// Exchanges the second and third corner where the triangle runs the other way round.
HWY_INLINE void orient(CornerLanes& p, M reversed) {
    for (VI* v : {p.x, p.y, p.z}) {
        const VI second = hn::IfThenElse(reversed, v[2], v[1]);
        v[2] = hn::IfThenElse(reversed, v[1], v[2]);
        v[1] = second;
    }
}

// Sets up the edges at sample positions (sx, sy); returns the lanes that no edge excludes.
HWY_INLINE M set_edges(const CornerLanes& p, VI sx, VI sy, int step_bits, Lanes& t) {
    const VI zero = set(0);
    M kept = hn::Eq(zero, zero);
    for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        const VI dx = hn::Sub(p.x[next], p.x[k]), dy = hn::Sub(p.y[next], p.y[k]);
        const VI value =
            hn::Sub(hn::Mul(dx, hn::Sub(sy, p.y[k])), hn::Mul(dy, hn::Sub(sx, p.x[k])));
        const M top_left = hn::Or(hn::Lt(dy, zero), hn::And(hn::Eq(dy, zero), hn::Gt(dx, zero)));
        const VI biased = hn::Sub(value, hn::IfThenElse(top_left, zero, set(1)));
        t.edges.at[k] = hn::ShiftRightSame(biased, step_bits);
        t.edges.per_column[k] = hn::Sub(zero, dy);
        t.edges.per_row[k] = dx;
        const VI most =
            hn::Add(t.edges.at[k], hn::Add(hn::Max(zero, hn::Mul(t.edges.per_column[k], t.columns)),
                                           hn::Max(zero, hn::Mul(dx, t.rows))));
        kept = hn::And(kept, hn::Gt(most, set(-1)));
    }
    return kept;
}

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

HWY_INLINE void set_own_planes(const CornerLanes& p, Lanes& t) {
    const VI* axes[3] = {p.x, p.y, p.z};
    VI u[3], v[3];
    for (int k = 0; k < 3; ++k) {
        u[k] = hn::Sub(axes[k][1], axes[k][0]);
        v[k] = hn::Sub(axes[k][2], axes[k][0]);
    }
    t.z0 = hn::ConvertTo(kF, p.z[0]);
#if HWY_TARGET == HWY_SCALAR
    VD gx, gy;
    own_gradient(u, v, gx, gy);
    t.gx = hn::DemoteTo(kF, gx);
    t.gy = hn::DemoteTo(kF, gy);
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
    t.gx = hn::Combine(kF, hn::DemoteTo(kHalf, gx_hi), hn::DemoteTo(kHalf, gx_lo));
    t.gy = hn::Combine(kF, hn::DemoteTo(kHalf, gy_hi), hn::DemoteTo(kHalf, gy_lo));
#endif
}

HWY_INLINE VI sheets_of(const RasterInput& input, VI number) {
    const auto* of_triangle =
        reinterpret_cast<const std::int32_t*>(input.screen.scene().sheets.of_triangle.data());
    return hn::GatherIndex(kI, of_triangle, number);
}

// Triangles that belong to a sheet.
HWY_INLINE M sheet_lanes(const RasterInput& input, VI number) {
    if (input.shared.empty()) return hn::Ne(number, number);
    return hn::Ne(sheets_of(input, number), set(-1));
}

// Puts the shared plane in place of the own one where a triangle belongs to a sheet.
HWY_INLINE void set_shared_planes(const RasterInput& input, VI sx, VI sy, Lanes& t) {
    if (input.shared.empty()) return;
    static_assert(sizeof(SharedGradient) == 5 * sizeof(float));
    const VI sheet = sheets_of(input, t.number);
    const M in_sheet = hn::Ne(sheet, set(-1));
    if (hn::AllFalse(kI, in_sheet)) return;
    const VI slot = hn::Mul(hn::IfThenElseZero(in_sheet, sheet), set(5));
    const auto* floats = reinterpret_cast<const float*>(input.shared.data());
    const auto* ints = reinterpret_cast<const std::int32_t*>(input.shared.data());
    const VF gx = hn::GatherIndex(kF, floats, slot);
    const auto shared = hn::And(hn::RebindMask(kF, in_sheet), hn::Eq(gx, gx));  // not NaN
    t.gx = hn::IfThenElse(shared, gx, t.gx);
    t.gy = hn::IfThenElse(shared, hn::GatherIndex(kF, floats + 1, slot), t.gy);
    t.z0 = hn::IfThenElse(shared, hn::GatherIndex(kF, floats + 2, slot), t.z0);
    const M shared_ints = hn::RebindMask(kI, shared);
    t.dx0 = hn::IfThenElse(shared_ints, hn::Sub(sx, hn::GatherIndex(kI, ints + 3, slot)), t.dx0);
    t.dy0 = hn::IfThenElse(shared_ints, hn::Sub(sy, hn::GatherIndex(kI, ints + 4, slot)), t.dy0);
}

// Depth over the box. How far it rises from the anchor decides whether floats will do; its least
// value is that of a corner, because every operation is monotone.
struct DepthRange {
    M regular;
    VF least;
};

HWY_INLINE DepthRange depth_over_box(const Lanes& t, int step_bits) {
    const VI dx1 = hn::Add(t.dx0, hn::Mul(t.columns, set(1 << step_bits)));
    const VI dy1 = hn::Add(t.dy0, hn::Mul(t.rows, set(1 << step_bits)));
    const VF tx0 = hn::Mul(t.gx, hn::ConvertTo(kF, t.dx0));
    const VF tx1 = hn::Mul(t.gx, hn::ConvertTo(kF, dx1));
    const VF ty0 = hn::Mul(t.gy, hn::ConvertTo(kF, t.dy0));
    const VF ty1 = hn::Mul(t.gy, hn::ConvertTo(kF, dy1));
    const VF rise =
        hn::Add(hn::Max(hn::Abs(tx0), hn::Abs(tx1)), hn::Max(hn::Abs(ty0), hn::Abs(ty1)));
    return {hn::RebindMask(kI, hn::Le(rise, hn::Set(kF, kRegularRise))),
            hn::Add(t.z0, hn::Add(hn::Min(tx0, tx1), hn::Min(ty0, ty1)))};
}

// Stored depth from the two terms of a sample.
HWY_INLINE VF stored_depth_of(VF z0, VF tx, VF ty) {
    return hn::Min(hn::Max(hn::Add(z0, hn::Add(tx, ty)), hn::Zero(kF)),
                   hn::Set(kF, kStoredDepthMax));
}

// All of the set-up but the judgement of depth: boxes in `area`, edges and planes of the small
// triangles. Returns the lanes that may cover a sample; `large` gets those that are not small.
// look(p, t, kept) is asked, as soon as the boxes are known, which of the lanes are still wanted.
template <class Look>
HWY_INLINE M set_up_lanes(const RasterInput& input, const Area& area, const Fetched& fetched,
                          CornerLanes p, const Look& look, Lanes& t, M& large) {
    const GridUnits& grid = input.grid;
    t.number = hn::IfThenElseZero(fetched.whole, fetched.number);
    t.gx = t.gy = t.z0 = hn::Zero(kF);
    t.dx0 = t.dy0 = set(0);
    M small;
    const M in_area = hn::And(fetched.whole, set_boxes(p, grid, area, t, small));
    large = hn::AndNot(small, in_area);
    const VI doubled = doubled_area(p);
    M kept = hn::And(hn::And(in_area, small), hn::Ne(doubled, set(0)));
    if (hn::AllFalse(kI, kept)) return kept;
    kept = look(p, t, kept);
    if (hn::AllFalse(kI, kept)) return kept;
    orient(p, hn::Lt(doubled, set(0)));
    const VI step = set(1 << grid.step_bits);
    const VI sx = hn::Add(hn::Mul(t.column0, step), set(grid.position(area.column)));
    const VI sy = hn::Add(hn::Mul(t.row0, step), set(grid.position(area.row)));
    kept = hn::And(kept, set_edges(p, sx, sy, grid.step_bits, t));
    if (hn::AllFalse(kI, kept)) return kept;
    t.dx0 = hn::Sub(sx, p.x[0]);
    t.dy0 = hn::Sub(sy, p.y[0]);
    set_own_planes(p, t);
    set_shared_planes(input, sx, sy, t);
    return kept;
}

}  // namespace
}  // namespace sightline::zbuffer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
