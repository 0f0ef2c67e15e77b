#include "math/predicates.hpp"

#include <cassert>
#include <cmath>

namespace sightline {

namespace {

// The depth of a plane in double precision, and a bound of its error.
//
// With u = 2^-53: a and c are converted (relative error u each), divided (u) and multiplied by an
// exact difference of coordinates (u), so a term a/c * dx is off by at most 4.01 u |t|; the two
// additions add 2.01 u (|tx| + |ty| + at.z). Together less than 7 u (|tx| + |ty| + at.z); 8 leaves
// room for the rounding of the bound itself.
struct Approximate {
    double z, error;
};

Approximate approximate_depth(const Plane& plane, std::int32_t x, std::int32_t y) {
    constexpr double kUnit = 0x1p-53;
    const double c = static_cast<double>(plane.c);
    const double tx = static_cast<double>(plane.a) / c * (static_cast<double>(x) - plane.at.x);
    const double ty = static_cast<double>(plane.b) / c * (static_cast<double>(y) - plane.at.y);
    return {plane.at.z + (tx + ty), 8 * kUnit * (std::abs(tx) + std::abs(ty) + plane.at.z)};
}

}  // namespace

Plane plane_through(const ScreenPoint& p, const ScreenPoint& q, const ScreenPoint& r) {
    const std::int64_t ux = std::int64_t{q.x} - p.x, uy = std::int64_t{q.y} - p.y,
                       uz = std::int64_t{q.z} - p.z;
    const std::int64_t vx = std::int64_t{r.x} - p.x, vy = std::int64_t{r.y} - p.y,
                       vz = std::int64_t{r.z} - p.z;
    // Normal n = u x v; n . (s - p) = 0 solved for z gives c z = -nx dx - ny dy.
    Plane plane{uz * vy - uy * vz, ux * vz - uz * vx, ux * vy - uy * vx, p};
    if (plane.c < 0) {
        plane.a = -plane.a;
        plane.b = -plane.b;
        plane.c = -plane.c;
    }
    return plane;
}

int compare_depth_exactly(const Plane& p, const Plane& q, std::int32_t x, std::int32_t y) {
    assert(p.c > 0 && q.c > 0);
    return sign_of(depth_numerator(p, x, y) * q.c - depth_numerator(q, x, y) * p.c);
}

DepthOrder compare_depth(const Plane& p, const Plane& q, std::int32_t x, std::int32_t y) {
    const Approximate zp = approximate_depth(p, x, y), zq = approximate_depth(q, x, y);
    const double difference = zp.z - zq.z;
    // The subtraction rounds once more; doubling the bound covers it.
    if (std::abs(difference) > 2 * (zp.error + zq.error))
        return {difference < 0 ? -1 : 1, Stage::filter};
    return {compare_depth_exactly(p, q, x, y), Stage::exact};
}

}  // namespace sightline
