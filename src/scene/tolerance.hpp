// How far positions can be off.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "sightline/scene.hpp"

namespace sightline {

/// Coordinates in files are floats or decimals of about six digits, which a part of the size of
/// what they describe, or of the largest one, is lost of: half the diagonal of the box, or a
/// quarter of its largest coordinate if that is more, times 2^-20. `rounding` is Scene::rounding,
/// 2^-24 of what was the largest coordinate before the scene was moved to the origin.
[[nodiscard]] inline double size_of(const Box& box, double rounding) {
    double largest = 0;
    for (int axis = 0; axis < 3; ++axis)
        largest = std::max({largest, std::abs(box.lo[axis]), std::abs(box.hi[axis])});
    return std::max({0.5 * glm::length(box.extent()), 0.25 * largest, 0x1p22 * rounding});
}
[[nodiscard]] inline double rounding_of(const Box& box, double rounding) {
    return 0x1p-20 * size_of(box, rounding);
}

}  // namespace sightline
