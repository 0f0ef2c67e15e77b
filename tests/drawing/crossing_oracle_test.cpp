// Curves of intersection against their definition (crossing_definition.hpp): no pair is missing,
// none is drawn that the definition lacks.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <utility>

#include "drawing/crossing_definition.hpp"
#include "drawing/intersections.hpp"
#include "drawing/pages.hpp"
#include "drawing/surfaces.hpp"

namespace sightline {
namespace {

using namespace testing;
using namespace testing::crossing_definition;
struct Score {
    std::uint64_t crossings = 0, along_edges = 0, exact_ends = 0, moved_ends = 0;
};

/// In steps; halves of steps come from rounding.
double apart(const ScreenPoint& s, const Point& p) {
    return std::max(std::abs(rounded(p.x - s.x)), std::abs(rounded(p.y - s.y)));
}

/// Ends that are rounded once lie within half a step, in depth as well.
void judge_ends(const Crossing& c, const Expected& e, Score& score) {
    for (const int k : {0, 1}) {
        const ScreenPoint& s = k == 0 ? c.p : c.q;
        const bool exact =
            apart(s, k == 0 ? e.stretch.p : e.stretch.q) <= .5 &&
            (!e.depths || std::abs(rounded((*e.depths)[static_cast<std::size_t>(k)] - s.z)) <= .5);
        ++(exact ? score.exact_ends : score.moved_ends);
    }
}

void judge(const ScreenScene& page, Score& score) {
    const Occluders occluders(page, TraceMethod::fast, 1);
    const std::function<bool(double)> nobody;
    WorkMeter meter(nobody);
    Definition definition(page);
    for (Crossing c : find_crossings(occluders, 1, meter)) {
        Expected* best = nullptr;
        double least = kJoined + 1;
        bool turned = false;
        for (Expected& e : definition.expected()) {
            if (e.drawn || e.faces != c.faces) continue;
            for (const bool turn : {false, true}) {
                const double away = std::max(apart(turn ? c.q : c.p, e.stretch.p),
                                             apart(turn ? c.p : c.q, e.stretch.q));
                if (away > least || (away == least && best != nullptr)) continue;
                best = &e;
                least = away;
                turned = turn;
            }
        }
        const bool found = best != nullptr;
        if (turned) std::swap(c.p, c.q);
        if (found) {
            best->drawn = true;
            ++(best->depths ? score.crossings : score.along_edges);
            judge_ends(c, *best, score);
        }
        ASSERT_TRUE(found) << "invented: faces " << c.faces[0] << ", " << c.faces[1] << " from "
                           << c.p.x << ", " << c.p.y << " to " << c.q.x << ", " << c.q.y;
    }
    for (const Expected& e : definition.expected())
        ASSERT_TRUE(e.drawn || e.stretch.length() <= kJoined)
            << "missing: faces " << e.faces[0] << ", " << e.faces[1] << ", " << e.stretch.length()
            << " steps";
}

/// Points of a plane and of few places, so that corners and edges lie in other faces' planes, on
/// one another and on one line, and faces are coplanar; some slivers, some hardly apart.
Scene entangled_scene(std::uint64_t seed) {
    Random random(seed);
    const TurnedFrame frame(random);
    const double lift = random.chance(.3) ? std::pow(10, random.uniform(-5, -2)) : 1;
    const auto point = [&] {
        const auto coarse = [&] { return .25 * static_cast<int>(random.below(9)) - 1; };
        const bool fine = random.chance(.4);
        const double x = fine ? random.uniform(-1, 1) : coarse();
        const double y = fine ? random.uniform(-1, 1) : coarse();
        const double z = random.chance(.45) ? 0 : fine ? random.uniform(-1, 1) : coarse();
        return frame.at(x, y, lift * z);
    };
    SceneBuilder b;
    const std::uint32_t count = 8 + random.below(8);
    for (std::uint32_t k = 0; k < count; ++k) {
        const glm::dvec3 p = point(), q = point(), r = point();
        if (glm::length(glm::cross(q - p, r - p)) < 1e-9) continue;
        b.triangle(p, q, r);
        // A neighbour, so that surfaces go on.
        const glm::dvec3 s = point();
        if (random.chance(.3)) {  // through the plane, along an edge
            const glm::dvec3 e = frame.at(random.uniform(-1, 1), random.uniform(-1, 1), 0);
            const glm::dvec3 f = frame.at(random.uniform(-1, 1), random.uniform(-1, 1), 0);
            b.triangle(e, f, frame.at(random.uniform(-1, 1), random.uniform(-1, 1), .5));
            b.triangle(f, e, frame.at(random.uniform(-1, 1), random.uniform(-1, 1), -.5));
        }
        if (random.chance(.7) && glm::length(glm::cross(q - p, s - p)) > 1e-9) b.triangle(q, p, s);
    }
    return b.build();
}

TEST(CrossingOracle, EveryPairIsAsTheDefinitionSays) {
    Score score;
    const std::uint64_t count = amount(1500, 25, 5);
    for (std::uint64_t seed = 0; seed < count; ++seed) {
        const Scene scene = entangled_scene(seed);
        ASSERT_NO_FATAL_FAILURE(judge(page(scene, random_view(scene, seed, {400, 300})), score))
            << "seed " << seed;
    }
    std::cout << score.crossings << " pairs cross, " << score.along_edges << " along edges; "
              << score.exact_ends << " ends rounded once, " << score.moved_ends << " joined\n";
    EXPECT_GT(score.crossings, 8 * count);
    EXPECT_GT(score.along_edges, count);
    EXPECT_LT(score.moved_ends, score.exact_ends / 10);
}

TEST(CrossingOracle, SurfacesOverOneGridCrossAsTheDefinitionSays) {
    Score score;
    for (std::uint64_t seed = 0; seed < amount(30, 1, 1); ++seed) {
        for (const int kind : {0, 4}) {
            const Scene scene = surface_pair(kind, seed).builder.build();
            ASSERT_NO_FATAL_FAILURE(judge(page(scene, random_view(scene, seed, {400, 300})), score))
                << "kind " << kind << " seed " << seed;
        }
    }
    EXPECT_GT(score.crossings, 100u);
}

TEST(CrossingOracle, ClippedSurfacesCrossAsTheDefinitionSays) {
    Score score;
    for (std::uint64_t seed = 0; seed < amount(500, 8, 3); ++seed) {
        const Scene scene = entangled_scene(seed);
        Random random(seed);
        CameraOptions options;
        options.eye = random.point(.5);
        options.target = random.point(.5);
        options.fov = random.uniform(20, 120);
        options.near_plane = .05;
        options.far_plane = 3;
        const Camera camera = must(make_camera(options, scene.bounds, {400, 300}));
        ASSERT_NO_FATAL_FAILURE(judge(page(scene, camera), score)) << "seed " << seed;
    }
    EXPECT_GT(score.crossings, 100u);
}

}  // namespace
}  // namespace sightline
