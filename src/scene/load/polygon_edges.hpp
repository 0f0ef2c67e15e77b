// Which sides of the triangles of a polygon are sides of the polygon.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "scene/load/ear_cutter.hpp"

namespace sightline::load {

/// Bit k: side k of the triangle (from its corner k to the next) is a side of the polygon of n
/// corners, not a diagonal.
[[nodiscard]] std::uint8_t polygon_edge_bits(const PolygonTriangle& triangle, std::uint32_t n);

/// Replaces `bits` by those of all triangles of a polygon. What is cut off without area is not
/// drawn, so it hands its marks on: a diagonal that sides of the polygon cover is marked as one.
/// O(n log n) where there are such triangles, else O(n).
void find_polygon_edges(std::span<const glm::dvec3> corners,
                        std::span<const PolygonTriangle> triangles,
                        std::vector<std::uint8_t>& bits);

}  // namespace sightline::load
