// The frames of `sightline render`: one picture, or a row of them from a moving camera or of moving
// objects.
#pragma once

#include <span>
#include <string>

#include "outputs.hpp"
#include "progress.hpp"
#include "render_frame.hpp"
#include "view_notes.hpp"

namespace sightline::cli {

/// --frames, --frame, --orbit, --path. The camera and the models must have been read.
void read_frames(OptionReader& reader, RenderOptions& options);
/// --bsp-load and --bsp-save. The algorithm must have been read.
void read_tree_files(OptionReader& reader, RenderOptions& options);

/// A path in which the run of '#' in the file's name has become a number, padded with zeros.
[[nodiscard]] std::string numbered(const std::string& path, std::uint32_t number);

/// The names of the outputs: a run of '#' in each where there are frames, none elsewhere; and all
/// files of all frames as check_outputs() does.
void check_frame_outputs(OptionReader& reader, RenderOptions& options,
                         std::span<const Output> outputs);

/// What the frames took and found, in sum: times in milliseconds.
struct Rendered {
    double tree = 0, pose = 0, project = 0;
    ProjectCounts counts;           ///< `triangles` and `degenerate` are those of the last frame
    std::uint64_t back_facing = 0;  ///< only with --stats or --json
    std::uint64_t candidates = 0;   ///< triangles that could have been culled
    Drawn drawn;
    ViewNotes views;
};

/// Draws all frames into their files. Frames that are finished stay after an error, which names the
/// frame.
[[nodiscard]] Result<Rendered> render_frames(const RenderOptions& options, Shading shading,
                                             const Scene& scene, Progress& progress);

}  // namespace sightline::cli
