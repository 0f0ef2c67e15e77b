// Text from foreign files, made fit for messages and outputs.
#pragma once

#include <string>
#include <string_view>

namespace sightline::load {

/// The text with control characters and bytes that are no UTF-8 replaced by '?'.
[[nodiscard]] std::string clean_text(std::string_view text);

/// The extension of a file's name in lower case, without the dot; "" when there is none.
[[nodiscard]] std::string extension_of(std::string_view path);

/// The name of a file without its folders and extension.
[[nodiscard]] std::string stem_of(std::string_view path);

/// The first line of a message of a foreign library, cleaned and cut to a readable length.
[[nodiscard]] std::string one_line(std::string_view message);

}  // namespace sightline::load
