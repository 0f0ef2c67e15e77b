// One row of a picture as the bytes of a PNG row. Each `out` has room for the row; what the bytes
// mean is said at the write_*_png functions of sightline/image.hpp.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>

namespace sightline {

[[nodiscard]] std::array<std::uint8_t, 4> color_to_rgba8(glm::vec4 color);
void color_row_to_rgba8(std::span<const glm::vec4> row, std::uint8_t* out);
void depth_row_to_grey16(std::span<const float> row, double near, double far, std::uint8_t* out);
void normals_row_to_rgb8(std::span<const glm::vec3> row, std::uint8_t* out);
void ids_row_to_rgba8(std::span<const std::uint32_t> row, std::uint8_t* out);
void mask_row_to_grey8(std::span<const std::uint8_t> row, std::uint8_t* out);

}  // namespace sightline
