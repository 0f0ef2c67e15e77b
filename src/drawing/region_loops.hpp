// From pieces of a border to the loops of a region.
#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "drawing/regions.hpp"

namespace sightline {

/// Closed polygons: loop i has the points first[i] .. first[i + 1] - 1.
struct RegionLoops {
    std::vector<std::uint32_t> first;
    std::vector<glm::ivec2> points;
};

/// Joins the pieces of the visible parts of one source polygon. What two of its triangles have in
/// common (a piece and its reverse) goes, so do points in the middle of a straight line. Every
/// point has as many pieces that arrive as leave, since rounding keeps that, so loops always close.
/// O(n log n). `pieces` is used up.
void join_loops(std::vector<BorderPiece>& pieces, RegionLoops& loops);

}  // namespace sightline
