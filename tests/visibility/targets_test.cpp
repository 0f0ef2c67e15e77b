// Every vector width that this machine has gives the same bits.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstring>

#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

TEST(Targets, EveryVectorWidthGivesTheSameBits) {
    const std::int64_t all = hwy::SupportedTargets();
    int tried = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        const Scene scene = seed == 0 ? sphere_scene(80, 120) : hostile_scene(seed);
        // Rows of whole vectors are written in another way.
        const Resolution resolution = seed % 2 == 0 ? Resolution{150, 110} : Resolution{192, 132};
        const Camera camera = hostile_camera(scene, seed, resolution);
        Visibility first;
        std::vector<ScreenPoint> first_points;
        tried = 0;
        for (std::int64_t rest = all; rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            hwy::GetChosenTarget().Update(hwy::SupportedTargets());
            const ScreenScene screen = must(project(scene, camera, {Cull::none, 1}));
            const Visibility seen = run("zbuffer", screen);
            const std::vector<ScreenPoint> points(screen.points().begin(), screen.points().end());
            if (tried++ == 0) {
                first = seen;
                first_points = points;
            }
            EXPECT_EQ(count_differences(first, seen), 0u) << seed;
            EXPECT_TRUE(first_points == points) << seed;
        }
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    RecordProperty("targets", tried);
    EXPECT_GE(tried, 1);
}

}  // namespace
}  // namespace sightline
