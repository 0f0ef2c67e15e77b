// The triangulation of a polygon whose triangles have the least area in all.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "scene/load/ear_cutter.hpp"

namespace sightline::load {

/// Triangulates one polygon after another, with the same scratch memory.
class LeastArea {
public:
    /// Corners of the largest polygon that it takes.
    static constexpr std::size_t kMostCorners = 256;
    /// Steps for all polygons together, some seconds.
    static constexpr std::uint64_t kWorkLimit = std::uint64_t{1} << 30;

    /// Replaces `triangles` by n - 2 triangles with n >= 3 corners whose areas, all counted as
    /// positive, have the least sum; where no side crosses another one, none is turned over then.
    /// False, and nothing done, for polygons that are too large, and when the work limit would be
    /// passed. O(n^3).
    bool cut(std::span<const glm::dvec2> points, std::vector<PolygonTriangle>& triangles);

private:
    /// The best that can be done with the corners from one to another.
    struct Part {
        double area = 0;
        std::uint32_t apex = 0;  ///< of the triangle on the diagonal between the two
    };

    std::vector<Part> parts_;  ///< from * n + to, from < to
    std::uint64_t work_ = 0;
};

}  // namespace sightline::load
