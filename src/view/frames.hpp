// Directions of gaze and of the page's up for the named views.
#pragma once

#include <glm/vec3.hpp>

#include "sightline/camera.hpp"

namespace sightline {

/// Where a camera looks and what is up on its page (not necessarily perpendicular to the gaze).
struct Aim {
    glm::dvec3 gaze, up;
};

/// A named view in a world whose up is `world_up`: the views of a +Y-up world, turned by the
/// shortest rotation that carries +Y to it. Precondition: world_up is not zero.
[[nodiscard]] Aim aim_of(NamedView view, const glm::dvec3& world_up);

}  // namespace sightline
