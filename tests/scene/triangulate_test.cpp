#include "scene/load/triangulate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <random>
#include <set>

#include "math/newell.hpp"
#include "scene/load/polygon_edges.hpp"
#include "support/polygons.hpp"

namespace sightline::load {
namespace {

using Polygon = std::vector<glm::dvec3>;
using Shape = Triangulator::Shape;

struct Triangulated {
    Shape shape;
    std::vector<PolygonTriangle> triangles;
};

Triangulated triangulate(const Polygon& polygon) {
    Triangulated result;
    result.shape = Triangulator().triangulate(polygon, result.triangles);
    return result;
}

Polygon flat(const std::vector<glm::dvec2>& points) {
    Polygon polygon;
    for (const glm::dvec2& p : points) polygon.emplace_back(p.x, p.y, 0.0);
    return polygon;
}

glm::dvec3 unit_normal(const Polygon& polygon) {
    const glm::dvec3 normal = math::newell_normal(polygon);
    return normal / std::sqrt(glm::dot(normal, normal));
}

double area_of(const Polygon& polygon, const glm::dvec3& normal, const PolygonTriangle& t) {
    const glm::dvec3 cross =
        glm::cross(polygon[t[1]] - polygon[t[0]], polygon[t[2]] - polygon[t[0]]);
    return 0.5 * glm::dot(cross, normal);
}

/// n - 2 triangles; every side of the polygon used once and marked, every diagonal twice in
/// opposite directions; no triangle turned over; areas add up.
void expect_tiling(const Polygon& polygon, const Triangulated& result) {
    const auto n = static_cast<std::uint32_t>(polygon.size());
    ASSERT_EQ(result.triangles.size(), n - 2);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
    const glm::dvec3 normal = unit_normal(polygon);
    double area = 0;
    int marked = 0;
    for (const PolygonTriangle& t : result.triangles) {
        EXPECT_GE(area_of(polygon, normal, t), 0);
        area += area_of(polygon, normal, t);
        for (unsigned k = 0; k < 3; ++k) {
            ASSERT_LT(t[k], n);
            ++sides[{t[k], t[(k + 1) % 3]}];
            const bool edge = (t[k] + 1) % n == t[(k + 1) % 3];
            EXPECT_EQ((polygon_edge_bits(t, n) >> k & 1) != 0, edge);
            marked += edge ? 1 : 0;
        }
    }
    EXPECT_EQ(marked, static_cast<int>(n));
    for (const auto& [side, count] : sides) {
        EXPECT_EQ(count, 1);
        const bool edge = (side.first + 1) % n == side.second;
        EXPECT_EQ(sides.count({side.second, side.first}), edge ? 0u : 1u);
    }
    const double expected = 0.5 * glm::dot(math::newell_normal(polygon), normal);
    EXPECT_NEAR(area, expected, 1e-9 * expected);
}

TEST(Triangulate, ConvexPolygonsAreFansFromTheFirstCorner) {
    Polygon hexagon;
    for (int i = 0; i < 6; ++i) hexagon.emplace_back(std::cos(i * 1.047), std::sin(i * 1.047), 2.0);
    const Triangulated result = triangulate(hexagon);
    EXPECT_EQ(result.shape, Shape::convex);
    EXPECT_EQ(result.triangles,
              (std::vector<PolygonTriangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}));
    EXPECT_EQ(polygon_edge_bits(result.triangles[0], 6), 0b011);
    EXPECT_EQ(polygon_edge_bits(result.triangles[1], 6), 0b010);
    EXPECT_EQ(polygon_edge_bits(result.triangles[3], 6), 0b110);
}

TEST(Triangulate, ADartIsNeverCutAcrossItsNotch) {
    // Whichever corner comes first.
    std::vector<glm::dvec2> dart{{0, 0}, {2, -2}, {0, 4}, {-2, -2}};
    for (int turn = 0; turn < 4; ++turn) {
        const Polygon polygon = flat(dart);
        const Triangulated result = triangulate(polygon);
        EXPECT_EQ(result.shape, Shape::concave);
        expect_tiling(polygon, result);
        std::rotate(dart.begin(), dart.begin() + 1, dart.end());
    }
}

TEST(Triangulate, CollinearCornersLeaveNoTriangleWithoutArea) {
    const Polygon polygon = flat({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {1, 2}, {0, 2}, {0, 1}});
    const Triangulated result = triangulate(polygon);
    EXPECT_EQ(result.shape, Shape::convex);
    expect_tiling(polygon, result);
    for (const PolygonTriangle& t : result.triangles)
        EXPECT_GT(area_of(polygon, unit_normal(polygon), t), 0);
}

TEST(Triangulate, StarsInAnyPlane) {
    for (const int tips : {3, 5, 9, 40, 200, 5000}) {
        Polygon star;
        const glm::dvec3 u{1, 2, 0.5}, v{-0.25, 0.5, 3};
        for (int i = 0; i < 2 * tips; ++i) {
            const double angle = i * 3.14159265358979 / tips, radius = i % 2 == 0 ? 1.0 : 0.3;
            star.push_back(glm::dvec3{5, 6, 7} +
                           radius * (std::cos(angle) * u + std::sin(angle) * v));
        }
        const Triangulated result = triangulate(star);
        EXPECT_EQ(result.shape, Shape::concave);
        expect_tiling(star, result);
    }
}

TEST(Triangulate, Spirals) {
    for (const int turns : {1, 4, 30}) {
        std::vector<glm::dvec2> outer, spiral;
        const int steps = 24 * turns;
        for (int i = 0; i <= steps; ++i) {
            const double angle = i * 0.2618, radius = 1 + 0.1 * i;
            const glm::dvec2 direction{std::cos(angle), std::sin(angle)};
            spiral.push_back((radius + 1.0) * direction);
            outer.push_back(radius * direction);
        }
        spiral.insert(spiral.end(), outer.rbegin(), outer.rend());
        const Polygon polygon = flat(spiral);
        expect_tiling(polygon, triangulate(polygon));
    }
}

TEST(Triangulate, AHoleOnABridge) {
    // A square with a square hole, joined by a doubled bridge from (0, 0) to (1, 1).
    const Polygon polygon =
        flat({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}});
    expect_tiling(polygon, triangulate(polygon));
}

TEST(Triangulate, RandomStarShapedPolygonsKeepTheirArea) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> radius(0.05, 1.0);
    for (int round = 0; round < 300; ++round) {
        const int n = 4 + round % 90;
        std::vector<glm::dvec2> points;
        for (int i = 0; i < n; ++i) {
            const double angle = i * 6.283185307179586 / n, r = radius(random);
            points.emplace_back(r * std::cos(angle), r * std::sin(angle));
        }
        const Polygon polygon = flat(points);
        expect_tiling(polygon, triangulate(polygon));
    }
}

TEST(Triangulate, CornersOnACoarseGridAlwaysGiveAllTriangles) {
    // Random corners on a 4 x 4 grid: duplicates, spikes, touching and crossing sides.
    std::mt19937 random(11);
    std::uniform_int_distribution<int> coordinate(0, 3);
    Triangulator triangulator;
    std::vector<PolygonTriangle> triangles;
    for (int round = 0; round < 5000; ++round) {
        Polygon polygon(static_cast<std::size_t>(3 + round % 100));
        for (auto& p : polygon)
            p = {coordinate(random), coordinate(random), coordinate(random) / 2};
        ASSERT_NE(triangulator.triangulate(polygon, triangles), Shape::too_complex);
        ASSERT_EQ(triangles.size(), polygon.size() - 2);
        int edges = 0;
        for (const PolygonTriangle& t : triangles) {
            const auto bits = polygon_edge_bits(t, static_cast<std::uint32_t>(polygon.size()));
            edges += (bits & 1) + (bits >> 1 & 1) + (bits >> 2 & 1);
        }
        EXPECT_EQ(edges, static_cast<int>(polygon.size()));
    }
}

// -- outlines that touch and retrace themselves ---------------------------------------------------

using testing::DecoratedPolygon;
using testing::Loop;
using testing::Point;

Polygon in_space(const Loop& outline) {
    Polygon polygon;
    for (const Point& p : outline) polygon.emplace_back(p.x, p.y, 0);
    return polygon;
}

int rounds(int quick) { return std::getenv("SIGHTLINE_FULL") != nullptr ? 20 * quick : quick; }

/// In integers: no triangle is turned over, and random points are covered as often as the region
/// without ornament winds around them.
void expect_cover(const DecoratedPolygon& polygon, const std::vector<PolygonTriangle>& triangles,
                  std::mt19937_64& random) {
    const Loop& outline = polygon.outline;
    ASSERT_EQ(triangles.size(), outline.size() - 2);
    std::vector<Loop> parts;
    std::int64_t area = 0;
    for (const PolygonTriangle& t : triangles) {
        Loop& part = parts.emplace_back(Loop{outline[t[0]], outline[t[1]], outline[t[2]]});
        EXPECT_GE(testing::doubled_area(part), 0);
        area += testing::doubled_area(part);
    }
    std::vector<Loop> region = polygon.region;
    for (const Loop& loop : region) area -= testing::doubled_area(loop);
    EXPECT_EQ(area, 0);
    // At points of a grid 4,099 times finer, of which few lie on a side.
    constexpr std::int64_t kFine = 4099;
    for (std::vector<Loop>* loops : {&parts, &region}) {
        for (Loop& loop : *loops) {
            for (Point& p : loop) p *= kFine;
        }
    }
    const auto near = [&] {
        return static_cast<std::int64_t>(random() % (50 * kFine)) - 25 * kFine;
    };
    for (int k = 0; k < 4; ++k) {
        const Point at = region[0][random() % region[0].size()] + Point(near(), near());
        if (testing::on_a_side(parts, at)) continue;
        EXPECT_EQ(testing::winding(parts, at), testing::winding(region, at));
    }
}

TEST(Triangulate, ASpikeAndABridgeBetweenParts) {
    const Loop square{{0, 0}, {4, 0}, {4, 4}, {0, 4}};
    std::mt19937_64 random(1);
    for (const DecoratedPolygon& polygon : {
             DecoratedPolygon{{square}, {{0, 0}, {4, 0}, {8, 0}, {4, 0}, {4, 4}, {0, 4}}},
             DecoratedPolygon{{square, {{6, 1}, {8, 1}, {8, 3}, {6, 3}}},
                              {{0, 0},
                               {4, 0},
                               {4, 2},
                               {6, 2},
                               {6, 1},
                               {8, 1},
                               {8, 3},
                               {6, 3},
                               {6, 2},
                               {4, 2},
                               {4, 4},
                               {0, 4}}},
         }) {
        expect_cover(polygon, triangulate(in_space(polygon.outline)).triangles, random);
    }
}

/// How long the sides are that triangles with an area have marked, as a drawing shows them.
double marked_length(const Polygon& polygon) {
    const Triangulated result = triangulate(polygon);
    std::vector<std::uint8_t> bits;
    find_polygon_edges(polygon, result.triangles, bits);
    double sum = 0;
    for (std::size_t i = 0; i < result.triangles.size(); ++i) {
        const PolygonTriangle& t = result.triangles[i];
        if (area_of(polygon, {0, 0, 1}, t) == 0) continue;
        for (unsigned k = 0; k < 3; ++k) {
            if ((bits[i] >> k & 1) == 0) continue;
            const glm::dvec3 side = polygon[t[(k + 1) % 3]] - polygon[t[k]];
            sum += std::sqrt(glm::dot(side, side));
        }
    }
    return sum;
}

TEST(Triangulate, TheOutlineIsMarkedWhateverIsCutOffWithoutArea) {
    Loop spiky{{0, 0}, {4, 0}, {8, 0}, {4, 0}, {4, 4}, {0, 4}};
    Loop repeated{{0, 0}, {0, 0}, {4, 0}, {4, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 4}};
    Loop beyond{{0, 0}, {9, 0}, {4, 0}, {4, 4}, {4, 7}, {4, 4}, {0, 4}};
    Loop lollipop{{0, 0}, {4, 0}, {4, 2}, {6, 2}, {6, 1}, {8, 1},
                  {8, 3}, {6, 3}, {6, 2}, {4, 2}, {4, 4}, {0, 4}};
    for (std::size_t shift = 0; shift < 12; ++shift) {
        for (Loop* loop : {&spiky, &repeated, &beyond, &lollipop}) {
            std::rotate(loop->begin(), loop->begin() + 1, loop->end());
            EXPECT_EQ(marked_length(in_space(*loop)), loop == &lollipop ? 24 : 16);
        }
    }
}

TEST(Triangulate, SpikesAndBridgesTakeNoArea) {
    std::mt19937_64 random(5);
    for (int seed = 0; seed < rounds(1500); ++seed) {
        const bool wild = seed % 3 == 0;
        const auto polygon = testing::random_polygon(
            static_cast<std::uint64_t>(seed), {.parts = 3, .spikes = 4, .wild_bridges = wild});
        expect_cover(polygon, triangulate(in_space(polygon.outline)).triangles, random);
        ASSERT_FALSE(HasFailure()) << "seed " << seed;
    }
}

TEST(Triangulate, SpikesAndBridgesTakeNoAreaInAnyPlane) {
    // Turned in space, with all coordinates rounded, also as files of single precision have them.
    std::mt19937 random(9);
    std::uniform_real_distribution<double> number(-1, 1);
    const auto vector = [&] { return glm::dvec3{number(random), number(random), number(random)}; };
    for (int seed = 0; seed < rounds(1500); ++seed) {
        const auto polygon = testing::random_polygon(static_cast<std::uint64_t>(seed), {});
        const glm::dvec3 u = glm::normalize(vector()), n = glm::normalize(glm::cross(u, vector()));
        const glm::dvec3 v = glm::cross(n, u), shift = 1000.0 * vector();
        Polygon turned;
        for (const Point& p : polygon.outline) {
            const glm::dvec3 exact = shift + double(p.x) * u + double(p.y) * v;
            turned.push_back(seed % 2 == 0 ? exact : glm::dvec3(glm::vec3(exact)));
        }
        double expected = 0, area = 0;
        for (const Loop& loop : polygon.region)
            expected += 0.5 * double(testing::doubled_area(loop));
        const std::vector<PolygonTriangle> triangles = triangulate(turned).triangles;
        ASSERT_EQ(triangles.size(), turned.size() - 2);
        for (const PolygonTriangle& t : triangles) area += std::abs(area_of(turned, n, t));
        // Rounding moves each corner by at most `moved`, and the area by that times the outline,
        // for each of the two triangles at a side.
        double largest = 0, length = 0;
        for (std::size_t i = 0; i < turned.size(); ++i) {
            const glm::dvec3 side = turned[(i + 1) % turned.size()] - turned[i];
            length += std::sqrt(glm::dot(side, side));
            for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(turned[i][k]));
        }
        const double moved = std::sqrt(3.0) * largest * (seed % 2 == 0 ? 0x1p-50 : 0x1p-24);
        ASSERT_NEAR(area, expected, 2 * moved * length) << "seed " << seed;
    }
}

TEST(Triangulate, LargePolygonsWithSpikesInAnyPlane) {
    // Too large for the triangulation of least area; sides run on beyond their ends and come back.
    std::mt19937 random(3);
    std::uniform_real_distribution<double> radius(0.3, 1);
    const glm::dvec3 u = glm::normalize(glm::dvec3{1, 2, 3});
    const glm::dvec3 v = glm::normalize(glm::cross(u, glm::dvec3{0.3, -1, 0.5}));
    for (const int n : {400, 2000}) {
        Polygon star, spiky;
        for (int i = 0; i < n; ++i) {
            const double angle = i * 6.283185307179586 / n, r = radius(random);
            const glm::dvec3 exact = r * (std::cos(angle) * u + std::sin(angle) * v);
            star.emplace_back(glm::vec3(exact));
        }
        for (int i = 0; i < n; ++i) {
            const auto k = static_cast<std::size_t>(i);
            const glm::dvec3 a = star[k], b = star[(k + 1) % star.size()];
            spiky.push_back(a);
            if (i % 3 == 0) spiky.emplace_back(glm::vec3(b + 0.7 * (b - a)));
        }
        const glm::dvec3 normal = unit_normal(star);
        const double expected = 0.5 * glm::dot(math::newell_normal(star), normal);
        double area = 0;
        for (const PolygonTriangle& t : triangulate(spiky).triangles) {
            area += std::abs(area_of(spiky, normal, t));
        }
        EXPECT_NEAR(area, expected, 1e-4 * expected);
    }
}

TEST(Triangulate, SidesThatCrossOverlapAsLittleAsTheyCan) {
    // Every triangulation of a small polygon, one by one.
    std::mt19937 random(13);
    std::uniform_int_distribution<int> coordinate(0, 9);
    for (int round = 0; round < 200; ++round) {
        std::vector<glm::dvec2> p(static_cast<std::size_t>(4 + round % 5));
        for (auto& q : p) q = {coordinate(random), coordinate(random)};
        const std::function<double(std::size_t, std::size_t)> least = [&](std::size_t from,
                                                                          std::size_t to) {
            double best = to - from < 2 ? 0 : 1e9;
            for (std::size_t k = from + 1; k < to; ++k) {
                best = std::min(
                    best, std::abs(turn(p[from], p[k], p[to])) + least(from, k) + least(k, to));
            }
            return best;
        };
        if (math::newell_normal(flat(p)).z == 0) continue;  // it has no side: a fan
        double sum = 0;
        for (const PolygonTriangle& t : triangulate(flat(p)).triangles) {
            sum += std::abs(turn(p[t[0]], p[t[1]], p[t[2]]));
        }
        EXPECT_EQ(sum, least(0, p.size() - 1)) << "round " << round;
    }
}

TEST(Triangulate, PolygonsWithoutArea) {
    EXPECT_EQ(triangulate(flat({{1, 1}, {1, 1}, {1, 1}, {1, 1}})).triangles.size(), 2u);
    EXPECT_EQ(triangulate(flat({{0, 0}, {1, 1}, {2, 2}, {3, 3}, {1, 1}})).triangles.size(), 3u);
}

}  // namespace
}  // namespace sightline::load
