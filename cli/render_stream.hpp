// `sightline render --stream`: one model after the other, so that their sum need not fit in memory.
#pragma once

#include <optional>
#include <vector>

#include "notes.hpp"
#include "progress.hpp"
#include "render_frame.hpp"
#include "report.hpp"

namespace sightline::cli {

/// --stream, and what does not go with it. After all other options.
void read_stream(OptionReader& reader, RenderOptions& options);

struct Streamed {
    std::vector<Row> rows;                    ///< what --stats and --json tell
    std::optional<CameraOptions> own_camera;  ///< of the first scene file that has one
};

/// Draws the picture, and says what a user should know of the parts and the view.
[[nodiscard]] Result<Streamed> render_stream(const RenderOptions& options, const Notes& notes,
                                             Progress& progress);

}  // namespace sightline::cli
