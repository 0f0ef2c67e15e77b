// The canonical scene: snapping, clipping without cracks, big pictures, counts.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

TEST(Project, SnapsWithinHalfAUnit) {
    Random random(21);
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        const Scene scene = hostile_scene(seed);
        const Camera camera = hostile_camera(scene, seed, {640, 480});
        const ScreenScene screen = must(project(scene, camera, {Cull::none, 1}));
        for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
            if (!screen.drawable(t)) continue;
            for (int k = 0; k < 3; ++k) {
                const glm::dvec3& p = scene.positions[scene.triangles[t][k]];
                const ScreenPoint s = screen.point(scene.triangles[t][k]);
                const glm::dvec2 pixel = camera.pixel_of(p);
                ASSERT_NEAR(s.x, pixel.x * 256, 0.5 + 1e-6);
                ASSERT_NEAR(s.y, pixel.y * 256, 0.5 + 1e-6);
                // One unit of z is this long here.
                const double unit = screen.metric_depth(s.z + 1.0) - screen.metric_depth(s.z);
                ASSERT_NEAR(screen.metric_depth(s.z), camera.depth_of(p), 0.51 * unit + 1e-12);
            }
        }
    }
}

// A closed surface around the eye covers every sample, however the near plane and the guard band
// cut it: a crack between neighbours would show the background.
TEST(Project, ClippedNeighboursLeaveNoCracks) {
    std::uint64_t clipped = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        Random random(seed);
        SceneBuilder b;
        b.box({-1, -1, -1}, {1, 1, 1});
        const Scene room = seed % 2 == 0 ? b.build() : sphere_scene(12, 17);
        CameraOptions options;
        options.eye = random.point(seed % 2 == 0 ? 0.9 : 0.4);
        options.direction = random.point() + glm::dvec3{1e-3, 0, 0};
        options.up = glm::cross(*options.direction, glm::dvec3{.1, .5, .7});
        options.fov = random.uniform(30, 170);
        options.near_plane = 1e-3;
        options.zoom = seed % 3 == 0 ? 50 : 1;
        const Camera camera = must(make_camera(options, room.bounds, {160, 120}));
        const ScreenScene screen = must(project(room, camera, {Cull::none, 0}));
        clipped += screen.counts().clipped;
        ResolveOptions resolve_options;
        resolve_options.samples_per_axis = 4;
        const Visibility seen = run("zbuffer", screen, resolve_options);
        std::uint64_t holes = 0;
        for (const std::uint32_t id : seen.ids) holes += id == kNone;
        EXPECT_EQ(holes, 0u) << seed;
    }
    EXPECT_GT(clipped, 100u);
}

TEST(Project, ClipsAtTheNearPlane) {
    // A floor from behind the eye to far ahead.
    const Scene floor =
        SceneBuilder().quad({-5, 0, 10}, {5, 0, 10}, {5, 0, -50}, {-5, 0, -50}).build();
    CameraOptions options;
    options.eye = glm::dvec3{0, 1, 0};
    options.direction = glm::dvec3{0, 0, -1};
    options.near_plane = 0.5;
    options.fov = 90;
    const Camera camera = must(make_camera(options, floor.bounds, {100, 100}));
    const ScreenScene screen = must(project(floor, camera, {Cull::none, 1}));
    EXPECT_EQ(screen.counts().clipped, 2u);
    EXPECT_GE(screen.counts().pieces, 3u);
    const Visibility seen = run("zbuffer", screen);
    // The row 25 pixels below the horizon sees the floor at depth 2 (45 degrees are 50 pixels).
    const std::size_t at = 75 * 100 + 50;
    ASSERT_NE(seen.ids[at], kNone);
    EXPECT_NEAR(screen.metric_depth(seen.depth[at]), 50 / 25.5, 1e-3);
    EXPECT_EQ(seen.ids[20 * 100 + 50], kNone);  // the sky
    EXPECT_EQ(count_differences(seen, run("brute", screen)), 0u);
}

TEST(Project, EverythingBehindTheEyeIsNothing) {
    const Scene scene = SceneBuilder().box({-1, -1, 5}, {1, 1, 6}).build();
    CameraOptions options;
    options.eye = glm::dvec3{0, 0, 0};
    options.direction = glm::dvec3{0, 0, -1};
    const Camera camera = must(make_camera(options, scene.bounds, {32, 32}));
    const ScreenScene screen = must(project(scene, camera, {Cull::none, 1}));
    EXPECT_EQ(screen.counts().outside, 12u);
    for (const std::uint32_t id : run("zbuffer", screen).ids) EXPECT_EQ(id, kNone);
}

// The widest pictures have fewer sub-pixel bits and still agree with brute force.
TEST(Project, VeryWidePictures) {
    const Scene scene = hostile_scene(3);
    for (const std::uint32_t width : {30000u, 40000u, 65536u}) {
        const Camera camera = must(make_camera({}, scene.bounds, {width, 5}));
        const ScreenScene screen = must(project(scene, camera, {Cull::none, 0}));
        EXPECT_EQ(screen.subpixel_bits(), width == 30000 ? 8 : width == 40000 ? 7 : 6);
        EXPECT_EQ(count_differences(run("zbuffer", screen), run("brute", screen)), 0u);
    }
    Camera too_wide = must(make_camera({}, scene.bounds, {64, 64}));
    too_wide.resolution.width = 65537;
    EXPECT_FALSE(project(scene, too_wide).ok());
}

TEST(Project, CountsWhatItDrops) {
    SceneBuilder b;
    b.box({0, 0, 0}, {1, 1, 1}).triangle({0, 0, 0}, {1, 1, 1}, {2, 2, 2});
    const Scene scene = b.build();
    EXPECT_EQ(scene.counts.degenerate_triangles, 1u);
    const Camera camera = must(make_camera({}, scene.bounds, {64, 64}));
    const ScreenScene screen = must(project(scene, camera, {Cull::back, 1}));
    EXPECT_EQ(screen.counts().triangles, 13u);
    EXPECT_EQ(screen.counts().degenerate, 1u);
    EXPECT_EQ(screen.counts().culled, 6u);  // half of a cube in an isometric view
    EXPECT_FALSE(screen.drawable(12));
}

// Open surfaces, transparent ones and ones that the near plane cuts open keep their backs.
TEST(Project, AutomaticCullingIsCareful) {
    SceneBuilder closed, open;
    closed.box({-1, -1, -1}, {1, 1, 1});
    open.quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
    const Camera outside = must(make_camera({}, Box{{-1, -1, -1}, {1, 1, 1}}, {64, 64}));
    Scene scene = closed.build();
    EXPECT_EQ(must(project(scene, outside)).counts().culled, 6u);
    scene.materials[0].opacity = 0.5f;
    EXPECT_EQ(must(project(scene, outside)).counts().culled, 0u);
    EXPECT_EQ(must(project(open.build(), outside)).counts().culled, 0u);
    CameraOptions options;
    options.eye = glm::dvec3{0, 0, 0};
    options.direction = glm::dvec3{1, 0.2, 0.1};
    const Scene room = closed.build();
    const Camera inside = must(make_camera(options, room.bounds, {64, 64}));
    EXPECT_EQ(must(project(room, inside)).counts().culled, 0u);
}

}  // namespace
}  // namespace sightline
