// Which objects are closed: only their back faces may be removed.
#pragma once

#include "sightline/scene.hpp"

namespace sightline {

/// Sets Object::closed of every object. Triangles that are dropped (two corners equal, no area)
/// are no part of the surface. Needs positions, triangles and objects only. O(n log n) in the worst
/// case, O(n) on meshes.
void find_closed_objects(Scene& scene);

/// The same where Scene::degenerate says which triangles are dropped. With `joined`, equal
/// positions of an object must share an index.
void find_closed_objects(Scene& scene, bool joined);

}  // namespace sightline
