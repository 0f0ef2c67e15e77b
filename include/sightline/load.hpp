// Loading models and scene descriptions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sightline/error.hpp"
#include "sightline/scene.hpp"

namespace sightline {

struct LoadOptions {
    /// Format of standard input, or an override of the extension: "obj", "ply", ... "" = by
    /// extension.
    std::string format;
    /// Positions on open edges that are no further apart than this part of their object's size are
    /// joined; 0: none but equal ones. See finish_scene().
    double weld = kWeldTolerance;
    /// Folders in which the files that a model names (buffers, textures, material libraries) may
    /// lie, besides the model's own folder, what is below it, and the folder `textures` beside it.
    std::vector<std::string> allowed_paths;
    /// Limits on the parsing of a foreign file.
    double time_limit_seconds = 120;
    std::size_t memory_limit_bytes = std::size_t{8} << 30;
    std::size_t file_limit_bytes = std::size_t{4} << 30;
    /// Scene::offset, when it is decided already: parts of a larger scene share that of the whole,
    /// offset_for() its box. 0 keeps the coordinates of the files.
    std::optional<glm::dvec3> offset;
    /// Files that the caller is going to write. A model that reads one of them, or names it as a
    /// texture, is refused (bad_option), so that no output takes the place of an input.
    std::vector<std::string> outputs;
    /// False: Scene::sheets stay empty, for they will be those of a StreamPlan.
    bool find_sheets = true;
};

/// Loads one or several files (models or scene.json) into one finished scene; "-" is standard input
/// and needs LoadOptions::format. OBJ, STL and PLY are parsed by readers of our own, other foreign
/// formats in a child process; all with limits on time and memory, so that no file can bring the
/// caller down. Objects that move are at rest; see posed().
/// Errors name the file, the cause and the way out. Not thread-safe against fork().
[[nodiscard]] Result<Scene> load_scene(std::span<const std::string> paths,
                                       const LoadOptions& options = {});

/// The same from bytes in memory; `name` is used in messages, `format` is required.
[[nodiscard]] Result<Scene> load_scene_from_memory(std::span<const std::byte> bytes,
                                                   const std::string& name,
                                                   const LoadOptions& options);

/// Reads the cameras of a path: a JSON list of objects with the keys of a camera in scene.json.
/// Errors name the file and the value.
[[nodiscard]] Result<std::vector<CameraOptions>> load_camera_path(const std::string& path);

/// Extensions (lower case, without the dot) that load_scene() reads, sorted.
[[nodiscard]] std::vector<std::string> loadable_extensions();

}  // namespace sightline
