// Clipping of triangles and lines against the near plane, the far plane and the guard band.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "view/transform.hpp"

namespace sightline {

/// Cuts a triangle of the world by the view volume and appends the snapped corners of what remains,
/// a convex polygon of up to 9 corners in the order of the triangle's corners; nothing when it lies
/// outside. Triangles that share an edge get the same points on it.
void clip_triangle(const ScreenTransform& transform, const std::array<glm::dvec3, 3>& corners,
                   std::vector<ScreenPoint>& polygon);

/// The same of a line: its snapped ends, or nothing when it lies outside. A side of a triangle gets
/// the ends that clip_triangle() gives it.
[[nodiscard]] std::optional<std::pair<ScreenPoint, ScreenPoint>> clip_line(
    const ScreenTransform& transform, const glm::dvec3& from, const glm::dvec3& to);

}  // namespace sightline
