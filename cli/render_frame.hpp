// What `sightline render` was asked for, and the pictures and maps that it makes of it.
#pragma once

#include <cstdint>
#include <glm/vec4.hpp>
#include <optional>
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

struct RenderOptions {
    CommonOptions common;
    Models models;
    CameraOptions camera;
    Resolution resolution;
    const Algorithm* algorithm = nullptr;
    Cull cull = Cull::automatic;
    std::uint32_t per_axis = 1;
    std::optional<Shading> shading;
    double crease_angle = 30;
    glm::u8vec4 background{255};
    std::vector<OpacityRule> opacity;
    Layers layers;
    std::vector<PictureOutput> outputs;
};

/// --resolution and --samples within the limits of the algorithm, which is known already.
void read_size(OptionReader& reader, RenderOptions& options);

/// What drawing took, in milliseconds, and what the algorithm counted.
struct Drawn {
    double resolve = 0, shade = 0, write = 0;
    std::vector<Counter> counters;
};

/// Writes all outputs, or none after an error.
[[nodiscard]] Result<Drawn> draw_outputs(const RenderOptions& options, Shading shading,
                                         const ScreenScene& screen, Progress& progress);

}  // namespace sightline::cli
