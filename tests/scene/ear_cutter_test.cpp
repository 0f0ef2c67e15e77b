#include "scene/load/ear_cutter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <random>
#include <string>

#include "support/amount.hpp"

namespace sightline::load {
namespace {

using Points = std::vector<glm::dvec2>;

Points comb(int n) {
    Points points{{0, -1}, {2.0 * (n / 3), -1}};
    for (int i = n / 3; i-- > 0;) {
        points.emplace_back(2 * i + 1.5, 0);
        points.emplace_back(2 * i + 1.0, 50);
        points.emplace_back(2 * i + 0.5, 0);
    }
    return points;
}

Points spiral(int n) {
    Points points, inner;
    for (int i = 0; i < n / 2; ++i) {
        const glm::dvec2 direction{std::cos(0.05 * i), std::sin(0.05 * i)};
        points.push_back((1 + 0.01 * i) * direction);
        inner.push_back((0.5 + 0.01 * i) * direction);
    }
    points.insert(points.end(), inner.rbegin(), inner.rend());
    return points;
}

/// A star-shaped polygon: its boundary is as jagged as can be.
Points jagged(int n) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> radius(0.1, 1.1);
    Points points;
    for (int i = 0; i < n; ++i) {
        const double angle = 2 * M_PI * i / n, r = radius(random);
        points.emplace_back(r * std::cos(angle), r * std::sin(angle));
    }
    return points;
}

/// A row of blunt notches under one long side: no ear there is a small one.
Points saw(int n) {
    Points points;
    for (int i = 0; i < n; ++i)
        points.emplace_back(i, (i - n / 2.0) * (i - n / 2.0) / n + 0.3 * (i % 2));
    points.emplace_back(n / 2.0, 10.0 * n);
    return points;
}

/// Sides that cross one another nearly everywhere.
Points tangled(int n) {
    Points points;
    for (std::int64_t i = 0; i < n; ++i)
        points.emplace_back(static_cast<double>(i), static_cast<double>(i * i % 1009));
    return points;
}

Points random_corners(int n) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> at(0, 1);
    Points points;
    for (int i = 0; i < n; ++i) points.emplace_back(at(random), at(random));
    return points;
}

/// Every other corner at one point.
Points rays(int n) {
    Points points;
    for (int i = 0; i < n / 2; ++i) {
        const double angle = 4 * M_PI * i / n;
        points.emplace_back(0, 0);
        points.emplace_back(std::cos(angle), std::sin(angle));
    }
    return points;
}

double doubled_area(const Points& points) {
    double sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec2 &p = points[i], &q = points[(i + 1) % points.size()];
        sum += p.x * q.y - p.y * q.x;
    }
    return sum;
}

struct Shape {
    std::string name;
    std::function<Points(int)> make;
    bool is_simple;
};

const std::vector<Shape> kShapes = {{"comb", comb, true},
                                    {"spiral", spiral, true},
                                    {"jagged", jagged, true},
                                    {"saw", saw, true},
                                    {"rays", rays, true},
                                    {"tangled", tangled, false},
                                    {"random corners", random_corners, false}};

TEST(EarCutter, TakesFewStepsForEachCorner) {
    for (const Shape& shape : kShapes) {
        for (const int n : {3000, static_cast<int>(testing::amount(120000, 60000, 8000))}) {
            const Points points = shape.make(n);
            EarCutter ears;
            std::vector<PolygonTriangle> triangles;
            ASSERT_TRUE(ears.cut(points, 0x1p-40, ~std::uint64_t{0} / 2, triangles));
            EXPECT_EQ(triangles.size(), points.size() - 2) << shape.name;
            // A look at all other corners for each would be n * n: 3.6e9 steps. What a search in
            // the tree takes at most is about sqrt(n), where ears are long and narrow.
            EXPECT_LT(static_cast<double>(ears.work()), 5.0 * n * std::sqrt(n))
                << shape.name << " of " << n << " corners";
        }
    }
}

TEST(EarCutter, LargeSimplePolygonsAreTiled) {
    for (const Shape& shape : kShapes) {
        if (!shape.is_simple) continue;
        const Points points = shape.make(static_cast<int>(testing::amount(60000, 20000, 3000)));
        std::vector<PolygonTriangle> triangles;
        ASSERT_TRUE(EarCutter().cut(points, 0x1p-40, ~std::uint64_t{0} / 2, triangles));
        double sum = 0;
        for (const PolygonTriangle& t : triangles) {
            const double area = turn(points[t[0]], points[t[1]], points[t[2]]);
            EXPECT_GE(area, 0) << shape.name;
            sum += area;
        }
        EXPECT_NEAR(sum, doubled_area(points), 1e-9 * sum) << shape.name;
    }
}

/// The tree against looking at every corner.
TEST(CornerTree, FindsTheMarkedCornersInATriangle) {
    std::mt19937 random(3);
    std::uniform_int_distribution<int> at(0, 30), count(1, 300);
    const auto point = [&] { return glm::dvec2(at(random), at(random)); };
    for (int trial = 0; trial < 2000; ++trial) {
        Points points(static_cast<std::size_t>(count(random)));
        for (glm::dvec2& p : points) p = point();
        CornerTree tree;
        tree.build(points);
        std::vector<bool> marked(points.size());
        for (int change = 0; change < 100; ++change) {
            const auto corner = static_cast<std::uint32_t>(random() % points.size());
            marked[corner] = !marked[corner];
            tree.mark(corner, marked[corner]);
        }
        std::array<glm::dvec2, 3> triangle{point(), point(), point()};
        if (turn(triangle[0], triangle[1], triangle[2]) < 0) std::swap(triangle[1], triangle[2]);
        if (turn(triangle[0], triangle[1], triangle[2]) == 0) continue;
        std::size_t inside = 0, on_border = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            double least = HUGE_VAL;
            for (std::size_t k = 0; k < 3; ++k)
                least = std::min(least, turn(triangle[k], triangle[(k + 1) % 3], points[i]));
            if (marked[i] && least >= 0) ++(least > 0 ? inside : on_border);
        }
        std::uint64_t work = 0;
        std::size_t asked = 0;
        const bool found = tree.any_in(triangle, work, [&](std::uint32_t corner) {
            EXPECT_TRUE(marked[corner]);
            for (std::size_t k = 0; k < 3; ++k)
                if (turn(triangle[k], triangle[(k + 1) % 3], points[corner]) < 0) return false;
            ++asked;
            return false;
        });
        // All on the border are asked for, unless one inside has ended the search.
        if (found)
            EXPECT_GT(inside, 0u);
        else
            EXPECT_EQ(asked, inside + on_border);
    }
}

}  // namespace
}  // namespace sightline::load
