// Finishing of scenes whose positions are known to be in order.
#pragma once

#include "sightline/scene.hpp"

namespace sightline {

/// finish_scene() in less time. Precondition: every position belongs to one object and is used by
/// its triangles, and an object's positions are distinct (as SceneBuilder leaves them).
void finish_joined_scene(Scene& scene, double weld);

/// finish_scene() for what has moved since it was finished: nothing is joined once more.
void finish_posed_scene(Scene& scene);

/// finish_scene() for curved surfaces, which have no coplanar faces to speak of. Precondition: an
/// object's positions are distinct and its own.
void finish_scene_without_sheets(Scene& scene);

}  // namespace sightline
