// Rows of colours, run by run: neighbours on a row mostly see the same triangle.
#include "shading/row_shader.hpp"

#include <algorithm>
#include <array>
#include <type_traits>

#include "image/png_rows.hpp"

namespace sightline {
namespace {

using Rgba8 = std::array<std::uint8_t, 4>;

template <class Out>
Out color_as(const PixelColor& color) {
    if constexpr (std::is_same_v<Out, Rgba8>) {
        return color.rgba8;
    } else {
        return color.linear;
    }
}

template <class Out>
Out color_as(glm::vec4 linear) {
    if constexpr (std::is_same_v<Out, Rgba8>) {
        return color_to_rgba8(linear);
    } else {
        return linear;
    }
}

}  // namespace

RowShader::RowShader(const ScreenScene& screen, const Visibility& visibility,
                     const ShadeOptions& options)
    : visibility_(visibility),
      shader_(screen, options.shading),
      background_(options.background),
      samples_(visibility.grid.per_axis),
      step_(visibility.grid.step(screen.subpixel_bits())),
      offset_(visibility.grid.offset(screen.subpixel_bits())) {}

void RowShader::shade(std::uint32_t y, FaceCache& cache, glm::vec4* out) const {
    shade_as(y, cache, out);
}

void RowShader::shade_rgba8(std::uint32_t y, FaceCache& cache, Rgba8* out) const {
    shade_as(y, cache, out);
}

/// Where a row of samples stands, in units of the screen; rows count from the first one held.
std::int32_t RowShader::height_of(std::uint32_t row) const {
    return static_cast<std::int32_t>(visibility_.first_row + row) * step_ + offset_;
}

template <class Out>
void RowShader::shade_as(std::uint32_t y, FaceCache& cache, Out* out) const {
    const std::uint32_t width = visibility_.grid.resolution.width;
    if (samples_ > 1) {
        for (std::uint32_t x = 0; x < width; ++x) out[x] = color_as<Out>(mean(x, y, cache));
        return;
    }
    const std::uint32_t* ids = visibility_.ids.data() + std::size_t{y} * width;
    const std::int32_t height = height_of(y);
    for (std::uint32_t x = 0; x < width;) {
        const std::uint32_t id = ids[x], first = x;
        while (x < width && ids[x] == id) ++x;
        const PixelColor* constant = id == kNone ? &background_ : cache.constant_color(id);
        if (constant != nullptr) {
            std::fill(out + first, out + x, color_as<Out>(*constant));
            continue;
        }
        const ShadedFace& face = cache.face(id);
        for (std::uint32_t i = first; i < x; ++i) {
            out[i] = color_as<Out>(shader_.varying_color(
                face, static_cast<std::int32_t>(i) * step_ + offset_, height));
        }
    }
}

/// Colour of the sample in a column and row of the grid.
glm::vec4 RowShader::sample(std::uint32_t column, std::uint32_t row, FaceCache& cache) const {
    const std::uint32_t id =
        visibility_.ids[std::size_t{row} * visibility_.grid.columns() + column];
    if (id == kNone) return background_.linear;
    if (const PixelColor* constant = cache.constant_color(id)) return constant->linear;
    return shader_.varying_color(
        cache.face(id), static_cast<std::int32_t>(column) * step_ + offset_, height_of(row));
}

/// Box filter. The order of summation is fixed: row by row within the pixel.
glm::vec4 RowShader::mean(std::uint32_t x, std::uint32_t y, FaceCache& cache) const {
    glm::vec4 sum{0, 0, 0, 0};
    for (std::uint32_t j = 0; j < samples_; ++j) {
        for (std::uint32_t i = 0; i < samples_; ++i) {
            sum += sample(x * samples_ + i, y * samples_ + j, cache);
        }
    }
    return sum / static_cast<float>(samples_ * samples_);
}

}  // namespace sightline
