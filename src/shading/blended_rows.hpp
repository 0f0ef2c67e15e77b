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

#include "shading/color_rows.hpp"
#include "shading/sample_shader.hpp"
#include "sightline/shading.hpp"
#include "visibility/over.hpp"

namespace sightline {

class BlendedRows final : public ColorRows {
public:
    /// The screen must outlive it.
    BlendedRows(const ScreenScene& screen, const SampleGrid& grid, const ShadeOptions& options,
                std::unique_ptr<LayerSource> layers);

    [[nodiscard]] std::uint32_t unit() const override {
        return layers_->band_rows() / grid_.per_axis;
    }
    void resolve(std::uint32_t first, std::uint32_t count, const ResolveOptions& options) override;
    /// Averaged over the samples of each pixel.
    [[nodiscard]] const glm::vec4* row(std::uint32_t y) const override {
        return pixels_.data() + std::size_t{y} * grid_.resolution.width;
    }
    void report() override { layers_->report(); }

private:
    void resolve_band(std::uint32_t band, glm::vec4* out);

    const ScreenScene& screen_;
    SampleGrid grid_;
    SampleUnits units_;
    SampleShader shader_;
    std::vector<std::uint8_t> translucent_;
    glm::vec4 background_;
    std::unique_ptr<LayerSource> layers_;
    std::vector<glm::vec4> pixels_;
};

}  // namespace sightline
