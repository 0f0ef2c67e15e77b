// Real meshes: every exact algorithm equals brute force from many directions.
#include "support/models.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

#ifdef SIGHTLINE_SANITIZED
constexpr int kDirections = 2;
#else
constexpr int kDirections = 20;
#endif

// Points spread evenly over the sphere (a Fibonacci lattice).
glm::dvec3 direction(int k) {
    const double golden = std::acos(-1.0) * (3 - std::sqrt(5.0));
    const double y = 1 - 2 * (k + 0.5) / kDirections, r = std::sqrt(1 - y * y);
    return {r * std::cos(golden * k), y, r * std::sin(golden * k)};
}

void expect_agreement(const Scene& scene, const std::string& name) {
    for (const Projection projection : {Projection::perspective, Projection::orthographic})
        for (int k = 0; k < kDirections; ++k) {
            CameraOptions options;
            options.direction = direction(k);
            options.projection = projection;
            const Camera camera = must(make_camera(options, scene.bounds, {320, 240}));
            const ScreenScene screen = must(project(scene, camera));
            const Visibility truth = run("brute", screen);
            for (const Algorithm& algorithm : algorithms()) {
                if (!algorithm.exact || algorithm.exhaustive) continue;
                const Visibility seen = run(std::string(algorithm.name), screen);
                ASSERT_EQ(count_differences(truth, seen), 0u)
                    << name << " direction " << k << ", " << algorithm.name;
            }
        }
}

class RealModel : public ::testing::TestWithParam<const char*> {};

TEST_P(RealModel, EveryExactAlgorithmEqualsBruteForce) {
    const std::optional<Scene> scene = real_model(GetParam());
    if (!scene)
        GTEST_SKIP() << models_folder() / GetParam() << " is not there; set SIGHTLINE_MODELS";
    expect_agreement(*scene, GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, RealModel, ::testing::Values("teapot.obj", "cow.obj", "fandisk.obj"));

TEST(Model, EveryExactAlgorithmEqualsBruteForceOnASphere) {
    expect_agreement(sphere_scene(40, 60), "sphere");
}

}  // namespace
}  // namespace sightline
