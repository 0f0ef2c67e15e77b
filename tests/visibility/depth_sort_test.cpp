// Depth sort and the painter: cycles, rings and combs, what is split and what is not, and the order
// that is handed out.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "support/nasty.hpp"
#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

using CountsByName = std::map<std::string, std::uint64_t>;

ScreenScene page_of(const Scene& scene, std::uint32_t pixels = 120) {
    return must(project(scene, page_camera(scene, {pixels, pixels}), {Cull::none, 0}));
}

// The answer is that of brute force; returns what was counted on the way.
CountsByName sort(const ScreenScene& screen, std::uint32_t per_axis = 1) {
    std::vector<Counter> counters;
    ResolveOptions options;
    options.samples_per_axis = per_axis;
    const Visibility truth = run("brute", screen, options);
    options.counters = &counters;
    EXPECT_EQ(count_differences(truth, run("depth-sort", screen, options)), 0u);
    CountsByName counts;
    for (const Counter& c : counters) counts[c.name] += c.value;
    return counts;
}

glm::dvec3 around(double turn, double radius, double z) {
    const double angle = 2 * std::numbers::pi * turn;
    return {radius * std::cos(angle), radius * std::sin(angle), z};
}

// n beams around the centre; each lies over the next one where they meet, and no two cross.
Scene cycle(int n) {
    SceneBuilder b;
    for (int k = 0; k < n; ++k) {
        const double turn = static_cast<double>(k) / n, next = turn + 1.6 / n;
        b.quad(around(turn, 0.6, -0.2), around(turn, 0.9, -0.2), around(next, 0.9, 0.2),
               around(next, 0.6, 0.2));
    }
    return b.build();
}

TEST(DepthSort, CyclesOfThreeFourAndAHundredAreCut) {
    for (const int n : {3, 4, 100}) {
        for (const std::uint32_t per_axis : {1u, 2u}) {
            const CountsByName counts = sort(page_of(cycle(n)), per_axis);
            EXPECT_GE(counts.at("cycles"), 1u) << n;
            EXPECT_GE(counts.at("splits"), 1u) << n;
            // A cycle is cut open once; two triangles a quad make it a few times.
            EXPECT_LE(counts.at("splits"), 12u + static_cast<std::uint64_t>(n) / 4) << n;
        }
    }
}

// Flat rings, each through the hole of the next one.
TEST(DepthSort, InterlockedRings) {
    SceneBuilder b;
    constexpr int kSides = 24;
    for (int ring = 0; ring < 3; ++ring) {
        const glm::dvec3 centre{0.5 * ring - 0.5, 0.05 * ring, 0};
        const double tilt = ring % 2 == 0 ? 0.5 : -0.5;
        const auto at = [&](int k, double radius) {
            const glm::dvec3 p = around(static_cast<double>(k) / kSides, radius, 0);
            return centre + glm::dvec3{p.x, p.y, tilt * p.x + 0.3 * p.y * (ring + 1)};
        };
        for (int k = 0; k < kSides; ++k)
            b.quad(at(k, 0.3), at(k, 0.45), at(k + 1, 0.45), at(k + 1, 0.3));
    }
    EXPECT_GE(sort(page_of(b.build()), 2).at("splits"), 2u);
}

TEST(DepthSort, PiercingCombs) {
    for (const NastyScene& nasty : nasty_scenes()) {
        if (nasty.name != "penetrating combs") continue;
        const CountsByName counts = sort(page_of(nasty.scene));
        EXPECT_GE(counts.at("splits"), 50u);
        EXPECT_EQ(counts.at("cycles"), 0u);
    }
}

// A closed surface has folds all along its outline, where faces touch but do not cross: hardly
// anything is split. (Faces may cross by a unit of the screen once they are snapped.)
TEST(DepthSort, FoldsAreNoConflict) {
    const Scene sphere = sphere_scene(24, 48);
    const CountsByName counts = sort(page_of(sphere, 200));
    EXPECT_LT(counts.at("splits"), counts.at("polygons sorted") / 50);
    EXPECT_GT(counts.at("polygons sorted"), 2000u);
}

// Stacked sheets in the worst order for the farthest point: a far corner lies on the nearest one.
TEST(DepthSort, ExchangesWhatThePainterGetsWrong) {
    SceneBuilder b;
    b.quad({-0.9, -0.9, -0.5}, {0.9, -0.9, -0.5}, {0.9, 0.9, -0.5}, {-0.9, 0.9, -0.5});
    // Everywhere before the wall but in its own corner, which reaches behind it beside the wall.
    b.quad({-0.8, -0.3, 0.6}, {2.5, -0.3, -1.2}, {2.5, 0.3, -1.2}, {-0.8, 0.3, 0.6});
    const Scene scene = b.build();
    const ScreenScene screen = page_of(scene);
    const CountsByName counts = sort(screen);
    EXPECT_GE(counts.at("exchanges"), 1u);
    EXPECT_EQ(counts.at("splits"), 0u);
    EXPECT_GT(count_differences(run("brute", screen), run("painter", screen)), 500u);
}

// Where no polygon overlaps another one in z, sorting by the farthest point is all that it takes.
TEST(Painter, IsRightWhereDepthsDoNotOverlap) {
    SceneBuilder b;
    Random random(3);
    for (int k = 0; k < 60; ++k) {
        const auto corner = [&] {
            return glm::dvec3{random.uniform(-1, 1), random.uniform(-1, 1),
                              0.03 * k - 0.9 + random.uniform(0, 0.02)};
        };
        const glm::dvec3 p = corner(), q = corner();
        b.triangle(p, q, corner());
    }
    const Scene scene = b.build();
    const ScreenScene screen = page_of(scene);
    EXPECT_EQ(count_differences(run("brute", screen), run("painter", screen)), 0u);
    EXPECT_FALSE(find_algorithm("painter")->exact);
}

// Coplanar faces: whatever their order in the file, the lower id is painted last, without a split.
TEST(DepthSort, CoplanarFacesTieByNumber) {
    SceneBuilder b;
    Random random(5);
    for (int k = 0; k < 40; ++k) {
        const double x = random.uniform(-1, 0.5), y = random.uniform(-1, 0.5);
        const auto lift = [](double px, double py) { return 0.3 * px - 0.2 * py; };
        const double s = 0.5;
        b.quad({x, y, lift(x, y)}, {x + s, y, lift(x + s, y)}, {x + s, y + s, lift(x + s, y + s)},
               {x, y + s, lift(x, y + s)});
    }
    EXPECT_EQ(sort(page_of(b.build())).at("splits"), 0u);
}

// The work of real meshes is about linear, and hardly anything is split.
TEST(DepthSort, PairsGrowWithTheMesh) {
    const auto pairs = [](std::uint32_t rings) {
        return static_cast<double>(
            sort(page_of(sphere_scene(rings, 2 * rings), 60)).at("pairs with overlapping extents"));
    };
    EXPECT_LT(pairs(48) / pairs(24), 6.0);  // four times the triangles
}

}  // namespace
}  // namespace sightline
