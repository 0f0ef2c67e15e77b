// The file of `visible --from-directions`.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "sightline/error.hpp"

namespace sightline::cli {

/// One direction x,y,z a line; blanks instead of commas will do, and '#' begins a comment. None of
/// them is 0,0,0.
[[nodiscard]] Result<std::vector<glm::dvec3>> read_directions(const std::string& path);

}  // namespace sightline::cli
