// Parts joined into paths: nothing is lost, nothing is drawn twice.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <tuple>

#include "vector/drawings.hpp"

namespace {

using namespace sightline;
using sightline::testing::add_part;
using sightline::testing::add_polyline;

using Points = std::vector<glm::dvec2>;

Points points_of(const Paths& paths, std::size_t p) {
    return {paths.points.begin() + paths.first_point[p],
            paths.points.begin() + paths.first_point[p + 1]};
}

/// A stretch as a value that does not know its direction.
using Stretch = std::tuple<double, double, double, double>;
Stretch stretch(glm::dvec2 a, glm::dvec2 b) {
    if (std::tuple(b.x, b.y) < std::tuple(a.x, a.y)) std::swap(a, b);
    return {a.x, a.y, b.x, b.y};
}

/// Checks what holds for all paths: each step is a part of the path's look, and each stretch of the
/// lines is there exactly once.
void expect_sound(const DrawnLines& lines, const Paths& paths) {
    std::set<Stretch> wanted, found;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        wanted.insert(stretch(lines.from[i], lines.to[i]));
    }
    ASSERT_EQ(paths.first_point.size(), paths.size() + 1);
    ASSERT_EQ(paths.first_point.back(), paths.points.size());
    ASSERT_EQ(paths.part.size(), paths.points.size());
    for (std::size_t p = 0; p < paths.size(); ++p) {
        const std::uint32_t last = paths.first_point[p + 1] - 1;
        EXPECT_EQ(paths.part[last], kNone);
        for (std::uint32_t k = paths.first_point[p]; k < last; ++k) {
            const std::uint32_t part = paths.part[k];
            ASSERT_LT(part, lines.size());
            const Stretch step = stretch(paths.points[k], paths.points[k + 1]);
            EXPECT_EQ(step, stretch(lines.from[part], lines.to[part]));
            EXPECT_TRUE(found.insert(step).second) << "drawn twice";
            EXPECT_EQ(paths.kind[p], lines.kind[part]);
            EXPECT_EQ(paths.visible[p], lines.visible[part]);
            EXPECT_EQ(paths.object[p], lines.object[part]);
        }
    }
    EXPECT_EQ(found, wanted);
}

/// The edges of a jittered grid of squares, in any order and direction, some of them twice.
DrawnLines random_net(unsigned seed, int side) {
    std::mt19937 random(seed);
    const auto at = [](int x, int y) { return glm::dvec2(x + y * 0.125, y - x * 0.25); };
    DrawnLines ordered, lines;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const sightline::testing::PartLook look{static_cast<EdgeKind>(random() % 6),
                                                    random() % 2 == 0,
                                                    static_cast<std::uint32_t>(random() % 3)};
            add_part(ordered, at(x, y), at(x + 1, y), look);
            add_part(ordered, at(x, y + 1), at(x, y), look);
            if (random() % 4 == 0) add_part(ordered, at(x + 1, y), at(x, y), look);
        }
    }
    std::vector<std::size_t> order(ordered.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random);
    for (const std::size_t i : order) {
        add_part(lines, ordered.from[i], ordered.to[i],
                 {ordered.kind[i], ordered.visible[i] != 0, ordered.object[i]});
    }
    return lines;
}

/// How far the pen flies between paths.
double flight(const Paths& paths) {
    double sum = 0;
    glm::dvec2 pen(0);
    for (std::size_t p = 0; p < paths.size(); ++p) {
        const glm::dvec2 way = paths.points[paths.first_point[p]] - pen;
        sum += std::sqrt(way.x * way.x + way.y * way.y);
        pen = paths.points[paths.first_point[p + 1] - 1];
    }
    return sum;
}

TEST(Chain, NothingMakesNothing) {
    for (const bool sorted : {false, true}) {
        const Paths paths = chain({}, sorted);
        EXPECT_EQ(paths.size(), 0u);
        EXPECT_EQ(paths.first_point, std::vector<std::uint32_t>{0});
    }
}

TEST(Chain, AScatteredPolylineIsOnePath) {
    DrawnLines lines;
    add_part(lines, {2, 0}, {3, 1});
    add_part(lines, {1, 0}, {0, 0});
    add_part(lines, {1, 0}, {2, 0});
    const Paths paths = chain(lines, false);
    ASSERT_EQ(paths.size(), 1u);
    expect_sound(lines, paths);
}

TEST(Chain, AClosedLoopEndsWhereItBegins) {
    DrawnLines lines;
    add_polyline(lines, {{0, 0}, {1, 0}, {1, 1}, {-0.0, 1}, {-0.0, -0.0}});
    const Paths paths = chain(lines, false);
    ASSERT_EQ(paths.size(), 1u);
    EXPECT_EQ(points_of(paths, 0), (Points{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}}));
}

TEST(Chain, GoesStraightOnAtJunctions) {
    DrawnLines lines;
    add_polyline(lines, {{-1, 0}, {0, 0}, {0, 1}});  // a corner...
    add_polyline(lines, {{1, 0}, {0, 0}, {0, -1}});  // ... and another one make a cross
    const Paths paths = chain(lines, false);
    ASSERT_EQ(paths.size(), 2u);
    EXPECT_EQ(points_of(paths, 0), (Points{{-1, 0}, {0, 0}, {1, 0}}));
    EXPECT_EQ(points_of(paths, 1), (Points{{0, 1}, {0, 0}, {0, -1}}));
}

TEST(Chain, BranchesTakeAsFewPathsAsTheyNeed) {
    DrawnLines lines;  // three arms: four odd vertices, two paths
    for (const glm::dvec2 end : {glm::dvec2(1, 0), glm::dvec2(-1, 0.25), glm::dvec2(0, 1)}) {
        add_part(lines, {0, 0}, end);
    }
    const Paths paths = chain(lines, false);
    EXPECT_EQ(paths.size(), 2u);
    expect_sound(lines, paths);
}

TEST(Chain, OfPartsThatStandTwiceTheVisibleAndLowerOneStays) {
    DrawnLines lines;
    add_part(lines, {0, 0}, {1, 0}, {EdgeKind::silhouette, false});
    add_part(lines, {1, 0}, {0, 0}, {EdgeKind::mesh, true});
    add_part(lines, {0, 0}, {1, 0}, {EdgeKind::crease, true});
    add_part(lines, {1, 0}, {0, 0}, {EdgeKind::crease, true});
    const Paths paths = chain(lines, false);
    ASSERT_EQ(paths.size(), 1u);
    EXPECT_EQ(paths.part, (std::vector<std::uint32_t>{2, kNone}));
}

TEST(Chain, OrderIsHiddenFirstThenKindThenObject) {
    DrawnLines lines;
    double y = 0;
    for (const bool visible : {true, false}) {
        for (const EdgeKind kind : {EdgeKind::mesh, EdgeKind::silhouette}) {
            for (const std::uint32_t object : {0xFFFFFFFEu, 3u}) {
                add_part(lines, {0, y}, {1, y}, {kind, visible, object});
                y += 1;
            }
        }
    }
    for (const bool sorted : {false, true}) {
        const Paths paths = chain(lines, sorted);
        ASSERT_EQ(paths.size(), 8u);
        for (std::size_t p = 1; p < paths.size(); ++p) {
            const auto key = [&](std::size_t i) {
                return std::tuple(paths.visible[i], paths.kind[i], sorted ? 0 : paths.object[i]);
            };
            EXPECT_LE(key(p - 1), key(p));
        }
    }
}

TEST(Chain, NothingIsLostInRandomNets) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        const DrawnLines lines = random_net(seed, 12);
        expect_sound(lines, chain(lines, false));
        expect_sound(lines, chain(lines, true));
    }
}

TEST(Chain, AFanOfManyPartsIsNotQuadratic) {
    DrawnLines lines;
    constexpr int kArms = 200'001;
    for (int i = 0; i < kArms; ++i) add_part(lines, {0, 0}, {1 + i % 447, i / 447 + 1});
    const Paths paths = chain(lines, false);
    EXPECT_EQ(paths.size(), (kArms + 1) / 2u);
}

TEST(Chain, SortedPathsKeepThePenDown) {
    const DrawnLines lines = random_net(5, 40);
    const Paths plain = chain(lines, false), sorted = chain(lines, true);
    EXPECT_EQ(plain.size(), sorted.size());
    EXPECT_LT(flight(sorted), 0.5 * flight(plain));
}

TEST(Chain, TheSameLinesGiveTheSamePaths) {
    const DrawnLines lines = random_net(6, 30);
    for (const bool sorted : {false, true}) {
        const Paths a = chain(lines, sorted), b = chain(lines, sorted);
        EXPECT_EQ(a.points, b.points);
        EXPECT_EQ(a.part, b.part);
        EXPECT_EQ(a.first_point, b.first_point);
    }
}

}  // namespace
