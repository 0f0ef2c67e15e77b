// Finishing of scenes whose positions are known to be in order.
#pragma once

#include <optional>

#include "sightline/scene.hpp"

namespace sightline {

/// finish_scene() in less time. Precondition: every position belongs to one object and is used by
/// its triangles, and an object's positions are distinct (as SceneBuilder leaves them). `offset`:
/// the scene's, when it is decided already.
void finish_joined_scene(Scene& scene, const std::optional<glm::dvec3>& offset = std::nullopt);

/// finish_scene() for what is made of a finished scene: the offset stays, 0 too.
void finish_derived_scene(Scene& scene);

/// finish_scene() for curved surfaces, which have no coplanar faces to speak of, in the coordinates
/// of their fields: the offset is 0. Precondition: an object's positions are distinct and its own.
void finish_scene_without_sheets(Scene& scene);

}  // namespace sightline
