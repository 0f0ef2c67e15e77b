#include "sightline/scene.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cassert>
#include <glm/common.hpp>
#include <numeric>

#include "scene/joined_mesh.hpp"
#include "scene/sheets.hpp"
#include "scene/topology.hpp"

namespace sightline {
namespace {

using Range = tbb::blocked_range<std::uint32_t>;

Box united(const Box& a, const Box& b) {
    if (a.empty()) return b;
    if (b.empty()) return a;
    return {glm::min(a.lo, b.lo), glm::max(a.hi, b.hi)};
}

Box bounds_of(const Scene& scene) {
    Box box = tbb::parallel_reduce(
        Range(0, scene.triangle_count()), Box{},
        [&](const Range& range, Box partial) {
            for (std::uint32_t t = range.begin(); t != range.end(); ++t) {
                for (int k = 0; k < 3; ++k) {
                    const glm::dvec3& p = scene.positions[scene.triangles[t][k]];
                    partial = united(partial, {p, p});
                }
            }
            return partial;
        },
        united);
    if (!box.empty()) {
        // -0 becomes +0: which zero a minimum keeps depends on the order.
        box.lo += 0.0;
        box.hi += 0.0;
    }
    return box;
}

void find_degenerate(Scene& scene) {
    scene.degenerate.assign(scene.triangles.size(), 0);
    tbb::parallel_for(Range(0, scene.triangle_count()), [&](const Range& range) {
        for (std::uint32_t t = range.begin(); t != range.end(); ++t) {
            const Corners& c = scene.triangles[t];
            const auto& p = scene.positions;
            scene.degenerate[t] = is_degenerate(p[c.x], p[c.y], p[c.z]) ? 1 : 0;
        }
    });
    scene.counts.degenerate_triangles = static_cast<std::uint64_t>(
        std::count(scene.degenerate.begin(), scene.degenerate.end(), std::uint8_t{1}));
    if (scene.counts.degenerate_triangles == 0) scene.degenerate = {};
}

}  // namespace

std::uint32_t Scene::object_of(std::uint32_t triangle) const {
    assert(triangle < triangle_count() && !objects.empty());
    // The last object that begins at or before the triangle: empty ones stand before it.
    const auto after = std::ranges::upper_bound(objects, triangle, {}, &Object::first_triangle);
    return static_cast<std::uint32_t>(after - objects.begin()) - 1;
}

void finish_scene(Scene& scene) {
    scene.bounds = bounds_of(scene);
    find_degenerate(scene);
    scene.counts.polygons =
        std::accumulate(scene.objects.begin(), scene.objects.end(), std::uint64_t{0},
                        [](std::uint64_t sum, const Object& o) { return sum + o.polygon_count; });
    find_closed_objects(scene);
    build_sheets(scene);
}

}  // namespace sightline
