#include "scene/load/triangulate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <random>
#include <set>

#include "math/newell.hpp"

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

TEST(Triangulate, CombsOfManyTeethAreQuick) {
    std::vector<glm::dvec2> comb{{0, -1}};
    const int teeth = 20000;
    comb.emplace_back(2.0 * teeth, -1);
    for (int i = teeth; i-- > 0;) {
        comb.emplace_back(2 * i + 1.5, 0);
        comb.emplace_back(2 * i + 1.0, 50);
        comb.emplace_back(2 * i + 0.5, 0);
    }
    const Polygon polygon = flat(comb);
    expect_tiling(polygon, triangulate(polygon));
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

TEST(Triangulate, PolygonsWithoutArea) {
    EXPECT_EQ(triangulate(flat({{1, 1}, {1, 1}, {1, 1}, {1, 1}})).triangles.size(), 2u);
    EXPECT_EQ(triangulate(flat({{0, 0}, {1, 1}, {2, 2}, {3, 3}, {1, 1}})).triangles.size(), 3u);
}

}  // namespace
}  // namespace sightline::load
