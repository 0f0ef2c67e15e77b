// Unit vectors that survive anything.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace sightline {

/// v / |v|, or `otherwise` when v has no direction (zero, infinite or NaN).
[[nodiscard]] inline glm::dvec3 unit_or(glm::dvec3 v, glm::dvec3 otherwise) {
    double square = glm::dot(v, v);
    if (!(square > 1e-200 && square < 1e200)) {
        // Scaled first, its square neither over- nor underflows.
        const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
        if (!(largest > 0 && largest <= 1e300)) return otherwise;
        v = v / largest;
        square = glm::dot(v, v);
        if (!(square >= 1)) return otherwise;
    }
    return v * (1.0 / std::sqrt(square));
}

}  // namespace sightline
