// Small drawings made by hand.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <initializer_list>
#include <vector>

#include "sightline/scene.hpp"
#include "sightline/vector.hpp"

namespace sightline::testing {

/// What a part is, besides where it lies.
struct PartLook {
    EdgeKind kind = EdgeKind::crease;
    bool visible = true;
    std::uint32_t object = 0;
    glm::uvec2 polygons{0, kNone};
};

inline void add_part(DrawnLines& lines, glm::dvec2 from, glm::dvec2 to, const PartLook& look = {}) {
    lines.from.push_back(from);
    lines.to.push_back(to);
    lines.kind.push_back(look.kind);
    lines.visible.push_back(look.visible ? 1 : 0);
    lines.polygons.push_back(look.polygons);
    lines.object.push_back(look.object);
}

inline void add_polyline(DrawnLines& lines, const std::vector<glm::dvec2>& points,
                         const PartLook& look = {}) {
    for (std::size_t i = 1; i < points.size(); ++i) add_part(lines, points[i - 1], points[i], look);
}

inline void add_region(DrawnRegions& regions, std::uint32_t polygon, glm::vec3 color,
                       std::initializer_list<std::vector<glm::dvec2>> loops) {
    if (regions.first_loop.empty()) regions.first_loop = regions.first_point = {0};
    regions.polygon.push_back(polygon);
    regions.object.push_back(0);
    regions.color.push_back(color);
    for (const auto& loop : loops) {
        regions.points.insert(regions.points.end(), loop.begin(), loop.end());
        regions.first_point.push_back(static_cast<std::uint32_t>(regions.points.size()));
    }
    regions.first_loop.push_back(static_cast<std::uint32_t>(regions.first_point.size() - 1));
}

/// 200 x 100 pixels: a square with a square hole beside a triangle, outlines, a hidden diagonal,
/// and a guide that leaves the page.
inline Drawing small_drawing() {
    Drawing d;
    d.resolution = {200, 100};
    add_region(
        d.regions, 7, {1, 0, 0},
        {{{10, 10}, {90, 10}, {90, 90}, {10, 90}}, {{30, 30}, {30, 70}, {70, 70}, {70, 30}}});
    add_region(d.regions, 8, {0, 0, 1}, {{{90, 10}, {190, 50}, {90, 90}}});
    const PartLook outline{EdgeKind::silhouette, true, 0, {7, kNone}};
    add_polyline(d.lines, {{10, 10}, {90, 10}, {90, 90}, {10, 90}, {10, 10}}, outline);
    add_polyline(d.lines, {{90, 10}, {190.0625, 50.5}, {90, 90}},
                 {EdgeKind::crease, true, 1, {7, 8}});
    add_part(d.lines, {10, 10}, {90, 90}, {EdgeKind::crease, false, 0, {7, 9}});
    d.guides.push_back({{100, 50}, {1e12, 50}, 0});
    d.guides.push_back({{100, 50}, {100, -1e12}, 1});
    return d;
}

inline VectorOptions pixel_options(const Drawing& drawing) {
    VectorOptions options;
    options.layout.width = drawing.resolution.width;
    options.layout.height = drawing.resolution.height;
    return options;
}

}  // namespace sightline::testing
