// From samples to pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec4.hpp>

namespace sightline {

/// The mean of the n x n samples of each pixel of a row, summed up row by row. `samples` points to
/// the first of the pixels' n rows of samples, which have n * width of them each.
inline void box_filter(const glm::vec4* samples, std::uint32_t n, std::uint32_t width,
                       glm::vec4* out) {
    const std::size_t columns = std::size_t{n} * width;
    for (std::uint32_t x = 0; x < width; ++x) {
        glm::vec4 sum{0, 0, 0, 0};
        for (std::uint32_t j = 0; j < n; ++j)
            for (std::uint32_t i = 0; i < n; ++i) sum += samples[j * columns + x * n + i];
        out[x] = sum / static_cast<float>(n * n);
    }
}

}  // namespace sightline
