// scene.json: models with their places, quadrics, lights, a camera. The schema is in
// docs/scene-file.md.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/load/build.hpp"
#include "sightline/camera.hpp"
#include "sightline/error.hpp"
#include "sightline/scene.hpp"

namespace sightline::load {

struct ModelEntry {
    std::string path;  ///< as written: relative to the scene file
    std::optional<std::string> name;
    glm::dmat4 transform{1.0};
    MaterialOverride material;
};

struct SurfaceEntry {
    Quadric quadric;   ///< in its place
    std::string name;  ///< that of its kind when it has none
    MaterialOverride material;
};

struct SceneDescription {
    std::vector<ModelEntry> models;  ///< models and surfaces: at least one of both
    std::vector<SurfaceEntry> surfaces;
    std::vector<Light> lights;
    std::optional<CameraOptions> camera;
};

/// Parses a scene description; touches no file. Errors (bad_input) name the value by its path, as
/// in "scene.json: models[1].path: missing".
[[nodiscard]] Result<SceneDescription> parse_scene_description(std::string_view text,
                                                               const std::string& name);

}  // namespace sightline::load
