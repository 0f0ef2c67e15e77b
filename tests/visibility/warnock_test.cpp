// Warnock's subdivision: what it decides where, and that it looks at nothing twice.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

using Counts = std::map<std::string, std::uint64_t>;

// Looks along -z at the square from (-1, -1) to (1, 1).
ScreenScene front_view(const Scene& scene, std::uint32_t pixels) {
    CameraOptions options;
    options.view = NamedView::front;
    options.projection = Projection::orthographic;
    options.target = glm::dvec3{0, 0, 0};
    options.ortho_height = 2;
    const Camera camera = must(make_camera(options, scene.bounds, {pixels, pixels}));
    return must(project(scene, camera, {Cull::none, 0}));
}

// The answer is that of brute force; returns what was counted on the way.
Counts counts_of(const ScreenScene& screen, std::uint32_t samples_per_axis = 1) {
    std::vector<Counter> counters;
    ResolveOptions options;
    options.samples_per_axis = samples_per_axis;
    const Visibility truth = run("brute", screen, options);
    options.counters = &counters;
    EXPECT_EQ(count_differences(truth, run("warnock", screen, options)), 0u);
    Counts counts;
    for (const Counter& c : counters) counts[c.name] += c.value;
    return counts;
}

// Covers all of the front view; its depth falls by `slope` to the right.
void add_wall(SceneBuilder& b, double z, double slope = 0) {
    b.triangle({-3, -3, z - 3 * slope}, {9, -3, z + 9 * slope}, {-3, 9, z - 3 * slope});
}

// Small triangles anywhere in the view, between two depths.
void add_litter(SceneBuilder& b, int count, double z0, double z1) {
    Random random(9);
    for (int k = 0; k < count; ++k) {
        const glm::dvec3 p{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(z0, z1)};
        const auto near_p = [&] {
            return glm::dvec3{p.x + random.uniform(-.05, .05), p.y + random.uniform(-.05, .05),
                              random.uniform(z0, z1)};
        };
        const glm::dvec3 q = near_p(), r = near_p();
        b.triangle(p, q, r);
    }
}

constexpr auto kFirst = "triangles hidden at the first level";
constexpr auto kHanded = "triangles handed to quadrants";
constexpr auto kEmpty = "quadrants that are empty";
constexpr auto kSingle = "quadrants with one triangle";
constexpr auto kSurrounded = "quadrants with one surrounding triangle";
constexpr auto kInFront = "quadrants with a surrounding triangle in front";
constexpr auto kDirect = "quadrants decided by sample";

TEST(Warnock, OneTriangleInOneQuadrantLeavesTheOthersEmpty) {
    const Scene scene =
        SceneBuilder().triangle({-.9, -.9, 0}, {-.1, -.9, 0}, {-.9, -.2, 0}).build();
    Counts counts = counts_of(front_view(scene, 128));
    EXPECT_EQ(counts["quadrants of the first level"], 4u);
    EXPECT_EQ(counts[kSingle], 1u);
    EXPECT_EQ(counts[kEmpty], 3u);
    EXPECT_EQ(counts["triangles classified contained"], 1u);
    EXPECT_EQ(counts["subdivisions"] + counts[kDirect] + counts[kSurrounded], 0u);
}

TEST(Warnock, OneSurroundingTriangleFillsEveryQuadrant) {
    SceneBuilder b;
    add_wall(b, 0);
    Counts counts = counts_of(front_view(b.build(), 128));
    EXPECT_EQ(counts[kSurrounded], 4u);
    EXPECT_EQ(counts["triangles classified surrounding"], 4u);
    EXPECT_EQ(counts[kEmpty] + counts[kSingle] + counts[kInFront] + counts["subdivisions"], 0u);
}

// Each of these walls reaches deeper than the next one begins, so only the corners tell.
TEST(Warnock, CornersTellThatASurroundingTriangleIsInFront) {
    constexpr std::uint64_t kWalls = 24;
    SceneBuilder b;
    for (std::uint64_t k = 0; k < kWalls; ++k) add_wall(b, .01 * static_cast<double>(k), 1);
    Counts counts = counts_of(front_view(b.build(), 128));
    EXPECT_EQ(counts[kInFront], 4u);
    EXPECT_EQ(counts[kHanded], 4 * kWalls);
    EXPECT_EQ(counts["triangles classified surrounding"], 4 * kWalls);  // once each
    EXPECT_EQ(counts["triangles hidden in quadrants"], 4 * (kWalls - 1));
    EXPECT_EQ(counts["subdivisions"] + counts[kDirect], 0u);
}

TEST(Warnock, CoincidentWallsAreNotDividedEither) {
    SceneBuilder b;
    for (int k = 0; k < 5; ++k) add_wall(b, 0, .5);
    Counts counts = counts_of(front_view(b.build(), 128));
    EXPECT_EQ(counts[kInFront], 4u);
    EXPECT_EQ(counts["subdivisions"] + counts[kDirect], 0u);
}

TEST(Warnock, NestedRectanglesCostNoMoreThanTheNearest) {
    Counts alone, nested;
    for (const int walls : {1, 30}) {
        SceneBuilder b;
        for (int k = walls - 1; k >= 0; --k) {  // farthest first
            const double z = -.03 * k;
            b.quad({-1.1, -1.1, z}, {1.1, -1.1, z}, {1.1, 1.1, z}, {-1.1, 1.1, z});
        }
        (walls == 1 ? alone : nested) = counts_of(front_view(b.build(), 256));
    }
    EXPECT_GT(alone[kDirect], 0u);  // along the diagonal
    for (const auto& [name, value] : nested) {
        if (name == kFirst || name == "triangles over samples") continue;
        EXPECT_EQ(value, alone[name]) << name;
    }
    EXPECT_EQ(nested[kFirst], 29u * 2 * 16);  // the boxes of two triangles meet 16 quadrants
}

TEST(Warnock, WhatAWallHidesIsDroppedForGoodAtTheFirstLevel) {
    std::map<int, Counts> counts;
    for (const int count : {200, 2000}) {
        SceneBuilder b;
        add_litter(b, count, -1, -.1);
        b.quad({-1.1, -1.1, 0}, {1.1, -1.1, 0}, {1.1, 1.1, 0}, {-1.1, 1.1, 0});
        counts[count] = counts_of(front_view(b.build(), 256));
        EXPECT_GE(counts[count][kFirst], static_cast<std::uint64_t>(count) * 9 / 10);
    }
    for (const auto name : {kHanded, kDirect, "subdivisions", "depth comparisons"})
        EXPECT_EQ(counts[200][name], counts[2000][name]) << name;
}

// Two planes: what each hides is bounded by the farther one.
TEST(Warnock, AFoldedWallHidesWhatIsBehindBothOfItsSides) {
    SceneBuilder b;
    add_litter(b, 600, -1, .6);
    b.triangle({-1.1, -1.1, 0}, {1.1, -1.1, 0}, {1.1, 1.1, .4});
    b.triangle({-1.1, -1.1, 0}, {1.1, 1.1, .4}, {-1.1, 1.1, -.2});
    const Scene scene = b.build();
    const ScreenScene screen = front_view(scene, 200);
    Counts counts = counts_of(screen);
    EXPECT_GT(counts[kFirst], 100u);
    EXPECT_LT(counts[kFirst], 700u);
    EXPECT_GT(counts["triangles hidden in quadrants"], 0u);
}

TEST(Warnock, DividesOnlyWhereThereIsSomethingBeforeTheWall) {
    SceneBuilder b;
    add_wall(b, 0);
    b.triangle({-.9, -.9, .5}, {-.8, -.9, .5}, {-.9, -.8, .5});
    Counts counts = counts_of(front_view(b.build(), 256));
    EXPECT_EQ(counts["quadrants of the first level"], 16u);
    EXPECT_EQ(counts["subdivisions"], 2u);  // 64 x 64, and 32 x 32 where the triangle lies
    EXPECT_GT(counts[kDirect], 0u);
    EXPECT_EQ(counts[kSurrounded], 15 + 3 + 4 - counts[kDirect]);
}

TEST(Warnock, EqualsBruteForceWithManySamplesAPixel) {
    for (std::uint64_t seed = 0; seed < 24; ++seed) {
        const Scene scene = hostile_scene(seed);
        const Camera camera = hostile_camera(scene, seed, {37, 29});
        const ScreenScene screen = must(project(scene, camera, {Cull::none, 0}));
        Counts four = counts_of(screen, 2), sixteen = counts_of(screen, 4);
        EXPECT_EQ(four["quadrants of the first level"], 2u);
        EXPECT_EQ(sixteen["quadrants of the first level"], 6u);
    }
}

TEST(Warnock, ThreadsDoNotChangeABit) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Scene scene = seed == 0 ? sphere_scene(60, 90) : hostile_scene(seed);
        const Camera camera = hostile_camera(scene, seed, {200, 150});
        const ScreenScene screen = must(project(scene, camera, {Cull::none, 0}));
        std::vector<Visibility> seen;
        std::vector<Counter> counters[3];
        for (const int threads : {1, 2, 8}) {
            ResolveOptions options;
            options.threads = threads;
            options.counters = &counters[seen.size()];
            seen.push_back(run("warnock", screen, options));
        }
        for (const std::size_t k : {1u, 2u}) {
            EXPECT_EQ(count_differences(seen[0], seen[k]), 0u) << seed;
            for (std::size_t c = 0; c < counters[0].size(); ++c)
                EXPECT_EQ(counters[0][c].value, counters[k][c].value) << counters[0][c].name;
        }
    }
}

TEST(Warnock, AnObserverSeesQuadrantsThatTileThePicture) {
    struct Recorder : Observer {
        std::vector<std::uint32_t> owner, times;
        std::uint32_t width = 0;
        std::uint64_t splits = 0;
        void step(const Step& s) override {
            splits += s.kind == StepKind::quadrant_split;
            const bool scanned = s.kind == StepKind::quadrant_scanned;
            if (!scanned && s.kind != StepKind::quadrant_decided) return;
            for (std::uint32_t y = s.y0; y < s.y1; ++y)
                for (std::uint32_t x = s.x0; x < s.x1; ++x) {
                    ++times[y * width + x];
                    if (!scanned) owner[y * width + x] = s.triangle;
                }
        }
    };
    constexpr std::uint32_t kScanned = kNone - 1;
    std::uint64_t splits = 0;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        const Scene scene = hostile_scene(seed);
        const Camera camera = hostile_camera(scene, seed, {100, 80});
        const ScreenScene screen = must(project(scene, camera));
        Recorder recorder;
        recorder.width = 100;
        recorder.owner.assign(100 * 80, kScanned);
        recorder.times.assign(100 * 80, 0);
        ResolveOptions options;
        options.observer = &recorder;
        const Visibility watched = run("warnock", screen, options);
        EXPECT_EQ(count_differences(watched, run("warnock", screen)), 0u);
        for (std::size_t k = 0; k < watched.ids.size(); ++k) {
            ASSERT_EQ(recorder.times[k], 1u) << seed;
            if (recorder.owner[k] == kScanned) continue;
            ASSERT_EQ(recorder.owner[k], watched.ids[k]) << seed;
        }
        splits += recorder.splits;
    }
    EXPECT_GT(splits, 1000u);
}

}  // namespace
}  // namespace sightline
