// Text from foreign files, made fit for messages and outputs.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace sightline::load {

/// The bytes of a file as characters.
[[nodiscard]] std::string_view text_of(std::span<const std::byte> bytes);

/// The text without the white space at its ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// The text with control characters and bytes that are no UTF-8 replaced by '?'.
[[nodiscard]] std::string clean_text(std::string_view text);

/// The text without the byte order mark (UTF-8) that some programs begin it with.
[[nodiscard]] std::string_view without_mark(std::string_view text);

/// Whether the text is in UTF-16, by its mark or by the zeros that ASCII has in it.
[[nodiscard]] bool is_utf16(std::string_view text);

/// Why such a text is not read, and the way out; follows a name in a message.
inline constexpr std::string_view kUtf16Reason =
    "is in UTF-16, which is not read (save it as UTF-8)";

/// The path with the slashes that this system knows, whatever system wrote it.
[[nodiscard]] std::string portable_path(std::string_view path);

/// The last component of a path of any system.
[[nodiscard]] std::string_view last_component(std::string_view path);

/// The extension of a file's name in lower case, without the dot; "" when there is none.
[[nodiscard]] std::string extension_of(std::string_view path);

/// The name of a file without its folders and extension.
[[nodiscard]] std::string stem_of(std::string_view path);

/// The first line of a message of a foreign library, cleaned and cut to a readable length.
[[nodiscard]] std::string one_line(std::string_view message);

/// The beginning of a text that a user gave, for a message: at most 80 bytes, whole characters.
[[nodiscard]] std::string shortened(std::string_view text);

/// The note of Soup::notes about a file whose faces have colours.
inline constexpr std::string_view kNoFaceColors = "colours of faces are not read";

}  // namespace sightline::load
