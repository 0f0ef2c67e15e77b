// Finishing of scenes whose positions are known to be in order.
#pragma once

#include "sightline/scene.hpp"

namespace sightline {

enum class FindSheets { yes, no };

/// finish_scene() in less time. Precondition: every position belongs to one object and is used by
/// its triangles, and an object's positions are distinct (as SceneBuilder leaves them).
void finish_joined_scene(Scene& scene, FindSheets sheets = FindSheets::yes);

/// finish_scene() for curved surfaces, which have no coplanar faces to speak of. Precondition: an
/// object's positions are distinct and its own.
void finish_scene_without_sheets(Scene& scene);

}  // namespace sightline
