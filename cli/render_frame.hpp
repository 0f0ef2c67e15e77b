// What `sightline render` was asked for, and the pictures and maps that it makes of it.
#pragma once

#include <cstdint>
#include <glm/vec4.hpp>
#include <optional>
#include <vector>

#include "materials.hpp"
#include "options.hpp"
#include "outputs.hpp"
#include "sightline/sightline.hpp"

namespace sightline::cli {

struct Layers {
    bool normals = false, ids = false;  ///< of --aov
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
    std::optional<Output> color, depth, ids, normals, mask;

    /// Linear colours of the whole picture stand in memory only for formats that hold them.
    [[nodiscard]] bool needs_color_image() const {
        return color && color->format != ImageFormat::png;
    }
    /// Whether something is written that is resolved at the pixels' centres.
    [[nodiscard]] bool needs_centres() const {
        return depth || ids || normals || mask || (color && color->format == ImageFormat::exr);
    }
};

/// Everything between a scene and its files.
struct Frame {
    ScreenScene screen;
    Visibility samples, centre_store;
    ColorImage color;  ///< unless it is a PNG, which is shaded while it is written
    DepthImage depth;
    IdImage triangles, objects;
    NormalImage normals;
    MaskImage mask;
    std::vector<Counter> counters;

    /// Visibility at the pixels' centres; with one sample a pixel it is that of the picture.
    [[nodiscard]] const Visibility& centres() const {
        return samples.grid.per_axis == 1 && !samples.ids.empty() ? samples : centre_store;
    }
};

/// Whether normals are interpolated.
[[nodiscard]] bool is_smooth(Shading shading);

/// Decides what is seen at the samples that the outputs need.
[[nodiscard]] Status resolve_samples(const RenderOptions& options, Frame& frame);

/// Makes the pictures and maps that are written as they stand in memory.
void shade_frame(const RenderOptions& options, Shading shading, Frame& frame);

/// Writes all outputs, or none after an error.
[[nodiscard]] Status write_frame(const RenderOptions& options, Shading shading, const Frame& frame);

}  // namespace sightline::cli
