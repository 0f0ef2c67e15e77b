// What moving objects need when a scene is finished.
#pragma once

#include "sightline/scene.hpp"

namespace sightline {

/// The box around all frames of the motions and around what stands still. Precondition:
/// scene.bounds is set. O(triangles + frames times what moves).
[[nodiscard]] Box reach_of(const Scene& scene);

}  // namespace sightline
