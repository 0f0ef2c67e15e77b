// What a PLY file announces, checked before assimp reads it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace sightline::load {

/// Length of a file's beginning that is enough for ply_problem().
inline constexpr std::size_t kPlyHeaderBytes = std::size_t{1} << 16;

/// Why a PLY file that begins like this can't be read ("cause; way out"), or nothing. assimp reads
/// triangle strips silently as one polygon.
[[nodiscard]] std::optional<std::string> ply_problem(std::string_view beginning);

}  // namespace sightline::load
