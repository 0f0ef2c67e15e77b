// bsp: every sample in which it differs from the canonical answer is explained by what snapping can
// do to the two surfaces.
#include "sightline/bsp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "sightline/generate.hpp"
#include "support/bsp_differences.hpp"
#include "support/models.hpp"
#include "support/nasty.hpp"

namespace sightline {
namespace {

using namespace testing;

bool full() { return std::getenv("SIGHTLINE_FULL") != nullptr; }

Differences differences(const ScreenScene& screen, const ResolveOptions& options = {}) {
    ResolveOptions canonical = options;
    canonical.tree = nullptr;
    canonical.counters = nullptr;
    return DifferenceJudge(screen).compare(run("zbuffer", screen, canonical),
                                           run("bsp", screen, options));
}

std::uint64_t counted(const std::vector<Counter>& counters, std::string_view name) {
    for (const Counter& counter : counters)
        if (counter.name == name) return counter.value;
    ADD_FAILURE() << "no counter " << name;
    return 0;
}

TEST(Bsp, EveryDifferenceOnHostileScenesIsExplained) {
    Differences all;
#ifdef SIGHTLINE_SANITIZED
    const std::uint64_t scenes = full() ? 5000 : 200;
#else
    const std::uint64_t scenes = full() ? 100000 : 1500;
#endif
    std::uint64_t clipped = 0;
    for (std::uint64_t seed = 0; seed < scenes; ++seed) {
        const Scene scene = hostile_scene(seed);
        const Camera camera = hostile_camera(scene, seed, {56, 48});
        ProjectOptions project_options;
        project_options.cull = seed % 4 == 0 ? Cull::automatic : Cull::none;
        const ScreenScene screen = must(project(scene, camera, project_options));
        clipped += screen.counts().clipped;
        ResolveOptions options;
        options.threads = 1;
        options.samples_per_axis = seed % 8 == 1 ? 2 : 1;
        const Differences here = differences(screen, options);
        ASSERT_EQ(here.unexplained, 0u) << "seed " << seed << ", " << here.first;
        all += here;
    }
    EXPECT_GT(clipped, scenes / 2);
    EXPECT_LE(all.grazed, all.samples / 1000000);
    RecordProperty("differing", static_cast<int>(all.differing));
    RecordProperty("steep", static_cast<int>(all.steep));
    RecordProperty("grazed", static_cast<int>(all.grazed));
}

TEST(Bsp, EveryDifferenceOnNastyScenesIsExplained) {
    for (const NastyScene& nasty : nasty_scenes()) {
        // Of a thousand polygons through a point every two cross: half a million pieces.
        if (nasty.name == "polygons through a point" && !full()) continue;
#ifdef SIGHTLINE_SANITIZED
        if (nasty.entangled)
            continue;  // the other scenes take the same code, in a tenth of the time
#endif
        const BspTree tree = must(build_bsp(nasty.scene));
        ResolveOptions options;
        options.tree = &tree;
        const std::uint64_t views = tree.stats().pieces > 100000 && !full() ? 1 : 3;
        for (std::uint64_t view = 0; view < views; ++view) {
            const Camera camera = view == 0 ? page_camera(nasty.scene, {64, 64})
                                            : hostile_camera(nasty.scene, view, {120, 90});
            const ScreenScene screen = must(project(nasty.scene, camera, {Cull::none, 0}));
            const Differences found = differences(screen, options);
            EXPECT_EQ(found.unexplained, 0u) << nasty.name << ", view " << view << found.first;
            EXPECT_LE(found.grazed, 3u) << nasty.name << ", view " << view;
        }
    }
}

TEST(Bsp, CrossingTrianglesAreSplitWhereTheyCross) {
    const Scene scene = must(random_triangles(600, 5, {8, {1, 1, 1}}));
    for (std::uint64_t view = 0; view < 6; ++view) {
        const ScreenScene screen =
            must(project(scene, hostile_camera(scene, view, {200, 150}), {Cull::none, 0}));
        std::vector<Counter> counters;
        ResolveOptions options;
        options.counters = &counters;
        const Differences found = differences(screen, options);
        EXPECT_EQ(found.unexplained, 0u) << found.first;
        EXPECT_GT(counted(counters, "bsp splits"), 600u);
        EXPECT_GT(counted(counters, "back faces met"), 0u);
        EXPECT_LT(counted(counters, "back faces met"), counted(counters, "pieces met"));
    }
}

// Copies, decals and touching walls: one node holds them, and the lowest id is painted last.
TEST(Bsp, CoplanarFacesAreSeenByTheLowestId) {
    SceneBuilder b;
    const auto at = [](double x, double y) { return glm::dvec3(x, y, 0.3 * x + 0.2 * y); };
    b.quad(at(-.2, -.2), at(.3, -.2), at(.3, .3), at(-.2, .3));
    b.quad(at(-1, -1), at(1, -1), at(1, 1), at(-1, 1));
    b.quad(at(-.5, -.5), at(.1, -.5), at(.1, .1), at(-.5, .1));
    for (int copy = 0; copy < 200; ++copy) b.triangle(at(-1, -1), at(.9, -.8), at(.7, .9));
    const Scene scene = b.build();
    const BspTree tree = must(build_bsp(scene));
    EXPECT_EQ(tree.stats().nodes, 1u);
    EXPECT_EQ(tree.stats().splits, 0u);
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const ScreenScene screen =
            must(project(scene, hostile_camera(scene, seed, {80, 60}), {Cull::none, 0}));
        const Differences found = differences(screen);
        // But where the plane is nearly edge-on it may have no depth of its own on the screen.
        EXPECT_EQ(found.unexplained, 0u) << found.first;
        EXPECT_LE(found.differing, found.samples / 100) << seed;
    }
}

// A room with a table, seen from within: near clipping leaves pieces of triangles.
TEST(Bsp, TheEyeMayStandAmongTheSurfaces) {
    SceneBuilder b;
    b.box({-1, -1, -1}, {1, 1, 1})
        .box({-.4, -.9, -.4}, {.4, -.3, .4})
        .box({-.1, -.3, -.2}, {.1, .1, .1});
    const Scene scene = b.build();
    const BspTree tree = must(build_bsp(scene));
    Random random(3);
    for (int view = 0; view < 30; ++view) {
        CameraOptions camera;
        camera.eye = random.point(.95);
        camera.direction = random.point() + glm::dvec3(.01, .02, 0);
        camera.fov = 100;
        camera.near_plane = 1e-3;
        const ScreenScene screen = must(
            project(scene, must(make_camera(camera, scene.bounds, {120, 90})), {Cull::none, 0}));
        ASSERT_GT(screen.counts().clipped, 0u);
        ResolveOptions options;
        options.tree = &tree;
        const Differences found = differences(screen, options);
        EXPECT_EQ(found.unexplained + found.grazed, 0u) << found.first;
    }
}

// Walls that are seen edge-on, through samples or along the border of two of them.
TEST(Bsp, TheEyeMayStandInPlanesOfNodes) {
    SceneBuilder b;
    for (int k = -2; k <= 2; ++k) {
        const double s = 0.25 * k;
        b.quad({s, -.9, -.9}, {s, .9, -.9}, {s, .9, .9}, {s, -.9, .9});
        b.quad({-.9, s, -.9}, {.9, s, -.9}, {.9, s, .9}, {-.9, s, .9});
        b.quad({-.9, -.9, s}, {.9, -.9, s}, {.9, .9, s}, {-.9, .9, s});
    }
    const Scene scene = b.build();
    const BspTree tree = must(build_bsp(scene));
    ResolveOptions options;
    options.tree = &tree;
    for (const Projection projection : {Projection::perspective, Projection::orthographic,
                                        Projection::cavalier, Projection::cabinet}) {
        for (const glm::dvec3& eye :
             {glm::dvec3{0, 0, 4}, {.25, 0, 4}, {4, .5, 0}, {.25, -4, .5}, {0.25, 0.25, 0.6}}) {
            CameraOptions camera;
            camera.projection = projection;
            camera.eye = eye;
            camera.direction = eye.x > 3   ? glm::dvec3(-1, 0, 0)
                               : eye.y < 0 ? glm::dvec3(0, 1, 0)
                                           : glm::dvec3(0, 0, -1);
            camera.up = glm::dvec3(0.1, 0.3, 1);
            if (eye.z > .55) camera.up = glm::dvec3(0, 1, 0);
            for (const Resolution size : {Resolution{64, 64}, Resolution{97, 61}}) {
                const ScreenScene screen = must(
                    project(scene, must(make_camera(camera, scene.bounds, size)), {Cull::none, 0}));
                const Differences found = differences(screen, options);
                EXPECT_EQ(found.unexplained, 0u)
                    << name_of(projection) << " from " << eye.x << ", " << eye.y << found.first;
            }
        }
    }
}

// Points spread evenly over the sphere (a Fibonacci lattice).
glm::dvec3 direction(int k, int of) {
    const double golden = std::acos(-1.0) * (3 - std::sqrt(5.0));
    const double y = 1 - 2 * (k + 0.5) / of, r = std::sqrt(1 - y * y);
    return {r * std::cos(golden * k), y, r * std::sin(golden * k)};
}

TEST(Bsp, DiffersOnRealModelsInLessThanOneSampleOfAHundredThousand) {
#ifdef SIGHTLINE_SANITIZED
    GTEST_SKIP() << "what it runs is run by smaller scenes under the sanitizers";
#endif
    const int views = full() ? 20 : 2;
    const Resolution size = full() ? Resolution{1920, 1080} : Resolution{640, 360};
    Differences all;
    for (const char* name : {"stanford-bunny.obj", "fandisk.obj", "teapot.obj"}) {
        const std::optional<Scene> scene = real_model(name);
        if (!scene) GTEST_SKIP() << models_folder() / name << " is not there; set SIGHTLINE_MODELS";
        const BspTree tree = must(build_bsp(*scene));
        EXPECT_LT(tree.stats().pieces, 3 * tree.stats().triangles) << name;
        ResolveOptions options;
        options.tree = &tree;
        for (int view = 0; view < views; ++view) {
            CameraOptions camera;
            camera.direction = direction(view, views);
            if (view % 2 == 1) camera.projection = Projection::orthographic;
            const ScreenScene screen =
                must(project(*scene, must(make_camera(camera, scene->bounds, size))));
            all += differences(screen, options);
        }
    }
    EXPECT_EQ(all.unexplained, 0u) << all.first;
    EXPECT_LT(all.differing * 100000, all.samples);
    RecordProperty("samples", std::to_string(all.samples));
    RecordProperty("differing", std::to_string(all.differing));
}

TEST(Bsp, ATreeOfAnotherSizeIsNotUsed) {
    const Scene scene = hostile_scene(5);
    const BspTree other = must(build_bsp(SceneBuilder().box({0, 0, 0}, {1, 1, 1}).build()));
    EXPECT_FALSE(other.fits(scene));
    const ScreenScene screen = must(project(scene, hostile_camera(scene, 5, {64, 48})));
    ResolveOptions options;
    options.tree = &other;
    EXPECT_EQ(count_differences(run("bsp", screen), run("bsp", screen, options)), 0u);
}

}  // namespace
}  // namespace sightline
