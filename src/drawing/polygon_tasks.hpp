// How the visible parts of faces are found on all cores: source polygon by source polygon.
#pragma once

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "drawing/regions.hpp"
#include "drawing/slivers.hpp"
#include "math/arena.hpp"

namespace sightline {

inline constexpr std::size_t kFaceGrain = 128;  // occluders that a task takes at a time, about

using RegionFinders = tbb::enumerable_thread_specific<RegionFinder>;

/// Occluders in the order of their source polygons, so that those of a polygon stand together.
[[nodiscard]] inline std::vector<std::uint32_t> by_polygon(const ScreenScene& page,
                                                           const Occluders& occluders) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sorted(occluders.size());
    for (std::uint32_t k = 0; k < occluders.size(); ++k)
        sorted[k] = {page.scene().triangle_polygon[occluders[k].id], k};
    tbb::parallel_sort(sorted.begin(), sorted.end());
    std::vector<std::uint32_t> order(sorted.size());
    std::ranges::transform(sorted, order.begin(), [](const auto& item) { return item.second; });
    return order;
}

/// body(task, begin, end) for stretches of the order that never divide a polygon.
template <class Body>
void for_polygons(const ScreenScene& page, const Occluders& occluders,
                  const std::vector<std::uint32_t>& order, int threads, const Body& body) {
    std::vector<std::size_t> starts = {0};
    const auto polygon = [&](std::size_t i) {
        return page.scene().triangle_polygon[occluders[order[i]].id];
    };
    while (starts.back() < order.size()) {
        std::size_t end = std::min(order.size(), starts.back() + kFaceGrain);
        while (end < order.size() && polygon(end) == polygon(end - 1)) ++end;
        starts.push_back(end);
    }
    in_arena(threads, [&] {
        tbb::parallel_for(std::size_t{0}, starts.size() - 1,
                          [&](std::size_t task) { body(task, starts[task], starts[task + 1]); });
    });
}

/// One byte a polygon of the scene, not 0: something of it is seen that is no sliver.
[[nodiscard]] inline std::vector<std::uint8_t> nothing_seen(const Scene& scene) {
    const auto& polygons = scene.triangle_polygon;
    const auto last = std::ranges::max_element(polygons);
    return std::vector<std::uint8_t>(last == polygons.end() ? 0 : std::size_t{*last} + 1, 0);
}

}  // namespace sightline
