// Foreign formats through the Open Asset Import Library. Reading is for the child process only.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "scene/load/soup.hpp"

namespace sightline::load {

/// Where a model comes from.
struct Source {
    std::string name;                  ///< in messages
    std::string path;                  ///< of a regular file; "" when the model is in memory
    std::string format;                ///< lower case
    std::span<const std::byte> bytes;  ///< all of it; may be empty when there is a path
    std::span<const std::string> allowed_paths;  ///< see LoadOptions
};

/// Extensions that assimp knows, lower case, sorted. Reads no file.
[[nodiscard]] std::vector<std::string> assimp_extensions();

/// Parses a model: a soup, or one line that says why there is none. May crash, hang or eat memory
/// on a hostile file, and leaks what it takes: call it in run_contained().
[[nodiscard]] std::variant<Soup, std::string> read_with_assimp(const Source& source);

}  // namespace sightline::load
