// What `sightline render` was asked for, and the pictures and maps that it makes of it.
#pragma once

#include <cstdint>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "materials.hpp"
#include "options.hpp"
#include "outputs.hpp"
#include "progress.hpp"
#include "sightline/sightline.hpp"

namespace sightline::cli {

struct Layers {
    bool normals = false, ids = false;  ///< of --aov
};

/// An output and what goes into it.
struct PictureOutput {
    PictureContent content;
    Output output;
};

struct Orbit {
    glm::dvec3 axis{0, 1, 0};
    double start = 0, end = 360;  ///< degrees
};

/// Of --frames: numbers from 0, while those of files and messages begin with 1.
struct FrameOptions {
    std::uint32_t count = 0;           ///< 0: one picture, which has no number
    std::uint32_t first = 0, end = 1;  ///< those that are drawn
    std::optional<Orbit> orbit;
    std::vector<CameraOptions> path;  ///< at least `count`, or none
};

/// Of --bsp-load and --bsp-save; empty: not given.
struct TreeFiles {
    std::string load, save;
};

struct RenderOptions {
    CommonOptions common;
    Models models;
    CameraOptions camera;
    Resolution resolution;
    const Algorithm* algorithm = nullptr;
    Cull cull = Cull::automatic;
    std::uint32_t per_axis = 1;
    bool by_area = false;  ///< instead of samples
    bool deep = false;
    std::optional<Shading> shading;
    double crease_angle = 30;
    glm::u8vec4 background{255};
    std::vector<OpacityRule> opacity;
    std::vector<std::string> holdouts;
    bool stream = false;
    Layers layers;
    std::vector<PictureOutput> outputs;
    FrameOptions frames;
    TreeFiles tree;
};

/// --resolution and --samples within the limits of the algorithm, which is known already.
void read_size(OptionReader& reader, RenderOptions& options);

/// Whether a file had normals for an object.
[[nodiscard]] bool has_file_normals(const Scene& scene);
/// The one asked for; else normals of files are interpolated, and faces without any are flat.
[[nodiscard]] Shading shading_for(const RenderOptions& options, bool file_normals);

/// What drawing took, in milliseconds, and what the algorithm counted.
struct Drawn {
    double resolve = 0, shade = 0, write = 0;
    std::vector<Counter> counters;
    bool anything_seen = false;
};

/// What to draw.
struct View {
    const ScreenScene& screen;
    Shading shading = Shading::flat;
    const BspTree* tree = nullptr;  ///< for the algorithm that has one
};

/// The files of a run, under the names that they have until all are complete.
[[nodiscard]] std::vector<PictureFile> files_of(const RenderOptions& options,
                                                const OutputBatch& batch,
                                                std::span<const PictureOutput> pictures);

/// Linear light, premultiplied.
[[nodiscard]] glm::vec4 linear_color(glm::u8vec4 srgb);

/// Writes the pictures, all of them or none after an error.
[[nodiscard]] Result<Drawn> draw_outputs(const RenderOptions& options, const View& view,
                                         std::span<const PictureOutput> pictures,
                                         Progress& progress);

}  // namespace sightline::cli
