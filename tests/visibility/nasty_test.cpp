// The scenes made to be nasty, through every exact algorithm, against brute force.
#include "support/nasty.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace sightline {
namespace {

using namespace testing;

// Hundreds of polygons that all cross one another leave a list-priority algorithm half a million
// pieces: seconds a view. One view of them is in every run, all are in make test-full.
bool has_time_for(const Algorithm& algorithm, const NastyScene& nasty,
                  [[maybe_unused]] bool every_run) {
    if (!nasty.entangled || algorithm.space != Space::list_priority) return true;
#ifdef SIGHTLINE_SANITIZED
    return false;
#else
    return every_run || std::getenv("SIGHTLINE_FULL") != nullptr;
#endif
}

void expect_agreement(const NastyScene& nasty, const Camera& camera, std::uint32_t per_axis,
                      bool every_run = false) {
    const ScreenScene screen = must(project(nasty.scene, camera, {Cull::none, 0}));
    ResolveOptions options;
    options.samples_per_axis = per_axis;
    const Visibility truth = run("brute", screen, options);
    std::uint64_t covered = 0;
    for (const std::uint32_t id : truth.ids) covered += id != kNone;
    EXPECT_GT(covered, 100u) << nasty.name;
    for (const Algorithm& algorithm : algorithms()) {
        if (!algorithm.exact || algorithm.exhaustive) continue;
        if (!has_time_for(algorithm, nasty, every_run)) continue;
        const Visibility seen = run(std::string(algorithm.name), screen, options);
        EXPECT_EQ(count_differences(truth, seen), 0u)
            << nasty.name << ", " << algorithm.name << ", " << per_axis << " per axis";
    }
}

TEST(Nasty, EveryExactAlgorithmEqualsBruteForceFromTheFront) {
    for (const NastyScene& nasty : nasty_scenes())
        for (const std::uint32_t per_axis : {1u, 2u})
            expect_agreement(nasty, page_camera(nasty.scene, {64, 64}), per_axis);
}

TEST(Nasty, EveryExactAlgorithmEqualsBruteForceInPerspective) {
    for (const NastyScene& nasty : nasty_scenes()) {
        for (const glm::dvec3 direction : {glm::dvec3(-1, -1, -1), glm::dvec3(0.2, -0.1, 1)}) {
            CameraOptions options;
            options.direction = direction;
            const Camera camera = must(make_camera(options, nasty.scene.bounds, {90, 70}));
            expect_agreement(nasty, camera, 1);
        }
    }
}

// With the eye among the polygons: clipped, and seen from both sides.
TEST(Nasty, EveryExactAlgorithmEqualsBruteForceFromInside) {
    for (const NastyScene& nasty : nasty_scenes()) {
        CameraOptions options;
        options.eye = glm::dvec3(0.03, 0.02, 0.01);
        options.target = glm::dvec3(0.5, 0.4, 0.9);
        options.fov = 100;
        const Camera camera = must(make_camera(options, nasty.scene.bounds, {64, 64}));
        expect_agreement(nasty, camera, 1, true);
    }
}

}  // namespace
}  // namespace sightline
