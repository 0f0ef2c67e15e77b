// A line of progress: carriage return and "erase to the end of the line" (ECMA-48) rewrite it.
#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>

#include "streams.hpp"

namespace sightline::cli {
namespace {

constexpr std::string_view kEraseLine = "\r\x1b[K";
std::atomic<bool> line_is_dirty{false};

}  // namespace

Progress::Progress(bool quiet) : shown_(!quiet && isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() { clear(); }

void Progress::stage(std::string_view what) {
    if (!shown_) return;
    line_is_dirty = true;
    tell(fmt::format("{}sightline: {}{} ...", kEraseLine, frame_, what));
}

void Progress::stage(std::string_view what, unsigned done, unsigned all) {
    if (shown_) stage(fmt::format("{} {}/{}", what, done, all));
}

void Progress::frame(unsigned number, unsigned all) {
    if (shown_) frame_ = fmt::format("frame {} of {}: ", number, all);
}

void Progress::clear() {
    if (!shown_ || !line_is_dirty.exchange(false)) return;
    tell(kEraseLine);
}

void clear_progress_from_signal_handler() {
    if (!line_is_dirty.load()) return;
    const auto written = write(STDERR_FILENO, kEraseLine.data(), kEraseLine.size());
    static_cast<void>(written);  // nothing more can be done
}

}  // namespace sightline::cli
