// The rows of everything that a picture can show.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/vec4.hpp>

#include "image/png_rows.hpp"
#include "math/arena.hpp"
#include "shading/color_rows.hpp"
#include "shading/row_maps.hpp"
#include "shading/row_shader.hpp"
#include "sightline/shading.hpp"

namespace sightline {

/// Colours and maps of the rows of pixels that two visibilities hold at the moment, counted from
/// the first one. Any number of threads may ask. The visibilities must outlive it; their grids must
/// be set before it is made.
class PictureRows {
public:
    /// `samples` is that of the colours unless they come from `colors`; `centres` has one sample
    /// a pixel.
    PictureRows(const ScreenScene& screen, const Visibility& samples, const Visibility& centres,
                const ShadeOptions& options, const ColorRows* colors = nullptr)
        : shader_(screen, samples, options),
          maps_(screen, centres, is_smooth(options.shading)),
          caches_([this] { return shader_.make_cache(); }),
          colors_(colors),
          width_(samples.grid.resolution.width) {}

    void color(std::uint32_t y, glm::vec4* out) {
        if (colors_ != nullptr)
            std::copy_n(colors_->row(y), width_, out);
        else
            shader_.shade(y, caches_.local(), out);
    }
    void rgba8(std::uint32_t y, std::array<std::uint8_t, 4>* out) {
        if (colors_ == nullptr) {
            shader_.shade_rgba8(y, caches_.local(), out);
            return;
        }
        const glm::vec4* row = colors_->row(y);
        for (std::uint32_t x = 0; x < width_; ++x)  // neighbours are often equal
            out[x] = x > 0 && row[x] == row[x - 1] ? out[x - 1] : color_to_rgba8(row[x]);
    }
    [[nodiscard]] const RowMaps& maps() const { return maps_; }

private:
    RowShader shader_;
    RowMaps maps_;
    tbb::enumerable_thread_specific<FaceCache> caches_;
    const ColorRows* colors_;
    std::uint32_t width_;
};

/// make(y) for rows first .. first + count - 1, in parallel.
template <class Make>
void for_rows(std::uint32_t first, std::uint32_t count, int threads, const Make& make) {
    // Blocks of rows are tall enough for the caches of triangles to serve more than once.
    constexpr std::uint32_t kGrain = 4;
    in_arena(threads, [&] {
        const tbb::blocked_range<std::uint32_t> all(first, first + count, kGrain);
        tbb::parallel_for(all, [&](const auto& range) {
            for (std::uint32_t y = range.begin(); y != range.end(); ++y) make(y);
        });
    });
}

}  // namespace sightline
