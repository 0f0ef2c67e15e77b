// Deep pictures joined by depth.
#pragma once

#include <span>

#include "sightline/image.hpp"

namespace sightline {

/// The samples of all pictures, tidy in each pixel. Precondition: one size, at least one picture.
[[nodiscard]] DeepImage join_deep(std::span<const DeepImage* const> pictures, int threads);

}  // namespace sightline
