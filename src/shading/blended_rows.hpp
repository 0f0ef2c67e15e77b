// Colours of translucent surfaces: what covers a sample is laid over one another from back to
// front.
//
// Source: T. Porter, T. Duff, "Compositing Digital Images", 1984, "over" with premultiplied colours
// in linear light; the order comes from an algorithm that has one (M. Newell, R. Newell, T. Sancha,
// 1972).
#pragma once

#include <cstdint>
#include <glm/vec4.hpp>
#include <memory>
#include <vector>

#include "shading/sample_shader.hpp"
#include "sightline/shading.hpp"
#include "visibility/over.hpp"

namespace sightline {

/// Colours of rows of pixels, made in groups of whole bands.
class BlendedRows {
public:
    /// The screen must outlive it.
    BlendedRows(const ScreenScene& screen, const SampleGrid& grid, const ShadeOptions& options,
                std::unique_ptr<LayerSource> layers);

    /// Rows of pixels of which resolve() takes a multiple.
    [[nodiscard]] std::uint32_t unit() const { return layers_->band_rows() / grid_.per_axis; }

    /// Holds rows of pixels from now on, on all cores. Precondition: `first` is a multiple of
    /// unit(), and so is `count` unless the rows are the last ones.
    void resolve(std::uint32_t first, std::uint32_t count, const ResolveOptions& options);

    /// Row y of those held: linear, premultiplied, averaged over the samples of each pixel.
    [[nodiscard]] const glm::vec4* row(std::uint32_t y) const {
        return pixels_.data() + std::size_t{y} * grid_.resolution.width;
    }

    [[nodiscard]] LayerSource& layers() { return *layers_; }

private:
    void resolve_band(std::uint32_t band, glm::vec4* out);

    const ScreenScene& screen_;
    SampleGrid grid_;
    SampleUnits units_;
    SampleShader shader_;
    glm::vec4 background_;
    std::unique_ptr<LayerSource> layers_;
    std::vector<glm::vec4> pixels_;
};

}  // namespace sightline
