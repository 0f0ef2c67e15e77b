// The depth of a winner, in the two precisions in which it leaves an algorithm.
#include <algorithm>
#include <cmath>

#include "math/predicates.hpp"
#include "sightline/visibility.hpp"
#include "visibility/stored_depth.hpp"

namespace sightline {

double evaluate_depth(const Plane& plane, std::int32_t x, std::int32_t y) {
    // The numerator relative to the anchor is exact (2b + Z + 2 bits), so nothing cancels: each of
    // the two conversions, the division and the addition is off by at most 2^-53 of 2^30.
    const Int128 rise = Int128{plane.a} * (std::int64_t{x} - plane.at.x) +
                        Int128{plane.b} * (std::int64_t{y} - plane.at.y);
    const double z = plane.at.z + static_cast<double>(rise) / static_cast<double>(plane.c);
    return std::clamp(z, 0.0, static_cast<double>(kStoredDepthMax));
}

float stored_depth(const Plane& plane, std::int32_t x, std::int32_t y) {
    const DepthGradient g = depth_gradient(plane);
    const float tx = g.gx * static_cast<float>(x - plane.at.x);
    const float ty = g.gy * static_cast<float>(y - plane.at.y);
    if (std::abs(tx) + std::abs(ty) > kRegularRise)
        return static_cast<float>(evaluate_depth(plane, x, y));
    return std::clamp(g.z0 + (tx + ty), 0.0f, kStoredDepthMax);
}

}  // namespace sightline
