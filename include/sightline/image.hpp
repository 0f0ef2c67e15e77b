// Pictures in memory and on disk.
//
// Rows run from the top. Every writer writes to a temporary name beside the target and renames it
// when the file is complete, so a failure never leaves a partial file and never harms one that
// stood there. The path "-" is standard output.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/error.hpp"

namespace sightline {

/// A dense picture of T, row by row from the top.
template <class T>
struct Image {
    std::uint32_t width = 0, height = 0;
    std::vector<T> pixels;

    Image() = default;
    Image(std::uint32_t w, std::uint32_t h, T fill = T{})
        : width(w), height(h), pixels(std::size_t{w} * h, fill) {}
    [[nodiscard]] T& at(std::uint32_t x, std::uint32_t y) {
        return pixels[std::size_t{y} * width + x];
    }
    [[nodiscard]] const T& at(std::uint32_t x, std::uint32_t y) const {
        return pixels[std::size_t{y} * width + x];
    }
    [[nodiscard]] std::span<const T> row(std::uint32_t y) const {
        return {pixels.data() + std::size_t{y} * width, width};
    }
};

using ColorImage = Image<glm::vec4>;    ///< linear light, premultiplied alpha
using DepthImage = Image<float>;        ///< metric; infinity = nothing seen
using IdImage = Image<std::uint32_t>;   ///< kNone = nothing seen
using NormalImage = Image<glm::vec3>;   ///< unit, world space; 0 = nothing seen
using MaskImage = Image<std::uint8_t>;  ///< 0 or 1... 255 as the format wants

enum class ImageFormat { png, exr, npy };

/// By the extension of a path (case-insensitive), or nothing.
[[nodiscard]] std::optional<ImageFormat> image_format_of(std::string_view path);
[[nodiscard]] std::optional<ImageFormat> parse_image_format(std::string_view name);

/// Linear light <-> sRGB, component 0..1. Built on + - * / and tables only, so every machine gives
/// the same bytes. to_srgb8 rounds to the nearest of 0..255 and clamps.
[[nodiscard]] std::uint8_t to_srgb8(float linear);
[[nodiscard]] float from_srgb8(std::uint8_t srgb);

/// 8-bit sRGB RGBA with straight alpha.
[[nodiscard]] Status write_color_png(const std::string& path, const ColorImage& image);
/// 16-bit grey; near..far map to 0..65535 and the background to 65535.
[[nodiscard]] Status write_depth_png(const std::string& path, const DepthImage& depth, double near,
                                     double far);
/// 8-bit RGB: (n + 1) / 2 a component, background 0.
[[nodiscard]] Status write_normals_png(const std::string& path, const NormalImage& normals);
/// 8-bit RGBA little-endian bytes of the id (R lowest): lossless.
[[nodiscard]] Status write_ids_png(const std::string& path, const IdImage& ids);
/// 8-bit grey: 255 where something is seen.
[[nodiscard]] Status write_mask_png(const std::string& path, const MaskImage& mask);

/// Where a picture stands in the coordinates of an EXR file; x to the right, y down.
struct Placement {
    struct Frame {
        glm::ivec2 first, last;
    };
    glm::ivec2 origin{0, 0};     ///< of the left pixel of the top row
    std::optional<Frame> frame;  ///< corners of the whole that it is a part of; nothing: itself
};

/// What goes into an EXR file. Absent pointers leave their channels out; all must have one size.
struct ExrLayers {
    const ColorImage* color = nullptr;     ///< R G B A, half
    const DepthImage* depth = nullptr;     ///< Z, float
    const NormalImage* normals = nullptr;  ///< N.X N.Y N.Z, float
    const IdImage* objects = nullptr;      ///< "object", uint
    const IdImage* triangles = nullptr;    ///< "triangle", uint
    Placement placement = {};
};
[[nodiscard]] Status write_exr(const std::string& path, const ExrLayers& layers);

/// One of the surfaces or volumes that a pixel of a deep picture has. From z to z_back, where it is
/// as deep as z_back > z says, it absorbs evenly; else it is a surface at z.
struct DeepSample {
    float z = 0, z_back = 0;                     ///< metric, along the gaze
    glm::vec4 color{0, 0, 0, 0};                 ///< linear light, premultiplied alpha
    std::uint32_t object = ~0u, triangle = ~0u;  ///< kNone = not known

    bool operator==(const DeepSample&) const = default;
};

/// A picture with any number of samples in each pixel, row by row from the top.
struct DeepImage {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint64_t> first;  ///< width * height + 1: where each pixel's samples begin
    std::vector<DeepSample> samples;
    Placement placement = {};

    /// The samples of the pixel number `pixel`.
    [[nodiscard]] std::span<const DeepSample> pixel(std::size_t pixel) const {
        return {samples.data() + first[pixel], samples.data() + first[pixel + 1]};
    }
};

/// A deep scan-line EXR: Z, ZBack, R, G, B and A as float, "object" and "triangle" as uint. The
/// bytes depend on the pixels only.
[[nodiscard]] Status write_deep_exr(const std::string& path, const DeepImage& image);

/// NumPy .npy, version 1.0, C order, little-endian.
[[nodiscard]] Status write_npy(const std::string& path, const DepthImage& depth);     // <f4
[[nodiscard]] Status write_npy(const std::string& path, const IdImage& ids);          // <u4
[[nodiscard]] Status write_npy(const std::string& path, const NormalImage& normals);  // <f4 (h,w,3)
[[nodiscard]] Status write_npy(const std::string& path, const MaskImage& mask);       // |u1
[[nodiscard]] Status write_npy(const std::string& path, const ColorImage& color);     // <f4 (h,w,4)

}  // namespace sightline
