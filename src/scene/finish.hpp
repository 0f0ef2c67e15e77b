// Finishing of scenes whose positions are known to be in order.
#pragma once

#include <optional>

#include "sightline/scene.hpp"

namespace sightline {

enum class FindSheets { yes, no };

struct FinishOptions {
    std::optional<glm::dvec3> offset;  ///< the scene's, when it is decided already
    double weld = kWeldTolerance;
    FindSheets sheets = FindSheets::yes;
};

/// finish_scene() in less time. Precondition: every position belongs to one object and is used by
/// its triangles, and an object's positions are distinct (as SceneBuilder leaves them).
void finish_joined_scene(Scene& scene, const FinishOptions& options = {});

/// finish_scene() for what is made of a finished scene: the offset stays, 0 too, and nothing is
/// joined once more.
void finish_derived_scene(Scene& scene);

/// finish_scene() for curved surfaces, which have no coplanar faces to speak of, in the coordinates
/// of their fields: the offset is 0. Precondition: an object's positions are distinct and its own.
void finish_scene_without_sheets(Scene& scene);

}  // namespace sightline
