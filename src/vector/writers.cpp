// What the writers of drawings share. Clipping is that of Y.-D. Liang and B. Barsky ("A new concept
// and method for line clipping", 1984).
#include "vector/writers.hpp"

#include <algorithm>
#include <utility>

#include "sightline/image.hpp"

namespace sightline {

Rgb8 rgb8(glm::vec3 linear) { return {to_srgb8(linear.r), to_srgb8(linear.g), to_srgb8(linear.b)}; }

Look look_of(EdgeKind kind) {
    switch (kind) {
        case EdgeKind::lower:
            return {0.7, {0x77, 0x77, 0x77}};
        case EdgeKind::hatch:
            return {0.6, {0, 0, 0}};
        case EdgeKind::axis:
            return {0.7, {0x55, 0x55, 0x55}};
        default:
            return {};
    }
}

std::vector<ColoredRegion> by_color(const DrawnRegions& regions) {
    std::vector<ColoredRegion> order(regions.size());
    for (std::uint32_t r = 0; r < order.size(); ++r) {
        const Rgb8 c = rgb8(regions.color[r]);
        order[r] = {std::uint32_t{c[0]} << 16 | std::uint32_t{c[1]} << 8 | c[2], r};
    }
    const auto before = [](const ColoredRegion& a, const ColoredRegion& b) {
        return std::pair(a.color, a.region) < std::pair(b.color, b.region);
    };
    std::sort(order.begin(), order.end(), before);
    return order;
}

std::optional<std::array<glm::dvec2, 2>> clipped(const GuideLine& guide, const PageLayout& layout) {
    const glm::dvec2 from = on_page(layout, guide.from);
    const glm::dvec2 way = on_page(layout, guide.to) - from;
    const glm::dvec2 size(layout.width, layout.height);
    double enter = 0, leave = 1;  // shares of the way
    for (int k = 0; k < 2; ++k) {
        if (way[k] == 0) {
            if (from[k] < 0 || from[k] > size[k]) return std::nullopt;
            continue;
        }
        const double at_zero = -from[k] / way[k], at_size = (size[k] - from[k]) / way[k];
        enter = std::max(enter, std::min(at_zero, at_size));
        leave = std::min(leave, std::max(at_zero, at_size));
    }
    if (!(enter < leave)) return std::nullopt;
    const auto inside = [&](double share) {
        return glm::clamp(from + share * way, glm::dvec2(0), size);
    };
    return std::array{inside(enter), inside(leave)};
}

}  // namespace sightline
