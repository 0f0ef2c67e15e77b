// Every exact algorithm of the registry gives the answer of brute force, in every sample.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

constexpr Resolution kSmall{56, 48};

// More scenes where somebody has the time: make test-full.
std::uint64_t scene_count() {
#ifdef SIGHTLINE_SANITIZED
    constexpr std::uint64_t kFull = 10000, kQuick = 1000;
#else
    constexpr std::uint64_t kFull = 100000, kQuick = 3000;
#endif
    return std::getenv("SIGHTLINE_FULL") != nullptr ? kFull : kQuick;
}

std::string describe(std::uint64_t seed, std::string_view algorithm) {
    return "seed " + std::to_string(seed) + ", " + std::string(algorithm);
}

TEST(Agreement, EveryExactAlgorithmEqualsBruteForceOnHostileScenes) {
    std::uint64_t covered = 0, clipped = 0, shared = 0;
    for (std::uint64_t seed = 0; seed < scene_count(); ++seed) {
        const Scene scene = hostile_scene(seed);
        const Camera camera = hostile_camera(scene, seed, kSmall);
        ProjectOptions project_options;
        project_options.cull = seed % 4 == 0 ? Cull::automatic : Cull::none;
        const ScreenScene screen = must(project(scene, camera, project_options));
        ResolveOptions options;
        options.samples_per_axis = seed % 8 == 1 ? 2 : 1;
        const Visibility truth = run("brute", screen, options);
        for (const std::uint32_t id : truth.ids) {
            covered += id != kNone;
            shared += id != kNone && screen.shared_plane(id) != kNone;
        }
        clipped += screen.counts().clipped;
        for (const Algorithm& algorithm : algorithms()) {
            if (!algorithm.exact || algorithm.exhaustive) continue;
            const Visibility seen = run(std::string(algorithm.name), screen, options);
            ASSERT_EQ(count_differences(truth, seen), 0u) << describe(seed, algorithm.name);
        }
    }
    // The scenes are worth something: they fill the picture, are clipped, and share planes.
    EXPECT_GT(covered, scene_count() * 100);
    EXPECT_GT(clipped, scene_count() / 2);
    EXPECT_GT(shared, scene_count() * 20);
}

// Thousands of triangles of all sizes behind one another: hierarchical depth has much to dismiss.
TEST(Agreement, DeepScenesEqualBruteForce) {
    std::uint64_t hidden = 0;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        Random random(seed + 500);
        SceneBuilder b;
        for (int k = 0; k < 3000; ++k) {
            const glm::dvec3 p = random.point();
            const double size = std::pow(10.0, random.uniform(-2.5, 0.3));
            const glm::dvec3 q = p + size * random.point(), r = p + size * random.point();
            b.triangle(p, q, r);
        }
        const Scene scene = b.build();
        const Camera camera = hostile_camera(scene, seed, {130, 100});
        const ScreenScene screen = must(project(scene, camera, {Cull::none, 0}));
        std::vector<Counter> counters;
        ResolveOptions options;
        options.counters = &counters;
        const Visibility seen = run("zbuffer", screen, options);
        for (const Counter& c : counters)
            if (c.name == "triangles found hidden by blocks") hidden += c.value;
        ASSERT_EQ(count_differences(seen, run("brute", screen)), 0u) << seed;
    }
    EXPECT_GT(hidden, 1000u);
}

// Most triangles of a fine mesh hold no sample or one or two: they have a path of their own, and
// these scenes go through it.
TEST(Agreement, FineMeshesEqualBruteForceByThePathOfTinyTriangles) {
    for (const Resolution size : {Resolution{100, 75}, Resolution{160, 200}}) {
        const Scene scene = sphere_scene(200, 300);
        const Camera camera = must(make_camera({}, scene.bounds, size));
        const ScreenScene screen = must(project(scene, camera, {Cull::none, 0}));
        std::vector<Counter> counters;
        ResolveOptions options;
        options.counters = &counters;
        const Visibility seen = run("zbuffer", screen, options);
        std::uint64_t tiny = 0, covered = 0;
        for (const Counter& c : counters)
            if (c.name == "samples of tiny triangles") tiny += c.value;
        for (const std::uint32_t id : seen.ids) covered += id != kNone;
        EXPECT_GT(covered, 500u);
        EXPECT_GT(tiny, covered);  // both sides of the sphere are drawn
        EXPECT_EQ(count_differences(seen, run("brute", screen)), 0u);
    }
}

TEST(Agreement, ThreadsDoNotChangeABit) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const Scene scene = seed == 0 ? sphere_scene(60, 90) : hostile_scene(seed);
        const Camera camera = hostile_camera(scene, seed, {200, 150});
        for (const Algorithm& algorithm : algorithms()) {
            if (algorithm.exhaustive) continue;
            std::vector<Visibility> seen;
            for (const int threads : {1, 2, 8}) {
                const ScreenScene screen = must(project(scene, camera, {Cull::none, threads}));
                ResolveOptions options;
                options.threads = threads;
                seen.push_back(run(std::string(algorithm.name), screen, options));
            }
            EXPECT_EQ(count_differences(seen[0], seen[1]), 0u) << describe(seed, algorithm.name);
            EXPECT_EQ(count_differences(seen[0], seen[2]), 0u) << describe(seed, algorithm.name);
        }
    }
}

// The order of the triangles does not matter, but where the winner is tied in exact depth (then the
// lower id wins, and ids depend on the order).
TEST(Agreement, OrderOfTrianglesDoesNotMatterButInTies) {
    std::uint64_t tied = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const Scene scene = hostile_scene(seed);
        std::vector<std::uint32_t> order;
        const Scene other = shuffled(scene, seed + 1, order);
        const Camera camera = hostile_camera(scene, seed, kSmall);
        const ScreenScene a = must(project(scene, camera, {Cull::none, 1}));
        const ScreenScene b = must(project(other, camera, {Cull::none, 1}));
        const Visibility va = run("zbuffer", a), vb = run("zbuffer", b);
        for (std::size_t i = 0; i < va.ids.size(); ++i) {
            const std::uint32_t mapped = vb.ids[i] == kNone ? kNone : order[vb.ids[i]];
            if (va.ids[i] == mapped) continue;
            ASSERT_NE(va.ids[i], kNone) << seed;
            ASSERT_NE(mapped, kNone) << seed;
            // Equal depth to the last bit of the rational number.
            const auto x = static_cast<std::int32_t>(i % kSmall.width) * 256 + 128;
            const auto y = static_cast<std::int32_t>(i / kSmall.width) * 256 + 128;
            const Plane p = a.plane(va.ids[i]), q = a.plane(mapped);
            ASSERT_EQ(evaluate_depth(p, x, y), evaluate_depth(q, x, y)) << seed;
            ++tied;
        }
    }
    RecordProperty("tied_samples", static_cast<int>(tied));
    EXPECT_GT(tied, 0u);  // copies and decals are among the scenes
}

TEST(Agreement, ClosedModelsLookTheSameWithAndWithoutTheirBackFaces) {
    const Scene scene = sphere_scene(40, 60);
    ASSERT_TRUE(scene.objects[0].closed);
    const Camera camera = must(make_camera({}, scene.bounds, {320, 240}));
    const ScreenScene all = must(project(scene, camera, {Cull::none, 0}));
    const ScreenScene front = must(project(scene, camera, {Cull::automatic, 0}));
    // Perspective sees a little less than half of a sphere.
    EXPECT_GT(front.counts().culled, scene.triangles.size() * 2 / 5);
    EXPECT_LT(front.counts().culled, scene.triangles.size() * 4 / 5);
    EXPECT_EQ(all.counts().culled, 0u);
    EXPECT_EQ(count_differences(run("zbuffer", all), run("zbuffer", front)), 0u);
}

TEST(Agreement, AnObserverSeesEverySampleDecidedAndChangesNothing) {
    struct Recorder : Observer {
        std::vector<std::uint32_t> owner;
        std::uint32_t width = 0;
        std::uint64_t tiles = 0, taken = 0;
        void step(const Step& s) override {
            if (s.kind == StepKind::sample_decided) owner[s.y0 * width + s.x0] = s.triangle;
            tiles += s.kind == StepKind::tile_entered;
            taken += s.kind == StepKind::triangle_taken;
        }
    };
    const Scene scene = hostile_scene(7);
    const Camera camera = hostile_camera(scene, 7, {100, 80});
    const ScreenScene screen = must(project(scene, camera));
    Recorder recorder;
    recorder.width = 100;
    recorder.owner.assign(100 * 80, kNone);
    ResolveOptions options;
    options.observer = &recorder;
    const Visibility watched = run("zbuffer", screen, options);
    EXPECT_TRUE(std::ranges::equal(watched.ids, recorder.owner));
    EXPECT_EQ(recorder.tiles, 4u);
    EXPECT_GT(recorder.taken, 0u);
    EXPECT_EQ(count_differences(watched, run("zbuffer", screen)), 0u);
}

TEST(Registry, DefaultIsExactAndNamesAreUnique) {
    EXPECT_TRUE(default_algorithm().exact);
    EXPECT_FALSE(default_algorithm().exhaustive);
    for (const Algorithm& a : algorithms()) {
        EXPECT_EQ(find_algorithm(a.name), &a);
        EXPECT_FALSE(a.citation.empty());
        EXPECT_FALSE(a.help.empty());
    }
    EXPECT_EQ(find_algorithm("no such"), nullptr);
}

TEST(Registry, RefusesGridsThatItCannotServe) {
    const Scene scene = SceneBuilder().triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}).build();
    const Camera camera = must(make_camera({}, scene.bounds, {64, 64}));
    const ScreenScene screen = must(project(scene, camera));
    Visibility out;
    ResolveOptions options;
    options.samples_per_axis = 3;
    EXPECT_FALSE(resolve(default_algorithm(), screen, options, out).ok());
    options.samples_per_axis = 32;
    EXPECT_FALSE(resolve(default_algorithm(), screen, options, out).ok());
}

}  // namespace
}  // namespace sightline
