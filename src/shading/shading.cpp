// Deferred shading: colours of the visible samples, averaged over the pixels.
#include "sightline/shading.hpp"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <utility>

#include "shading/sample_shader.hpp"
#include "visibility/parallel.hpp"

namespace sightline {
namespace {

constexpr std::array<std::pair<std::string_view, Shading>, 7> kNames = {
    {{"flat", Shading::flat},
     {"gouraud", Shading::gouraud},
     {"phong", Shading::phong},
     {"unlit", Shading::unlit},
     {"depth", Shading::depth},
     {"normals", Shading::normals},
     {"ids", Shading::ids}}};

/// Shades the rows of one picture.
class RowShader {
public:
    RowShader(const ScreenScene& screen, const Visibility& visibility, const SampleShader& shader,
              glm::vec4 background)
        : visibility_(visibility),
          shader_(shader),
          background_(background),
          samples_(visibility.grid.per_axis),
          step_(visibility.grid.step(screen.subpixel_bits())),
          offset_(visibility.grid.offset(screen.subpixel_bits())) {}

    void shade(std::uint32_t y, FaceCache& cache, glm::vec4* out) const {
        const std::uint32_t width = visibility_.grid.resolution.width;
        if (samples_ == 1) {
            for (std::uint32_t x = 0; x < width; ++x) out[x] = sample(x, y, cache);
            return;
        }
        for (std::uint32_t x = 0; x < width; ++x) out[x] = mean(x, y, cache);
    }

private:
    /// Colour of the sample in a column and row of the grid.
    [[nodiscard]] glm::vec4 sample(std::uint32_t column, std::uint32_t row,
                                   FaceCache& cache) const {
        const std::uint32_t id =
            visibility_.ids[std::size_t{row} * visibility_.grid.columns() + column];
        if (id == kNone) return background_;
        return shader_.color(cache.face(id), static_cast<std::int32_t>(column) * step_ + offset_,
                             static_cast<std::int32_t>(row) * step_ + offset_);
    }

    /// Box filter. The order of summation is fixed: row by row within the pixel.
    [[nodiscard]] glm::vec4 mean(std::uint32_t x, std::uint32_t y, FaceCache& cache) const {
        glm::vec4 sum{0, 0, 0, 0};
        for (std::uint32_t j = 0; j < samples_; ++j) {
            for (std::uint32_t i = 0; i < samples_; ++i) {
                sum += sample(x * samples_ + i, y * samples_ + j, cache);
            }
        }
        return sum / static_cast<float>(samples_ * samples_);
    }

    const Visibility& visibility_;
    const SampleShader& shader_;
    glm::vec4 background_;
    std::uint32_t samples_;
    std::int32_t step_, offset_;
};

}  // namespace

std::optional<Shading> parse_shading(std::string_view name) {
    const auto* found = std::find_if(kNames.begin(), kNames.end(),
                                     [name](const auto& row) { return row.first == name; });
    if (found == kNames.end()) return std::nullopt;
    return found->second;
}

std::string_view name_of(Shading shading) {
    const auto* found = std::find_if(kNames.begin(), kNames.end(),
                                     [shading](const auto& row) { return row.second == shading; });
    return found == kNames.end() ? std::string_view{} : found->first;
}

ColorImage shade(const ScreenScene& screen, const Visibility& visibility,
                 const ShadeOptions& options) {
    const Resolution size = visibility.grid.resolution;
    ColorImage image(size.width, size.height);
    const SampleShader shader(screen, options.shading);
    const RowShader rows(screen, visibility, shader, options.background);
    tbb::enumerable_thread_specific<FaceCache> caches([&] { return FaceCache(shader); });
    // Blocks of rows are tall enough for the caches to serve a triangle more than once.
    constexpr std::uint32_t kGrain = 16;
    in_arena(options.threads, [&] {
        const tbb::blocked_range<std::uint32_t> all(0, size.height, kGrain);
        tbb::parallel_for(all, [&](const auto& range) {
            FaceCache& cache = caches.local();
            for (std::uint32_t y = range.begin(); y != range.end(); ++y) {
                rows.shade(y, cache, image.pixels.data() + std::size_t{y} * size.width);
            }
        });
    });
    return image;
}

}  // namespace sightline
