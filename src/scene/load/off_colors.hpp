// Finds out what assimp's reader of OFF files leaves out without a word.
#pragma once

#include <string_view>

namespace sightline::load {

/// Whether the first face of an OFF file (text) has a colour behind its corners.
[[nodiscard]] bool off_has_face_colors(std::string_view text);

}  // namespace sightline::load
