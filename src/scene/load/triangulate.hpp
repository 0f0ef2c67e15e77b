// Polygons into triangles.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "scene/load/ear_cutter.hpp"

namespace sightline::load {

/// Bit k: side k of the triangle (from its corner k to the next) is a side of the polygon of n
/// corners, not a diagonal.
[[nodiscard]] std::uint8_t polygon_edge_bits(const PolygonTriangle& triangle, std::uint32_t n);

/// Triangulates one polygon after another. Not thread-safe; use one a thread.
class Triangulator {
public:
    /// What a polygon turned out to be.
    enum class Shape { convex, concave, too_complex };

    /// Replaces `triangles` by exactly n - 2 triangles of the polygon with these n >= 3 corners:
    /// a fan from the first corner when the polygon is convex and no triangle of that fan is
    /// without area, else ears cut off in the polygon's plane. Corners that coincide, lie on a
    /// line, or touch other sides are fine; where sides cross, the triangles still share the
    /// polygon's corners and sides, but overlap. Typically O(n log n). `too_complex` (and no
    /// triangles) when all polygons so far took EarCutter::kWorkLimit steps.
    Shape triangulate(std::span<const glm::dvec3> corners, std::vector<PolygonTriangle>& triangles);

private:
    EarCutter ears_;
    std::vector<glm::dvec3> relative_;
    std::vector<glm::dvec2> flat_;
};

}  // namespace sightline::load
