// Telling that the system starts no more threads.
#pragma once

#include <exception>
#include <optional>
#include <string>

namespace sightline {

/// A message with the way out, if the exception says that a thread could not be started.
[[nodiscard]] std::optional<std::string> thread_failure(const std::exception& exception);

}  // namespace sightline
