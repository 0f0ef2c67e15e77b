// Random polygons whose area is known, drawn as outlines that touch and retrace themselves.
//
// Regions (unions of cells with holes, or random simple polygons, in several parts) become one
// outline: parts and holes are joined by bridges of no width, spikes are added, corners repeated
// and put in the middle of sides. None of that changes where the outline winds around a point once.
// Coordinates are integers below 2^20, so all that is decided about them here is exact in 64 bits.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

namespace sightline::testing {

using Point = glm::i64vec2;
using Loop = std::vector<Point>;

/// Twice the signed area of a triangle, and of a polygon.
[[nodiscard]] inline std::int64_t cross(Point a, Point b, Point c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}
[[nodiscard]] std::int64_t doubled_area(const Loop& loop);

[[nodiscard]] bool on_a_side(const std::vector<Loop>& loops, Point at);
/// How often loops wind around a point that lies on none of their sides.
[[nodiscard]] int winding(const std::vector<Loop>& loops, Point at);

struct DecoratedPolygon {
    std::vector<Loop> region;  ///< outlines counter-clockwise, holes clockwise, without ornament
    Loop outline;              ///< the same as one polygon
};

struct Ornament {
    int parts = 3;   ///< at most, beside holes
    int spikes = 4;  ///< at most
    /// Bridges between parts may run anywhere, also through a part or over one another, where no
    /// part has a hole (its bridge could be cut off).
    bool wild_bridges = false;
};

[[nodiscard]] DecoratedPolygon random_polygon(std::uint64_t seed, const Ornament& ornament);

}  // namespace sightline::testing
