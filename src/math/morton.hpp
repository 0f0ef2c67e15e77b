// Places of the page along a curve that keeps near ones together.
#pragma once

#include <cstdint>

namespace sightline {

/// Bits of the lower half, with a gap after each.
[[nodiscard]] constexpr std::uint64_t spread_bits(std::uint32_t value) {
    std::uint64_t v = value;
    v = (v | v << 16) & 0x0000ffff0000ffffULL;
    v = (v | v << 8) & 0x00ff00ff00ff00ffULL;
    v = (v | v << 4) & 0x0f0f0f0f0f0f0f0fULL;
    v = (v | v << 2) & 0x3333333333333333ULL;
    return (v | v << 1) & 0x5555555555555555ULL;
}

/// Of a point with coordinates within 2^24 of the origin: 50 bits (G. Morton, 1966).
[[nodiscard]] constexpr std::uint64_t morton_code(std::int32_t x, std::int32_t y) {
    constexpr std::int32_t kShift = 1 << 24;
    return spread_bits(static_cast<std::uint32_t>(x + kShift)) |
           spread_bits(static_cast<std::uint32_t>(y + kShift)) << 1;
}

}  // namespace sightline
