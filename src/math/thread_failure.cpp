#include "math/thread_failure.hpp"

#include <string_view>
#include <system_error>

namespace sightline {

std::optional<std::string> thread_failure(const std::exception& exception) {
    // The standard library throws the error number; TBB throws a text with the function's name.
    const auto* const error = dynamic_cast<const std::system_error*>(&exception);
    const bool by_number =
        error != nullptr && error->code() == std::errc::resource_unavailable_try_again;
    const bool by_name =
        std::string_view(exception.what()).find("pthread_create") != std::string_view::npos;
    if (!by_number && !by_name) return std::nullopt;
    return "the system starts no more threads; allow more of them (ulimit -u) or ask for fewer "
           "(--threads 1)";
}

}  // namespace sightline
