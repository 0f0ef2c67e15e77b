// Sheets: what is coplanar in the world shares a plane on the screen, and nothing else does.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <span>

#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

struct Wall {
    glm::dvec3 origin, u, v;
    [[nodiscard]] glm::dvec3 at(double s, double t, bool as_float) const {
        const glm::dvec3 p = origin + s * u + t * v;
        return as_float ? glm::dvec3(glm::vec3(p)) : p;
    }
};

Wall random_wall(Random& random) {
    const glm::dvec3 u = glm::normalize(random.point() + glm::dvec3{2e-3, 0, 0});
    const glm::dvec3 n = glm::normalize(glm::cross(u, random.point() + glm::dvec3{0, 2e-3, 1e-3}));
    return {random.point(), u, glm::cross(n, u)};
}

// A decal before its wall in the file wins everywhere, one behind it nowhere, under every view:
// coordinates as doubles, and rounded to floats as files have them.
TEST(Sheets, DecalsNeverFightWithTheirWalls) {
    Random random(5);
    std::uint64_t decal_samples = 0;
    for (int round = 0; round < 60; ++round) {
        const bool as_float = round % 2 == 1, decal_first = round % 4 < 2;
        const Wall wall = random_wall(random);
        const auto at = [&](double s, double t) { return wall.at(s, t, as_float); };
        SceneBuilder b;
        const auto add_wall = [&] { b.quad(at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)); };
        const auto add_decal = [&] {
            b.quad(at(-.31, -.43), at(.52, -.39), at(.47, .28), at(-.36, .33));
        };
        if (decal_first) add_decal();
        add_wall();
        if (!decal_first) add_decal();
        const Scene scene = b.build();
        ASSERT_EQ(scene.sheets.count(), 1u) << round;
        ASSERT_EQ(scene.sheets.members.size(), 4u) << round;
        const Camera camera =
            hostile_camera(scene, static_cast<std::uint64_t>(round) + 1000, {160, 120});
        const ScreenScene screen = must(project(scene, camera, {Cull::none, 1}));
        // Alone, the decal shows which samples are its own.
        Scene alone = scene;
        const std::uint32_t first = decal_first ? 0 : 2;
        alone.degenerate.assign(4, 1);
        alone.degenerate[first] = alone.degenerate[first + 1] = 0;
        const Visibility decal = run("zbuffer", must(project(alone, camera, {Cull::none, 1})));
        const Visibility both = run("zbuffer", screen);
        for (std::size_t i = 0; i < both.ids.size(); ++i) {
            if (decal.ids[i] == kNone) continue;
            ++decal_samples;
            ASSERT_LT(both.ids[i], 2u) << "round " << round << ": the lower ids own every tie";
        }
    }
    EXPECT_GT(decal_samples, 10000u);
}

TEST(Sheets, ASphereHasOnlyTheSheetsOfItsQuads) {
    const Scene scene = sphere_scene(100, 150);
    for (std::size_t s = 0; s < scene.sheets.count(); ++s)
        EXPECT_LE(scene.sheets.first[s + 1] - scene.sheets.first[s], 2u);
}

TEST(Sheets, ABoxHasSixAndTouchingBoxesShareTheirWall) {
    EXPECT_EQ(SceneBuilder().box({0, 0, 0}, {1, 1, 1}).build().sheets.count(), 6u);
    const Scene two = SceneBuilder().box({0, 0, 0}, {1, 1, 1}).box({1, 0, 0}, {2, 1, 1}).build();
    // x = 0, 1 (both), 2, and four sides that run through.
    EXPECT_EQ(two.sheets.count(), 7u);
    EXPECT_EQ(two.sheets.members.size(), 24u);
}

TEST(Sheets, ParallelWallsApartAreApart) {
    for (const double gap : {1e-5, 1e-4, 1e-2}) {
        const Scene scene = SceneBuilder()
                                .quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0})
                                .quad({0, 0, gap}, {1, 0, gap}, {1, 1, gap}, {0, 1, gap})
                                .build();
        EXPECT_EQ(scene.sheets.count(), 2u) << gap;
    }
}

TEST(Sheets, AreNumberedInTheOrderOfTheirFirstTriangles) {
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        const Sheets sheets = hostile_scene(seed).sheets;
        for (std::size_t s = 0; s < sheets.count(); ++s) {
            const std::span<const std::uint32_t> members(sheets.members.data() + sheets.first[s],
                                                         sheets.first[s + 1] - sheets.first[s]);
            ASSERT_GE(members.size(), 2u);
            ASSERT_TRUE(std::is_sorted(members.begin(), members.end())) << seed;
            for (const std::uint32_t t : members) ASSERT_EQ(sheets.of(t), s) << seed;
            if (s == 0) continue;
            ASSERT_LT(sheets.members[sheets.first[s - 1]], members[0]) << seed;
        }
    }
}

TEST(Sheets, DoNotDependOnTheOrderOfTriangles) {
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        const Scene scene = hostile_scene(seed);
        std::vector<std::uint32_t> order;
        const Scene other = shuffled(scene, seed + 9, order);
        ASSERT_EQ(scene.sheets.count(), other.sheets.count()) << seed;
        for (std::uint32_t a = 0; a < order.size(); ++a)
            for (std::uint32_t b = 0; b < a; ++b) {
                const bool together =
                    other.sheets.of(a) != kNone && other.sheets.of(a) == other.sheets.of(b);
                const bool before = scene.sheets.of(order[a]) != kNone &&
                                    scene.sheets.of(order[a]) == scene.sheets.of(order[b]);
                ASSERT_EQ(together, before) << seed;
            }
    }
}

}  // namespace
}  // namespace sightline
