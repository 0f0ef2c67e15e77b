// The samples of a picture in the units of the screen.
#pragma once

#include <bit>
#include <cstdint>

#include "sightline/visibility.hpp"

namespace sightline {

/// Sample (i, j) stands at (position(i), position(j)); steps are powers of two.
struct SampleUnits {
    std::int32_t columns = 0, rows = 0;
    std::int32_t offset = 0;
    int step_bits = 0;  ///< step = 2^step_bits

    SampleUnits() = default;
    SampleUnits(const SampleGrid& grid, int subpixel_bits)
        : columns(static_cast<std::int32_t>(grid.columns())),
          rows(static_cast<std::int32_t>(grid.rows())),
          offset(grid.offset(subpixel_bits)),
          step_bits(std::countr_zero(static_cast<std::uint32_t>(grid.step(subpixel_bits)))) {}

    [[nodiscard]] std::int32_t step() const { return std::int32_t{1} << step_bits; }
    [[nodiscard]] std::int32_t position(std::int32_t index) const {
        return offset + (index << step_bits);
    }
    /// First sample at or after, and last at or before, a coordinate of the screen.
    [[nodiscard]] std::int32_t first_from(std::int32_t x) const {
        return (x - offset + (1 << step_bits) - 1) >> step_bits;
    }
    [[nodiscard]] std::int32_t last_until(std::int32_t x) const {
        return (x - offset) >> step_bits;
    }
};

}  // namespace sightline
