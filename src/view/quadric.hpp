// Quadrics in a view.
#pragma once

#include <vector>

#include "sightline/screen_scene.hpp"
#include "view/transform.hpp"

namespace sightline {

/// The rays of a view in the own coordinates of each quadric, and where on the screen it can be
/// seen. O(quadrics).
void make_screen_quadrics(const std::vector<Quadric>& quadrics, const Camera& camera,
                          const ScreenTransform& transform, ScreenQuadrics& out);

}  // namespace sightline
