// Clustering of coplanar faces into sheets.
#pragma once

#include "sightline/scene.hpp"

namespace sightline {

/// How far corners may stand off a plane in which they count as lying, in a scene with these
/// bounds and this Scene::rounding.
[[nodiscard]] double coplanar_tolerance(const Box& bounds, double rounding);

/// Fills scene.sheets. Preconditions: scene.bounds and scene.degenerate are set. The clusters do
/// not depend on the order of the triangles or on the number of threads. O(n log n) for meshes
/// whose planes are spread out; quadratic in the number of parallel planes closer than 1/500 of the
/// scene.
void build_sheets(Scene& scene);

}  // namespace sightline
