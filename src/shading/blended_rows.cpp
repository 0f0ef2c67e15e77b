#include "shading/blended_rows.hpp"

#include <algorithm>
#include <utility>

#include "shading/box_filter.hpp"
#include "shading/surface.hpp"
#include "visibility/parallel.hpp"

namespace sightline {

namespace {

/// The colours of the samples of a band while surfaces are laid over them.
class BlendSink final : public RunSink {
public:
    BlendSink(const ScreenScene& screen, const SampleUnits& units, const SampleShader& shader,
              const std::vector<std::uint8_t>& translucent, glm::vec4 background,
              std::int32_t first_row, std::int32_t rows)
        : scene_(screen.scene()),
          translucent_(translucent),
          units_(units),
          shader_(shader),
          cache_(shader),
          over_(screen, units, Ties::lower_id_wins),
          first_row_(first_row),
          owners_(width() * static_cast<std::size_t>(rows), kNone),
          colors_(owners_.size(), background) {}

    void take(const Run& run) override {
        const std::size_t start = static_cast<std::size_t>(run.row - first_row_) * width();
        std::uint32_t* owners = owners_.data() + start;
        glm::vec4* colors = colors_.data() + start;
        const bool translucent = !translucent_.empty() && translucent_[run.id] != 0;
        over_.paint(run, owners, [&](std::int32_t first, std::int32_t end) {
            anything_seen_ = true;
            // Nobody is hidden by a translucent owner, so it need not be remembered.
            std::fill(owners + first, owners + end, translucent ? kNone : run.id);
            if (const PixelColor* constant = cache_.constant_color(run.id)) {
                const float opacity = material_of(scene_, run.id).opacity;
                for (std::int32_t i = first; i < end; ++i)
                    blend(colors[i], constant->linear, opacity);
                return;
            }
            const ShadedFace& face = cache_.face(run.id);
            const std::int32_t y = units_.position(run.row);
            for (std::int32_t i = first; i < end; ++i) {
                const std::int32_t x = units_.position(i);
                blend(colors[i], shader_.varying_color(face, x, y), shader_.opacity(face, x, y));
            }
        });
    }

    [[nodiscard]] const std::vector<glm::vec4>& colors() const { return colors_; }
    [[nodiscard]] bool anything_seen() const { return anything_seen_; }

private:
    [[nodiscard]] std::size_t width() const { return static_cast<std::size_t>(units_.columns); }

    /// Porter and Duff's "over"; the colours of surfaces come with alpha 1.
    static void blend(glm::vec4& under, glm::vec4 color, float opacity) {
        under = opacity * color + (1 - opacity) * under;
    }

    const Scene& scene_;
    const std::vector<std::uint8_t>& translucent_;  // see translucent_triangles()
    SampleUnits units_;
    const SampleShader& shader_;
    FaceCache cache_;
    Over over_;
    std::int32_t first_row_;
    std::vector<std::uint32_t> owners_;  // the opaque surface that is seen, if one is
    std::vector<glm::vec4> colors_;
    bool anything_seen_ = false;
};

}  // namespace

BlendedRows::BlendedRows(const ScreenScene& screen, const SampleGrid& grid,
                         const ShadeOptions& options, std::unique_ptr<LayerSource> layers)
    : screen_(screen),
      grid_(grid),
      units_(grid, screen.subpixel_bits()),
      shader_(screen, options.shading),
      translucent_(translucent_triangles(screen.scene())),
      background_(options.background),
      layers_(std::move(layers)) {}

void BlendedRows::resolve(std::uint32_t first, std::uint32_t count, const ResolveOptions& options) {
    pixels_.resize(std::size_t{count} * grid_.resolution.width);
    const std::size_t band = std::size_t{unit()} * grid_.resolution.width;
    for_each_index((count + unit() - 1) / unit(), options, [&](std::uint32_t b) {
        resolve_band(first / unit() + b, pixels_.data() + b * band);
    });
}

void BlendedRows::resolve_band(std::uint32_t band, glm::vec4* out) {
    const auto height = static_cast<std::int32_t>(layers_->band_rows());
    const std::int32_t first = static_cast<std::int32_t>(band) * height;
    const std::int32_t rows = std::min(units_.rows - first, height);
    BlendSink sink(screen_, units_, shader_, translucent_, background_, first, rows);
    layers_->visit_band(band, sink);
    if (sink.anything_seen()) anything_seen_ = true;
    const std::uint32_t n = grid_.per_axis, width = grid_.resolution.width;
    const std::size_t columns = grid_.columns();
    const glm::vec4* samples = sink.colors().data();
    for (std::uint32_t y = 0; y < static_cast<std::uint32_t>(rows) / n; ++y)
        box_filter(samples + y * n * columns, n, width, out + std::size_t{y} * width);
}

}  // namespace sightline
