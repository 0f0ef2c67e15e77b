// draw() with groups of rows of a given height.
#pragma once

#include <cstdint>
#include <span>

#include "sightline/shading.hpp"

namespace sightline {

/// See draw(). `group_rows`: at least so many rows of pixels at a time, 0 = as many as keep all
/// cores busy in little memory. No byte depends on it.
[[nodiscard]] Status draw_in_groups(const ScreenScene& screen, const Algorithm& algorithm,
                                    const DrawOptions& options, std::span<const PictureFile> files,
                                    std::uint32_t group_rows);

}  // namespace sightline
