// Against an independent ray caster (Embree): ids may differ only within 1/256 pixel of an edge of
// one of the two triangles, and depths only by what snapping can move them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <limits>
#include <memory>

#include "support/embree_scene.hpp"
#include "support/models.hpp"
#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

struct Hit {
    std::uint32_t id = kNone;
    double depth = 0;
};

class RayCaster {
public:
    explicit RayCaster(const Scene& scene) : scene_(scene) {}

    [[nodiscard]] Hit cast(const Camera& camera, std::uint32_t i, std::uint32_t j) const {
        const glm::dvec3 origin = camera.unproject({i + 0.5, j + 0.5}, 0);
        const glm::dvec3 towards = camera.unproject({i + 0.5, j + 0.5}, camera.far_plane) - origin;
        RTCRayHit query{};
        query.ray = {static_cast<float>(origin.x),
                     static_cast<float>(origin.y),
                     static_cast<float>(origin.z),
                     0,
                     static_cast<float>(towards.x),
                     static_cast<float>(towards.y),
                     static_cast<float>(towards.z),
                     0,
                     std::numeric_limits<float>::infinity(),
                     ~0u,
                     0,
                     0};
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(scene_.get(), &context, &query);
        if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
        // The ray's parameter is 1 at the far plane.
        return {query.hit.primID, double{query.ray.tfar} * camera.far_plane};
    }

private:
    EmbreeScene scene_;
};

// Distance of a pixel's centre from the outline of a triangle's picture, in pixels.
double distance_to_outline(const Scene& scene, const Camera& camera, std::uint32_t id,
                           glm::dvec2 centre) {
    if (id == kNone) return std::numeric_limits<double>::infinity();
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
        const glm::dvec2 p = camera.pixel_of(scene.positions[scene.triangles[id][k]]);
        const glm::dvec2 q = camera.pixel_of(scene.positions[scene.triangles[id][(k + 1) % 3]]);
        const glm::dvec2 along = q - p;
        const double length2 = glm::dot(along, along);
        const double t =
            length2 > 0 ? std::clamp(glm::dot(centre - p, along) / length2, 0.0, 1.0) : 0;
        least = std::min(least, glm::length(centre - (p + t * along)));
    }
    return least;
}

// What snapping can move a depth, in the scene's unit.
double snapping_bound(const ScreenScene& screen, std::uint32_t id, double z) {
    const Plane p = screen.plane(id);
    const double c = static_cast<double>(p.c);
    const double units = 0.5 + 0.5 * (std::abs(static_cast<double>(p.a)) / c +
                                      std::abs(static_cast<double>(p.b)) / c);
    return std::max(screen.metric_depth(std::min(z + units, 0x1p30)) - screen.metric_depth(z),
                    screen.metric_depth(z) - screen.metric_depth(std::max(z - units, 0.0)));
}

void expect_equal_to_ray_caster(const Scene& scene, Resolution resolution) {
    const Camera camera = must(make_camera(bench_camera(scene.bounds), scene.bounds, resolution));
    const ScreenScene screen = must(project(scene, camera, {Cull::none, 0}));
    const Visibility seen = run("zbuffer", screen);
    const RayCaster caster(scene);
    const double size = glm::length(scene.bounds.extent());
    std::uint64_t covered = 0, differ = 0, far_from_edges = 0, wrong_depths = 0;
    for (std::uint32_t j = 0; j < resolution.height; ++j)
        for (std::uint32_t i = 0; i < resolution.width; ++i) {
            const std::size_t at = std::size_t{j} * resolution.width + i;
            const Hit hit = caster.cast(camera, i, j);
            covered += hit.id != kNone;
            if (hit.id != seen.ids[at]) {
                ++differ;
                const glm::dvec2 centre{i + 0.5, j + 0.5};
                far_from_edges +=
                    std::min(distance_to_outline(scene, camera, hit.id, centre),
                             distance_to_outline(scene, camera, seen.ids[at], centre)) > 1.0 / 256;
            } else if (hit.id != kNone) {
                const double error = std::abs(screen.metric_depth(seen.depth[at]) - hit.depth);
                wrong_depths +=
                    error > 1e-4 * size + snapping_bound(screen, hit.id, seen.depth[at]);
            }
        }
    std::cout << "ray caster: " << covered << " samples covered, " << differ << " ids differ, "
              << far_from_edges << " of them further than 1/256 pixel from an edge, "
              << wrong_depths << " depths beyond the bound\n";
    EXPECT_GT(covered, 1000u);
    EXPECT_EQ(far_from_edges, 0u);
    EXPECT_EQ(wrong_depths, 0u);
    EXPECT_LT(differ, covered / 50);  // more where triangles are smaller than pixels
}

TEST(RayCaster, AgreesOnASphere) {
    Scene scene = sphere_scene(60, 90);
    // Embree takes floats; both sides shall see the same points.
    for (glm::dvec3& p : scene.positions) p = glm::dvec3(glm::vec3(p));
    finish_scene(scene);
    expect_equal_to_ray_caster(scene, {480, 270});
}

TEST(RayCaster, AgreesOnTheBunny) {
    const std::optional<Scene> scene = real_model("stanford-bunny.obj");
    if (!scene) GTEST_SKIP() << "stanford-bunny.obj is not there; set SIGHTLINE_MODELS";
#ifdef SIGHTLINE_SANITIZED
    expect_equal_to_ray_caster(*scene, {480, 270});
#else
    expect_equal_to_ray_caster(*scene, {1920, 1080});
#endif
}

}  // namespace
}  // namespace sightline
