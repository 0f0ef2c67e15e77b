// One body for every vector width (Google Highway); the scalar target is one of them. The tail goes
// through the same code on padded copies, so no position is treated differently from another.
#include "view/vertex_stage.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "view/vertex_stage.cpp"
#include <hwy/foreach_target.h>
// foreach_target comes first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::ScalableTag<double>;
using V = hn::Vec<Doubles>;
using Ints = hn::Rebind<std::int32_t, Doubles>;

constexpr Doubles kD;
constexpr Ints kI;

HWY_INLINE V linear(const glm::dvec4& row, V px, V py, V pz) {
    const V xy = hn::Add(hn::Mul(hn::Set(kD, row.x), px), hn::Mul(hn::Set(kD, row.y), py));
    return hn::Add(hn::Add(xy, hn::Mul(hn::Set(kD, row.z), pz)), hn::Set(kD, row.w));
}

HWY_INLINE hn::Vec<Ints> round_clamped(V value, double lo, double hi) {
    const V clamped = hn::Min(hn::Max(value, hn::Set(kD, lo)), hn::Set(kD, hi));
    return hn::DemoteTo(kI, hn::Round(clamped));
}

// Snaps the Lanes(kD) positions at p; returns how many are outside.
HWY_INLINE std::size_t snap_vector(const ScreenTransform& t, const double* HWY_RESTRICT p,
                                   std::int32_t* HWY_RESTRICT out) {
    V px, py, pz;
    hn::LoadInterleaved3(kD, p, px, py, pz);
    const V d = linear(t.d_row, px, py, pz);
    V hx = linear(t.x_row, px, py, pz);
    V hy = linear(t.y_row, px, py, pz);
    V depth = d;
    if (t.perspective) {
        depth = hn::Div(hn::Set(kD, 1.0), d);
        hx = hn::Mul(hx, depth);
        hy = hn::Mul(hy, depth);
    }
    const V sx = hn::Add(hn::Set(kD, t.cx), hx);
    const V sy = hn::Add(hn::Set(kD, t.cy), hy);
    const V sz = hn::Add(hn::Set(kD, t.z_offset), hn::Mul(hn::Set(kD, t.z_scale), depth));

    const ViewVolume& v = t.volume;
    const auto in_depth =
        hn::And(hn::Ge(d, hn::Set(kD, v.near_plane)), hn::Le(d, hn::Set(kD, v.far_plane)));
    const auto in_x = hn::And(hn::Ge(sx, hn::Set(kD, v.x_min)), hn::Le(sx, hn::Set(kD, v.x_max)));
    const auto in_y = hn::And(hn::Ge(sy, hn::Set(kD, v.y_min)), hn::Le(sy, hn::Set(kD, v.y_max)));
    const auto inside = hn::And(in_depth, hn::And(in_x, in_y));

    // An x beyond the volume, turned into the mark of "outside" by the conversion's range.
    constexpr double kMark = static_cast<double>(kOutside);
    const V marked =
        hn::IfThenElse(inside, hn::Min(hn::Max(sx, hn::Set(kD, v.x_min)), hn::Set(kD, v.x_max)),
                       hn::Set(kD, kMark));
    // At the eye's plane the others may be no numbers at all.
    hn::StoreInterleaved4(hn::DemoteTo(kI, hn::Round(marked)),
                          round_clamped(hn::IfThenElseZero(inside, sy), v.y_min, v.y_max),
                          round_clamped(hn::IfThenElseZero(inside, sz), 0.0, kDepthMax),
                          hn::Zero(kI), kI, out);
    return hn::Lanes(kD) - hn::CountTrue(kD, inside);
}

std::size_t snap_all(const ScreenTransform& t, const double* HWY_RESTRICT p, std::size_t n,
                     ScreenPoint* points) {
    static_assert(sizeof(ScreenPoint) == 4 * sizeof(std::int32_t));
    const std::size_t lanes = hn::Lanes(kD);
    std::size_t outside = 0, i = 0;
    for (; i + lanes <= n; i += lanes)
        outside += snap_vector(t, p + 3 * i, reinterpret_cast<std::int32_t*>(points + i));
    if (i == n) return outside;

    double tail[3 * hn::MaxLanes(Doubles())];
    ScreenPoint snapped[hn::MaxLanes(Doubles())];
    for (std::size_t k = 0; k < lanes; ++k)
        for (std::size_t c = 0; c < 3; ++c) tail[3 * k + c] = p[3 * (i + k < n ? i + k : i) + c];
    (void)snap_vector(t, tail, reinterpret_cast<std::int32_t*>(snapped));
    for (std::size_t k = 0; i + k < n; ++k) {
        points[i + k] = snapped[k];
        outside += snapped[k].x == kOutside ? 1 : 0;
    }
    return outside;
}

}  // namespace
}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {

HWY_EXPORT(snap_all);

std::size_t snap_positions(const ScreenTransform& transform, std::span<const glm::dvec3> positions,
                           ScreenPoint* points) {
    static_assert(sizeof(glm::dvec3) == 3 * sizeof(double));
    return HWY_DYNAMIC_DISPATCH(snap_all)(
        transform, reinterpret_cast<const double*>(positions.data()), positions.size(), points);
}

}  // namespace sightline
#endif  // HWY_ONCE
