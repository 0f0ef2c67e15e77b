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
    std::vector<glm::dmat4> frames;  ///< after the transform; empty: it doesn't move
    MaterialOverride material;
};

struct SurfaceEntry {
    Quadric quadric;                 ///< in its place
    std::string name;                ///< that of its kind when it has none
    std::vector<glm::dmat4> frames;  ///< of a model; the quadric is regular in all of them
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

/// Parses a list of cameras, each as in a scene description. Errors as there: "[2].eye: ...".
[[nodiscard]] Result<std::vector<CameraOptions>> parse_camera_path(std::string_view text,
                                                                   const std::string& name);

}  // namespace sightline::load
