// Errors of the command line: wrong use (exit status 2) and failed jobs (exit status 1).
#pragma once

#include <fmt/format.h>

#include <utility>

#include "sightline/error.hpp"

namespace sightline::cli {

template <class... Args>
[[nodiscard]] Error wrong_use(fmt::format_string<Args...> format, Args&&... args) {
    return {ErrorKind::bad_option, fmt::format(format, std::forward<Args>(args)...)};
}

template <class... Args>
[[nodiscard]] Error failure(fmt::format_string<Args...> format, Args&&... args) {
    return {ErrorKind::io, fmt::format(format, std::forward<Args>(args)...)};
}

}  // namespace sightline::cli
