// The curves in which faces cross each other, as segments of the page.
//
// Source: T. Möller, "A Fast Triangle-Triangle Intersection Test", Journal of Graphics Tools 2(2),
// 1997: each triangle's corners against the other's plane, then intervals on the common line. How
// this version differs: all signs are exact on the integers of the page, and the common line is
// that where both planes have one depth, the planes that decide what is seen: corners of faces that
// share a plane lie beside it. What touches (a corner or an edge in the other's plane) does not
// cross, except where the surface goes on to the other side: an edge that lies in a plane is a
// crossing when its two faces lie on different sides. docs/exactness.md has the definition in full.
//
// The ends of a segment are rounded to the grid once, and neighbouring segments share them; from
// there on a segment is an edge like any other.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "drawing/occluders.hpp"
#include "drawing/work_meter.hpp"

namespace sightline {

/// A segment of a curve of intersection; `faces` are the two triangles, ascending.
struct Crossing {
    ScreenPoint p, q;
    std::array<std::uint32_t, 2> faces{};
};

/// All crossings of the occluders of a page, in an order that depends on the page
/// alone. About O(n log n) plus the pairs whose boxes meet, on all cores. Faces seen edge-on have
/// no area on the page and no part in it. Nothing complete once the meter has stopped.
[[nodiscard]] std::vector<Crossing> find_crossings(const Occluders& occluders, int threads,
                                                   WorkMeter& meter);

}  // namespace sightline
