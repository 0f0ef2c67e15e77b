// Newell's method: the normal of a polygon from the areas of its three projections.
// Source: M. E. Newell's method as given in Sutherland, Sproull, Schumacker, "A Characterization of
// Ten Hidden-Surface Algorithms", Computing Surveys 6(1), 1974. Right also for concave and slightly
// warped polygons.
#pragma once

#include <glm/vec3.hpp>
#include <span>

namespace sightline::math {

/// Twice the area vector of a polygon: it points to the side from which the corners run
/// counter-clockwise. Zero when there is no area. O(corners).
[[nodiscard]] inline glm::dvec3 newell_normal(std::span<const glm::dvec3> corners) {
    glm::dvec3 normal{0, 0, 0};
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3& p = corners[i];
        const glm::dvec3& q = corners[i + 1 == corners.size() ? 0 : i + 1];
        normal.x += (p.y - q.y) * (p.z + q.z);
        normal.y += (p.z - q.z) * (p.x + q.x);
        normal.z += (p.x - q.x) * (p.y + q.y);
    }
    return normal;
}

}  // namespace sightline::math
