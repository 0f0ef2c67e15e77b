#include "sightline/scene.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cassert>
#include <glm/common.hpp>
#include <numeric>

#include "scene/bounds.hpp"
#include "scene/finish.hpp"
#include "scene/joined_mesh.hpp"
#include "scene/motion.hpp"
#include "scene/recentre.hpp"
#include "scene/sheets.hpp"
#include "scene/topology.hpp"
#include "scene/translucency.hpp"
#include "scene/weld.hpp"

namespace sightline {
namespace {

using Range = tbb::blocked_range<std::uint32_t>;

Box bounds_of_triangles(const Scene& scene) {
    Box box;
    for (int k = 0; k < 3; ++k) {
        const Box corners =
            bounds_of_points(scene.triangle_count(), [&](std::uint32_t t) -> const glm::dvec3& {
                return scene.positions[scene.triangles[t][k]];
            });
        if (corners.empty()) return {};
        box = k == 0 ? corners : Box{glm::min(box.lo, corners.lo), glm::max(box.hi, corners.hi)};
    }
    return box;
}

Box bounds_of_positions(const Scene& scene) {
    return bounds_of_points(
        static_cast<std::uint32_t>(scene.positions.size()),
        [&](std::uint32_t i) -> const glm::dvec3& { return scene.positions[i]; });
}

void add_quadrics(const std::vector<Quadric>& quadrics, Box& box) {
    for (const Quadric& quadric : quadrics) {
        const Box own = bounds_of(quadric);
        box = box.empty() ? own : Box{glm::min(box.lo, own.lo), glm::max(box.hi, own.hi)};
    }
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
    if (scene.counts.degenerate_triangles == 0) std::vector<std::uint8_t>().swap(scene.degenerate);
}

/// What is derived, after the bounds of the triangles. Equal positions of an object share an index
/// if `joined`.
void derive(Scene& scene, bool joined, double weld, FindSheets sheets = FindSheets::yes) {
    add_quadrics(scene.quadrics, scene.bounds);
    scene.reach = reach_of(scene);
    find_degenerate(scene);
    scene.counts.polygons =
        std::accumulate(scene.objects.begin(), scene.objects.end(), std::uint64_t{0},
                        [](std::uint64_t sum, const Object& o) { return sum + o.polygon_count; });
    find_translucent_vertices(scene);
    Joins joins;
    // Neither looks at what the other finds.
    tbb::parallel_invoke([&] { joins = find_closed_objects(scene, joined, weld); },
                         [&] {
                             if (sheets == FindSheets::yes) build_sheets(scene);
                         });
    if (joins.positions == 0) return;
    // Rare enough to begin anew.
    apply(joins, scene);
    scene.bounds = bounds_of_triangles(scene);
    derive(scene, joined, 0, sheets);
}

}  // namespace

std::uint32_t Scene::object_of(std::uint32_t id) const {
    assert(id < triangle_count() + quadrics.size() && !objects.empty());
    if (is_quadric(id))
        return static_cast<std::uint32_t>(objects.size() - quadrics.size()) + id - triangle_count();
    // The last object that begins at or before the triangle: empty ones stand before it.
    const auto after = std::ranges::upper_bound(objects, id, {}, &Object::first_triangle);
    return static_cast<std::uint32_t>(after - objects.begin()) - 1;
}

void finish_scene(Scene& scene, double weld) {
    scene.bounds = bounds_of_triangles(scene);
    if (recentre(scene)) scene.bounds = bounds_of_triangles(scene);
    join_equal_positions(scene);
    derive(scene, true, weld);
}

void finish_joined_scene(Scene& scene, const FinishOptions& options) {
    if (options.offset) move_to_offset(scene, *options.offset);
    scene.bounds = bounds_of_positions(scene);
    if (!options.offset && recentre(scene)) scene.bounds = bounds_of_positions(scene);
    derive(scene, true, options.weld, options.sheets);
}

void finish_derived_scene(Scene& scene) {
    scene.bounds = bounds_of_triangles(scene);
    derive(scene, false, 0);
}

void finish_scene_without_sheets(Scene& scene) {
    scene.bounds = bounds_of_triangles(scene);
    derive(scene, true, 0, FindSheets::no);
}

}  // namespace sightline
