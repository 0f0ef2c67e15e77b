// Source: Foley, van Dam, Feiner, Hughes, "Computer Graphics: Principles and Practice", 2nd ed.,
// section 15.2.4; Sutherland, Sproull, Schumacker 1974. Three forms of one test: the engine uses
// the first, which needs no projection and holds in every view; the tests show that they agree.
#include "view/facing.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <functional>
#include <glm/geometric.hpp>

#include "math/arena.hpp"
#include "math/newell.hpp"
#include "sightline/screen_scene.hpp"

namespace sightline {

namespace {

Facing front_when_negative(double value) {
    return value < 0 ? Facing::front : value > 0 ? Facing::back : Facing::edge_on;
}

}  // namespace

Facing facing(const Camera& camera, const std::array<glm::dvec3, 3>& corners) {
    // Relative to a corner, so that the products keep their digits far from the origin.
    const std::array<glm::dvec3, 3> local{glm::dvec3{0, 0, 0}, corners[1] - corners[0],
                                          corners[2] - corners[0]};
    return front_when_negative(
        glm::dot(camera.view_vector(corners[0]), math::newell_normal(local)));
}

Facing facing_by_c(const Camera& camera, const std::array<glm::dvec3, 3>& corners) {
    const std::array<glm::dvec3, 3> local{glm::dvec3{0, 0, 0}, corners[1] - corners[0],
                                          corners[2] - corners[0]};
    return front_when_negative(-glm::dot(camera.back, math::newell_normal(local)));
}

Facing facing_by_winding(const Camera& camera, const std::array<glm::dvec3, 3>& corners) {
    const glm::dvec2 p = camera.pixel_of(corners[0]);
    const glm::dvec2 u = camera.pixel_of(corners[1]) - p, v = camera.pixel_of(corners[2]) - p;
    // y grows downwards, so counter-clockwise on the page is a negative cross product.
    return front_when_negative(u.x * v.y - u.y * v.x);
}

std::uint64_t count_back_facing(const Scene& scene, const Camera& camera, int threads) {
    constexpr std::size_t kGrain = 16384;  // triangles that a task takes at a time
    const auto is_back = [&](const Corners& c) {
        const auto& p = scene.positions;
        return facing(camera, {p[c.x], p[c.y], p[c.z]}) == Facing::back;
    };
    std::uint64_t backs = 0;
    in_arena(threads, [&] {
        backs = tbb::parallel_reduce(
            tbb::blocked_range<std::size_t>(0, scene.triangles.size(), kGrain), std::uint64_t{0},
            [&](const auto& range, std::uint64_t sum) {
                for (std::size_t t = range.begin(); t != range.end(); ++t) {
                    sum += is_back(scene.triangles[t]) ? 1 : 0;
                }
                return sum;
            },
            std::plus<>());
    });
    return backs;
}

}  // namespace sightline
