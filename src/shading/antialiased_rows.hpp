// Colours of the A-buffer: every fragment of a pixel is shaded once, and counts as much as can be
// seen of it.
//
// Source: L. Carpenter, "The A-buffer, an Antialiased Hidden Surface Method", 1984.
#pragma once

#include <cstdint>
#include <glm/vec4.hpp>
#include <memory>
#include <vector>

#include "image/deep_exr_writer.hpp"
#include "shading/color_rows.hpp"
#include "shading/sample_shader.hpp"
#include "sightline/fragments.hpp"
#include "sightline/shading.hpp"

namespace sightline {

class AntialiasedRows final : public ColorRows {
public:
    /// The screen must outlive it. `deep`: the rows also have samples for a deep picture.
    AntialiasedRows(const ScreenScene& screen, const ShadeOptions& options, bool deep,
                    std::unique_ptr<FragmentSource> fragments);

    [[nodiscard]] std::uint32_t unit() const override { return fragments_->band_rows(); }
    void resolve(std::uint32_t first, std::uint32_t count, const ResolveOptions& options) override;
    /// The colours of fragments, weighed with what is seen of them, over the background.
    [[nodiscard]] const glm::vec4* row(std::uint32_t y) const override {
        return pixels_.data() + std::size_t{y} * screen_.resolution().width;
    }
    void report() override { fragments_->report(); }

    /// Rows first .. first + count - 1 of those held, as samples: one for each surface of a pixel,
    /// tidy (ascending, not overlapping), without the background. Valid until the next call.
    [[nodiscard]] DeepRows deep_rows(std::uint32_t first, std::uint32_t count);

private:
    struct Band {
        std::vector<std::uint32_t> counts;  // of samples, pixel by pixel
        std::vector<DeepSample> samples;
    };

    const ScreenScene& screen_;
    SampleShader shader_;
    ShadeOptions options_;
    bool deep_;
    std::unique_ptr<FragmentSource> fragments_;
    std::vector<glm::vec4> pixels_;
    std::vector<Band> bands_;
    Band strip_;  // what deep_rows() hands out
};

}  // namespace sightline
