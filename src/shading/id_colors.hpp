// Colours that tell triangles apart.
#pragma once

#include <array>
#include <cstdint>

namespace sightline {

/// sRGB bytes of the colour of an id: different for any two ids below 2^24, and of ids that follow
/// each other at least 97 of 255 apart in red.
[[nodiscard]] std::array<std::uint8_t, 3> id_color(std::uint32_t id);

}  // namespace sightline
