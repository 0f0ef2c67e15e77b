// Tells the format of a file by its first bytes, for messages only: nothing is ever read as another
// format than the one its name, or the user, tells.
#pragma once

#include <string>
#include <string_view>

namespace sightline::load {

/// The format (an extension) that a file of this size and beginning looks like; "" when it looks
/// like none.
[[nodiscard]] std::string sniff_format(std::string_view beginning, std::size_t size);

/// Whether sniff_format() knows files of this format.
[[nodiscard]] bool can_sniff(std::string_view format);

/// Whether a file that looks like the second format can't be of the first one.
[[nodiscard]] bool is_other_format(std::string_view format, std::string_view looks_like);

}  // namespace sightline::load
