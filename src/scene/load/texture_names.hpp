// The textures that a model names. They are not read, but no output may overwrite them; so where a
// statement can be understood in several ways, each of them counts.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace sightline::load {

/// The names that the rest of a line may hold, the most likely first: with or without quotes and a
/// comment, all of it or its last word. None when it is blank.
[[nodiscard]] std::vector<std::string> names_in(std::string_view text);

/// The names, likewise, in what follows the keyword of a texture in an MTL file: options, then a
/// name.
[[nodiscard]] std::vector<std::string> names_in_map(std::string_view text);

/// Where a file may lie that is named in a file in `folder`: its name may be relative to that, have
/// the slashes of Windows, or lead through folders that are not here: then it lies in `folder`.
[[nodiscard]] std::vector<std::string> places_of(const std::filesystem::path& folder,
                                                 std::string_view name);

struct TextureNames {
    std::set<std::string> names;      ///< for messages
    std::vector<std::string> places;  ///< where they may lie
};

/// The textures that these texts name in a model at this path; "" for one without a place.
[[nodiscard]] TextureNames textures_in(const std::vector<std::string>& texts,
                                       const std::string& model);

/// The note of Soup::notes about textures with these names; "" when there are none.
[[nodiscard]] std::string note_of_textures(const std::set<std::string>& names);

}  // namespace sightline::load
