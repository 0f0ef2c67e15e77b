// What `draw` and `visible` have in common.
#pragma once

#include "options.hpp"
#include "progress.hpp"
#include "sightline/drawing.hpp"

namespace sightline::cli {

/// Drawings have no pixels in memory: only the sides of --resolution are limited.
inline constexpr std::uint64_t kAnyNumberOfPixels =
    std::uint64_t{kMaxSide} * std::uint64_t{kMaxSide};

extern const Option kMethodOption;  ///< --algorithm

[[nodiscard]] TraceMethod read_method(OptionReader& reader);

/// Loads models as they stand in the first frame, with triangles in place of quadrics.
[[nodiscard]] Result<Scene> load_for_drawing(const Models& models, bool quiet, Progress& progress);

/// Lets the work tell a terminal how far it is. `progress` must outlive it.
void show_progress(Progress& progress, TraceOptions& trace);

}  // namespace sightline::cli
