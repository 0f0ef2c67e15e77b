// Data and display windows of EXR pictures: both ends belong to them.
#pragma once

#include <cstdint>

#include "sightline/composite.hpp"

namespace sightline {

using Window = Placement::Frame;

[[nodiscard]] std::int64_t width_of(const Window& window);
[[nodiscard]] std::int64_t height_of(const Window& window);
[[nodiscard]] bool same(const Window& a, const Window& b);
[[nodiscard]] bool contains(const Window& window, glm::ivec2 pixel);
/// The smallest one that holds both.
[[nodiscard]] Window around(const Window& a, const Window& b);

/// The pixels that a picture has.
[[nodiscard]] Window data_window(const ExrPicture& picture);
/// The whole that it is a part of.
[[nodiscard]] Window display_window(const ExrPicture& picture);

/// The picture with the pixels of a larger window; in new ones there is nothing: colour 0, depth
/// infinite, no ids, no samples. Precondition: `window` holds its data window.
[[nodiscard]] ExrPicture grown(ExrPicture picture, const Window& window);

}  // namespace sightline
