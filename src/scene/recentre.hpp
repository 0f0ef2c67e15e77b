// Scenes far from the origin: moved next to it, exactly, and the offset kept.
//
// Tolerances and the rounding of transforms grow with the largest coordinate. A staircase that
// stands where a map grid counts in millions of metres would be drawn worse than the same one at
// the origin, though doubles tell its steps apart in both places.
#pragma once

#include "sightline/scene.hpp"

namespace sightline {

/// Gives a scene an offset: positions, quadrics, point lights and the frames of motions become
/// relative to it. Positions and quadrics are moved exactly when offset_for() chose the offset for
/// a box that holds them; lights and frames are rounded once, to 2^-52 of the larger of the
/// coordinates that are subtracted. Precondition: it has none yet. O(positions), on all cores.
void move_to_offset(Scene& scene, const glm::dvec3& offset);

/// Gives a scene without an offset the one it needs; whether it needs one. Precondition:
/// scene.bounds is the box of its triangles. What is derived from positions, the bounds too, has to
/// be found afterwards.
bool recentre(Scene& scene);

}  // namespace sightline
