// The standard streams: what is told on standard error, and streams that are closed.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

namespace sightline::cli {

/// Takes the places of standard streams that are closed, so that no file gets the number of one:
/// reading from them and writing to them fails as before. Call first of all.
void occupy_closed_streams();

/// Writes to standard error as it is. That this fails (closed, full, nobody reads) fails nothing.
void tell(std::string_view text);

/// One line, "sightline: ...", fit for a terminal whatever is in it.
void tell_line(std::string_view text);

template <class... Args>
void tell_line(fmt::format_string<Args...> format, Args&&... args) {
    tell_line(std::string_view(fmt::format(format, std::forward<Args>(args)...)));
}

}  // namespace sightline::cli
