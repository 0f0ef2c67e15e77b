// What a file is by its first bytes, for messages only: nothing is ever read as another format than
// the one its name, or the user, tells.
#pragma once

#include <string>
#include <string_view>

namespace sightline::load {

/// The format (an extension) that the beginning of a file looks like; "" when it looks like none.
[[nodiscard]] std::string sniff_format(std::string_view bytes);

/// What to add to the message about a file that can't be read as `format`: "; it looks like stl
/// (name it so, or give --format stl)", or nothing.
[[nodiscard]] std::string hint_of_format(std::string_view bytes, std::string_view format);

}  // namespace sightline::load
