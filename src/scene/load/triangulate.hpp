// Polygons into triangles.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "scene/load/ear_cutter.hpp"
#include "scene/load/least_area.hpp"

namespace sightline::load {

/// Triangulates one polygon after another. Not thread-safe; use one a thread.
class Triangulator {
public:
    /// What a polygon turned out to be.
    enum class Shape { convex, concave, too_complex };

    /// Steps for all polygons together, some ten seconds: only a file made for it needs more.
    static constexpr std::uint64_t kWorkLimit = std::uint64_t{1} << 32;

    /// Replaces `triangles` by exactly n - 2 triangles of the polygon with these n >= 3 corners:
    /// a fan from the first corner when the polygon is convex and no triangle of that fan is
    /// without area, else ears cut off in the polygon's plane. Corners that coincide, lie on a
    /// line, or touch other sides are fine, and so are spikes and bridges of no width: the
    /// triangles cover what the polygon does, once. Where sides cross, they still share the
    /// polygon's corners and sides, but overlap: as little as they can, up to
    /// LeastArea::kMostCorners. O(n log n), and up to O(n sqrt n) where ears are long and narrow.
    /// `too_complex` (and no triangles) when all polygons so far took kWorkLimit steps.
    Shape triangulate(std::span<const glm::dvec3> corners, std::vector<PolygonTriangle>& triangles);

private:
    void mend(double over, std::vector<PolygonTriangle>& triangles);

    EarCutter ears_, loose_ears_;
    LeastArea least_area_;
    std::vector<glm::dvec3> relative_;
    std::vector<glm::dvec2> flat_;
    std::vector<PolygonTriangle> loose_;
};

}  // namespace sightline::load
