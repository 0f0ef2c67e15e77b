// The colours of whole rows of pixels.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec4.hpp>

#include "shading/sample_shader.hpp"
#include "sightline/shading.hpp"
#include "sightline/visibility.hpp"

namespace sightline {

/// Shades the rows of pixels that a visibility holds, counted from its first one; it may come to
/// hold others. Read-only once made, so any number of threads may use it, each with a cache of its
/// own. The scene and the visibility must outlive it.
class RowShader {
public:
    RowShader(const ScreenScene& screen, const Visibility& visibility, const ShadeOptions& options);

    [[nodiscard]] FaceCache make_cache() const { return FaceCache(shader_); }
    /// A row of pixels, averaged over their samples.
    void shade(std::uint32_t y, FaceCache& cache, glm::vec4* out) const;
    /// The same as 8-bit sRGB with straight alpha.
    void shade_rgba8(std::uint32_t y, FaceCache& cache, std::array<std::uint8_t, 4>* out) const;

private:
    template <class Out>
    void shade_as(std::uint32_t y, FaceCache& cache, Out* out) const;
    [[nodiscard]] std::int32_t height_of(std::uint32_t row) const;
    [[nodiscard]] glm::vec4 sample(std::uint32_t column, std::uint32_t row, FaceCache& cache) const;
    [[nodiscard]] glm::vec4 mean(std::uint32_t x, std::uint32_t y, FaceCache& cache) const;

    const Visibility& visibility_;
    SampleShader shader_;
    PixelColor background_;
    std::uint32_t samples_;
    std::int32_t step_, offset_;
};

}  // namespace sightline
