// Whether points are coplanar in the world, decided exactly on numbers in double precision.
#pragma once

#include <array>
#include <glm/vec3.hpp>

namespace sightline::math {

/// Whether a point lies in the plane through three others; true where these lie on a line.
[[nodiscard]] bool is_in_plane(const std::array<glm::dvec3, 3>& plane, const glm::dvec3& point);

/// Whether a direction is parallel to the plane through three points; true where these lie on a
/// line.
[[nodiscard]] bool is_parallel_to_plane(const std::array<glm::dvec3, 3>& plane,
                                        const glm::dvec3& direction);

}  // namespace sightline::math
