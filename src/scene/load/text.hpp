// Text from foreign files, made fit for messages and outputs.
#pragma once

#include <set>
#include <string>
#include <string_view>

namespace sightline::load {

/// The text with control characters and bytes that are no UTF-8 replaced by '?'.
[[nodiscard]] std::string clean_text(std::string_view text);

/// The text without the byte order mark (UTF-8) that some programs begin it with.
[[nodiscard]] std::string_view without_mark(std::string_view text);

/// The last component of a path of any system.
[[nodiscard]] std::string_view last_component(std::string_view path);

/// The extension of a file's name in lower case, without the dot; "" when there is none.
[[nodiscard]] std::string extension_of(std::string_view path);

/// The name of a file without its folders and extension.
[[nodiscard]] std::string stem_of(std::string_view path);

/// The first line of a message of a foreign library, cleaned and cut to a readable length.
[[nodiscard]] std::string one_line(std::string_view message);

/// As much of a text that a user gave as a message repeats: 80 bytes, whole characters.
[[nodiscard]] std::string shortened(std::string_view text);

/// Where a file lies that a model names: its name may be relative to the model's folder and have
/// the slashes of Windows.
[[nodiscard]] std::string path_beside(const std::string& model, std::string_view name);

/// What is noted of a file whose faces have colours.
inline constexpr std::string_view kNoFaceColors = "colours of faces are not read";

/// What is noted of the textures of a file, by their names; "" when there are none.
[[nodiscard]] std::string note_of_textures(const std::set<std::string>& names);

}  // namespace sightline::load
