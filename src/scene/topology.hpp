// Which objects are closed: only their back faces may be removed.
#pragma once

#include "scene/weld.hpp"
#include "sightline/scene.hpp"

namespace sightline {

/// Sets Object::closed and two_sided of every object, and Scene::equal_faces. Triangles that are
/// dropped (two corners equal, no area) are no part of the surface. Needs positions, triangles,
/// their polygons and objects only. O(n log n) in the worst case, O(n) on meshes.
void find_closed_objects(Scene& scene);

/// The same where Scene::degenerate says which triangles are dropped. With `joined`, equal
/// positions of an object must share an index. Answers which positions of objects that are not
/// closed should be joined (see find_joins()); none with weld = 0.
[[nodiscard]] Joins find_closed_objects(Scene& scene, bool joined, double weld);

}  // namespace sightline
