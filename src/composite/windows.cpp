#include "composite/windows.hpp"

#include <algorithm>
#include <glm/common.hpp>
#include <limits>
#include <utility>

#include "sightline/scene.hpp"

namespace sightline {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

Window window_of(const Placement& placement, std::uint32_t width, std::uint32_t height) {
    const glm::ivec2 size(static_cast<int>(width), static_cast<int>(height));
    return {placement.origin, placement.origin + size - 1};
}

const Placement& placement_of(const ExrPicture& picture) {
    return std::visit([](const auto& p) -> const Placement& { return p.placement; }, picture);
}

/// Where the old pixels stand in the new window.
struct Place {
    std::size_t width, height;  // of the new window
    std::size_t left, top;
};

Place place_of(const Window& old, const Window& window) {
    return {static_cast<std::size_t>(width_of(window)), static_cast<std::size_t>(height_of(window)),
            static_cast<std::size_t>(std::int64_t{old.first.x} - window.first.x),
            static_cast<std::size_t>(std::int64_t{old.first.y} - window.first.y)};
}

template <class T>
void grow(Image<T>& image, const Place& place, T nothing) {
    Image<T> larger(static_cast<std::uint32_t>(place.width),
                    static_cast<std::uint32_t>(place.height), nothing);
    for (std::uint32_t y = 0; y < image.height; ++y) {
        std::ranges::copy(image.row(y),
                          larger.pixels.begin() + static_cast<std::ptrdiff_t>(
                                                      (place.top + y) * place.width + place.left));
    }
    image = std::move(larger);
}

void grow(FlatPicture& picture, const Place& place) {
    grow(picture.color, place, glm::vec4(0));
    grow(picture.depth, place, kInfinity);
    if (picture.normals) grow(*picture.normals, place, glm::vec3(0));
    if (picture.objects) grow(*picture.objects, place, kNone);
    if (picture.triangles) grow(*picture.triangles, place, kNone);
}

/// The samples stay where they are.
void grow(DeepImage& image, const Place& place) {
    std::vector<std::uint64_t> first;
    first.reserve(place.width * place.height + 1);
    first.assign(place.top * place.width, 0);
    for (std::size_t y = 0; y < image.height; ++y) {
        const auto row = image.first.begin() + static_cast<std::ptrdiff_t>(y * image.width);
        first.insert(first.end(), place.left, *row);
        first.insert(first.end(), row, row + image.width);
        first.resize((place.top + y + 1) * place.width, row[image.width]);
    }
    first.resize(place.width * place.height + 1, image.samples.size());
    image.first = std::move(first);
    image.width = static_cast<std::uint32_t>(place.width);
    image.height = static_cast<std::uint32_t>(place.height);
}

}  // namespace

std::int64_t width_of(const Window& window) {
    return std::int64_t{window.last.x} - window.first.x + 1;
}

std::int64_t height_of(const Window& window) {
    return std::int64_t{window.last.y} - window.first.y + 1;
}

bool same(const Window& a, const Window& b) { return a.first == b.first && a.last == b.last; }

bool contains(const Window& window, glm::ivec2 pixel) {
    return window.first.x <= pixel.x && pixel.x <= window.last.x && window.first.y <= pixel.y &&
           pixel.y <= window.last.y;
}

Window around(const Window& a, const Window& b) {
    return {glm::min(a.first, b.first), glm::max(a.last, b.last)};
}

Window data_window(const ExrPicture& picture) {
    if (const auto* deep = std::get_if<DeepImage>(&picture)) {
        return window_of(deep->placement, deep->width, deep->height);
    }
    const FlatPicture& flat = std::get<FlatPicture>(picture);
    return window_of(flat.placement, flat.color.width, flat.color.height);
}

Window display_window(const ExrPicture& picture) {
    const Placement& placement = placement_of(picture);
    return placement.frame ? *placement.frame : data_window(picture);
}

ExrPicture grown(ExrPicture picture, const Window& window) {
    const Window old = data_window(picture);
    if (same(old, window)) return picture;
    std::visit(
        [&](auto& p) {
            // A picture that is a whole by itself stays one.
            if (!p.placement.frame) p.placement.frame = old;
            p.placement.origin = window.first;
            grow(p, place_of(old, window));
        },
        picture);
    return picture;
}

}  // namespace sightline
