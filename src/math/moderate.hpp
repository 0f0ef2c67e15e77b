// Directions of any length, made fit to be computed with.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>

namespace sightline::math {

/// Scales a direction by a power of two if squares of its components would overflow or vanish, and
/// else leaves it as it is. That rounds nothing that counts. Zero stays zero.
inline glm::dvec3 moderate(const glm::dvec3& direction) {
    constexpr int kLargestExponent = 300;
    const double largest =
        std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
    if (largest == 0 || !std::isfinite(largest)) return direction;
    const int exponent = std::ilogb(largest);
    if (std::abs(exponent) <= kLargestExponent) return direction;
    return {std::ldexp(direction.x, -exponent), std::ldexp(direction.y, -exponent),
            std::ldexp(direction.z, -exponent)};
}

}  // namespace sightline::math
