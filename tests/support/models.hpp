// Real meshes for tests. They are not part of the repository: SIGHTLINE_MODELS names their folder,
// and without it a folder `shared/models` beside the repository is looked for.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sightline/sightline.hpp"

namespace sightline::testing {

inline std::filesystem::path models_folder() {
    if (const char* folder = std::getenv("SIGHTLINE_MODELS")) return folder;
    return std::filesystem::path(SIGHTLINE_SOURCE_DIR) / ".." / "shared" / "models";
}

/// The loaded model, or nothing when the file is not there.
inline std::optional<Scene> real_model(const std::string& name) {
    const std::filesystem::path path = models_folder() / name;
    if (!std::filesystem::exists(path)) return std::nullopt;
    const std::vector<std::string> paths{path.string()};
    Result<Scene> scene = load_scene(paths);
    if (!scene) throw std::runtime_error(scene.error().message);
    return std::move(scene).value();
}

}  // namespace sightline::testing
