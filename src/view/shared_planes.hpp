// Choosing the one plane of faces that are coplanar in the world.
#pragma once

#include <span>

#include "sightline/screen_scene.hpp"

namespace sightline {

/// The plane through three of the points that lie far apart on the page, so that no other point of
/// them is extrapolated to by much; c = 0 when they are collinear on the page. Does not depend on
/// the order of the points.
[[nodiscard]] Plane plane_of_spread_points(std::span<const ScreenPoint> points);

}  // namespace sightline
