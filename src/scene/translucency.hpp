// Which objects and triangles let something shine through.
#pragma once

#include "sightline/scene.hpp"

namespace sightline {

/// Fills in Object::translucent_vertices.
void find_translucent_vertices(Scene& scene);

}  // namespace sightline
