#include "notes.hpp"

#include <fmt/format.h>

#include "streams.hpp"

namespace sightline::cli {

void Notes::print(std::string_view kind, std::string_view text) const {
    if (quiet_) return;
    progress_.clear();
    tell_line("{}: {}", kind, text);
}

void Notes::warn_of_files(const Scene& scene) const {
    for (const std::string& line : scene.notes) warn(line);
}

void Notes::warn_of_options(const Arguments& arguments, std::span<const IdleOption> options) const {
    for (const IdleOption& option : options) {
        if (option.idle && arguments.has(option.name))
            warn(fmt::format("{} has no effect: {}", option.name, option.why));
    }
}

}  // namespace sightline::cli
