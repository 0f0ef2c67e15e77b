// What moves is put on top of a tree that does not know it: the picture is that of a tree which
// holds everything.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sightline/bsp.hpp"
#include "support/bsp_differences.hpp"

namespace sightline {
namespace {

using namespace testing;

/// Both pictures are explained, and so is what is different between them.
void expect_explained(const ScreenScene& screen, const BspTree& tree) {
    ResolveOptions options;
    options.threads = 1;
    const Visibility truth = run("zbuffer", screen, options), whole = run("bsp", screen, options);
    options.tree = &tree;
    const Visibility moved = run("bsp", screen, options);
    const DifferenceJudge judge(screen);
    const Differences from_truth = judge.compare(truth, moved);
    const Differences from_whole = judge.compare(whole, moved);
    EXPECT_EQ(from_truth.unexplained, 0u) << from_truth.first;
    EXPECT_EQ(from_whole.unexplained, 0u) << from_whole.first;
}

TEST(BspMoving, AnyPartOfAHostileSceneMayBeLeftOut) {
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = hostile_scene(seed);
        Random random(seed);
        std::vector<std::uint8_t> moving(scene.triangles.size());
        const double share = random.uniform(0, 1);
        for (std::uint8_t& mark : moving) mark = random.chance(share);
        const BspTree tree = must(build_bsp(scene, {1, moving}));
        EXPECT_LE(tree.stats().triangles + tree.stats().left_out, scene.triangles.size());
        expect_explained(must(project(scene, hostile_camera(scene, seed, {56, 48}))), tree);
        if (HasFailure()) return;
    }
}

/// A cross of two plates on its way through a field of boxes.
Scene scene_at(double way) {
    SceneBuilder b;
    for (int i = -2; i <= 2; ++i)
        for (int j = -2; j <= 2; ++j) {
            const glm::dvec3 p(0.4 * i, -0.5, 0.4 * j);
            b.box(p - 0.1, p + glm::dvec3(0.1, 0.2 + 0.1 * i, 0.1));
        }
    const double c = std::cos(way), s = std::sin(way);
    const auto at = [&](double x, double y, double z) {
        return glm::dvec3(-1.5 + way + c * x - s * z, -0.3 + y, s * x + c * z);
    };
    b.quad(at(-.3, -.3, 0), at(.3, -.3, 0), at(.3, .3, 0), at(-.3, .3, 0));
    b.quad(at(0, -.3, -.3), at(0, -.3, .3), at(0, .3, .3), at(0, .3, -.3));
    return b.build();
}

TEST(BspMoving, OneTreeServesAllPlacesOfWhatMoves) {
    Scene scene = scene_at(0);
    std::vector<std::uint8_t> moving(scene.triangles.size());
    std::fill(moving.end() - 4, moving.end(), std::uint8_t{1});
    const BspTree tree = must(build_bsp(scene, {0, moving}));
    EXPECT_EQ(tree.stats().left_out, 4u);
    for (int step = 0; step < 12; ++step) {
        scene = scene_at(0.27 * step);
        ASSERT_TRUE(tree.fits(scene));
        for (const Projection projection : {Projection::perspective, Projection::cabinet}) {
            CameraOptions camera;
            camera.direction = glm::dvec3(-1 + 0.2 * step, -1, -0.7);
            camera.projection = projection;
            std::vector<Counter> counters;
            const ScreenScene screen =
                must(project(scene, must(make_camera(camera, scene.bounds, {160, 120}))));
            expect_explained(screen, tree);
            ResolveOptions options;
            options.tree = &tree;
            options.counters = &counters;
            (void)run("bsp", screen, options);
            const auto parts = std::ranges::find(counters, "pieces that moved", &Counter::name);
            ASSERT_NE(parts, counters.end());
            EXPECT_GT(parts->value, 4u);  // the two plates cross, if nothing else
        }
    }
}

TEST(BspMoving, EverythingMayMove) {
    const Scene scene = hostile_scene(3);
    const std::vector<std::uint8_t> moving(scene.triangles.size(), 1);
    const BspTree tree = must(build_bsp(scene, {0, moving}));
    EXPECT_EQ(tree.stats().nodes, 0u);
    expect_explained(must(project(scene, hostile_camera(scene, 3, {56, 48}))), tree);
}

}  // namespace
}  // namespace sightline
