// Every vector width that this machine has gives the same bits.
#include "support/targets.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

TEST(Targets, EveryVectorWidthGivesTheSameBits) {
    const std::vector<std::int64_t> targets = vector_targets();
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        const Scene scene = seed == 0 ? sphere_scene(80, 120) : hostile_scene(seed);
        // Rows of whole vectors are written in another way.
        const Resolution resolution = seed % 2 == 0 ? Resolution{150, 110} : Resolution{192, 132};
        const Camera camera = hostile_camera(scene, seed, resolution);
        Visibility first;
        std::vector<ScreenPoint> first_points;
        for (const std::int64_t target : targets) {
            const ForcedTarget forced(target);
            const ScreenScene screen = must(project(scene, camera, {Cull::none, 1}));
            const Visibility seen = run("zbuffer", screen);
            const std::vector<ScreenPoint> points(screen.points().begin(), screen.points().end());
            if (target == targets.front()) {
                first = seen;
                first_points = points;
            }
            EXPECT_EQ(count_differences(first, seen), 0u) << seed;
            EXPECT_TRUE(first_points == points) << seed;
        }
    }
    RecordProperty("targets", static_cast<int>(targets.size()));
    EXPECT_GE(targets.size(), 1u);
}

// Samples that differ from brute force, over all targets, for the two that draw tiny triangles.
std::uint64_t strays(const Scene& scene, const Camera& camera, ProjectOptions options) {
    options.threads = 1;
    std::uint64_t differ = 0;
    for (const std::int64_t target : vector_targets()) {
        const ForcedTarget forced(target);
        const ScreenScene screen = must(project(scene, camera, options));
        const Visibility truth = run("brute", screen);
        for (const char* algorithm : {"zbuffer", "abuffer"})
            differ += count_differences(truth, run(algorithm, screen));
    }
    return differ;
}

// Tiny triangles wait for a vector of them. In the last one, lanes were left with the clipped
// triangles beside them, whose places are no numbers, and these painted samples.
TEST(Targets, ClippedTrianglesBesideTinyOnesPaintNothing) {
    const glm::dvec3 p[] = {
        {-0.13367996, -0.30838684, 0.590272736},    {-0.107069358, -0.34597453, 0.639048154},
        {-0.0538603419, -0.362003035, 0.874445451}, {-0.0272497398, -0.399590725, 0.923220869},
        {0.0259592766, -0.41561923, 1.15861817},    {-0.24006143, -0.453770457, -0.294061244}};
    SceneBuilder b;
    b.triangle(p[5], p[0], p[1]).triangle(p[1], p[2], p[3]);
    b.triangle(p[3], p[4], p[5]).triangle(p[5], p[1], p[3]);
    const Scene scene = b.build();
    CameraOptions options;
    options.eye = glm::dvec3(-1.15741, 0.49511, -0.407765);
    options.target = glm::dvec3(-0.691993, 1.08812, 0.64682);
    options.fov = 150;
    options.near_plane = 0.00029653935676973221;
    options.far_plane = 2.9653935676973218;
    const Camera camera = must(make_camera(options, scene.bounds, {128, 96}));
    EXPECT_EQ(strays(scene, camera, {Cull::none, 1}), 0u);
}

// The same for any number of them, in any order, with any triangles beside them: specks before the
// eye, and walls of which it sees a part from within.
TEST(Targets, TinyTrianglesAmongOthersEqualBruteForce) {
    std::uint64_t clipped = 0;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        Random random(seed);
        SceneBuilder b;
        const std::uint32_t n = 1 + random.below(40);
        for (std::uint32_t k = 0; k < n; ++k) {
            const bool speck = random.chance(0.5);
            const double size = speck ? std::pow(10.0, random.uniform(-4, -1.5)) : 2.0;
            const glm::dvec3 p = random.point();
            const glm::dvec3 q = p + size * random.point(), r = p + size * random.point();
            b.triangle(p, q, r);
        }
        const Scene scene = b.build();
        CameraOptions options;
        options.eye = random.point(0.5);
        options.target = random.point();
        options.fov = random.uniform(30, 170);
        const Camera camera = must(make_camera(options, scene.bounds, {40, 30}));
        clipped += must(project(scene, camera, {Cull::none, 1})).counts().clipped;
        EXPECT_EQ(strays(scene, camera, {Cull::none, 1}), 0u) << seed;
    }
    EXPECT_GT(clipped, 1000u);
}

// On a page samples lie so far apart that a triangle with few of them is not small: its edge
// functions need more than 32 bits.
TEST(Targets, TrianglesWithFewSamplesOnAPageEqualBruteForce) {
    const Scene scene = sphere_scene(30, 40);
    for (const Resolution resolution : {Resolution{24, 18}, Resolution{100, 75}}) {
        const Camera camera = must(make_camera({}, scene.bounds, resolution));
        ProjectOptions options;
        options.page = true;
        EXPECT_EQ(strays(scene, camera, options), 0u) << resolution.width;
    }
}

}  // namespace
}  // namespace sightline
