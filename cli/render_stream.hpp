// `sightline render --stream`: one model after the other, so that their sum need not fit in memory.
#pragma once

#include <vector>

#include "progress.hpp"
#include "render_frame.hpp"
#include "report.hpp"

namespace sightline::cli {

/// --stream, and what does not go with it. After all other options.
void read_stream(OptionReader& reader, RenderOptions& options);

/// Draws the picture; what --stats and --json tell of it.
[[nodiscard]] Result<std::vector<Row>> render_stream(const RenderOptions& options,
                                                     Progress& progress);

}  // namespace sightline::cli
