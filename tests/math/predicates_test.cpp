// The predicates against rational arithmetic, on random and degenerate input, with a count of how
// often the exact stage was needed.
#include "math/predicates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <iostream>

#include "sightline/visibility.hpp"
#include "support/scenes.hpp"

namespace sightline {
namespace {

using boost::multiprecision::cpp_int;
using boost::multiprecision::cpp_rational;
using testing::Random;

#ifdef SIGHTLINE_SANITIZED
constexpr int kCases = 100'000;  // the release build runs the million
#else
constexpr int kCases = 1'000'000;
#endif

int sign(const cpp_rational& r) { return r.sign(); }

cpp_int side_rational(const ScreenPoint& p, const ScreenPoint& q, std::int32_t x, std::int32_t y) {
    return (cpp_int(q.x) - p.x) * (cpp_int(y) - p.y) - (cpp_int(q.y) - p.y) * (cpp_int(x) - p.x);
}

// The depth of the plane through three points, solved by Cramer's rule from the points themselves.
cpp_rational depth_rational(const ScreenPoint& p, const ScreenPoint& q, const ScreenPoint& r,
                            std::int32_t x, std::int32_t y) {
    const cpp_int area = side_rational(p, q, r.x, r.y);
    const cpp_int wq = side_rational(p, ScreenPoint{x, y, 0}, r.x, r.y);
    const cpp_int wr = side_rational(p, q, x, y);
    const cpp_int weighted =
        cpp_int(p.z) * (area - wq - wr) + cpp_int(q.z) * wq + cpp_int(r.z) * wr;
    return cpp_rational(weighted) / cpp_rational(area);
}

constexpr std::int32_t kExtent = (1 << (kCoordBits - 1)) - 1;

struct Case {
    ScreenPoint p[3], q[3];
    std::int32_t x, y;
};

ScreenPoint random_point(Random& random, std::int32_t extent) {
    const auto coordinate = [&](std::int32_t e) {
        return static_cast<std::int32_t>(random.below(2 * static_cast<std::uint32_t>(e) + 1)) - e;
    };
    const std::int32_t x = coordinate(extent), y = coordinate(extent);
    return {x, y, static_cast<std::int32_t>(random.below(1u << kDepthBits))};
}

// Six kinds, from general position to planes that touch at the sample.
Case random_case(Random& random) {
    const std::int32_t extents[] = {4, 300, 50000, kExtent};
    const std::int32_t extent = extents[random.below(4)];
    Case c{};
    for (auto& point : c.p) point = random_point(random, extent);
    for (auto& point : c.q) point = random_point(random, extent);
    ScreenPoint sample = random_point(random, extent);
    switch (random.below(6)) {
        case 0:
            break;
        case 1:  // a shared corner, sampled there: equal depths
            c.q[random.below(3)] = c.p[random.below(3)];
            sample = c.p[random.below(3)];
            break;
        case 2:  // a shared edge (a fold), sampled on it where that is a point of the grid
            c.q[0] = c.p[0];
            c.q[1] = c.p[1];
            sample = {(c.p[0].x + c.p[1].x) / 2, (c.p[0].y + c.p[1].y) / 2, 0};
            break;
        case 3:  // one plane, or one depth unit away from it
            std::copy(std::begin(c.p), std::end(c.p), std::begin(c.q));
            c.q[0].z = std::min(c.q[0].z + static_cast<std::int32_t>(random.below(2)), kDepthMax);
            break;
        case 4:  // a sliver, steep in depth
            c.p[2] = {c.p[1].x + 1, c.p[1].y, kDepthMax - c.p[1].z};
            sample = c.p[0];
            break;
        default:  // parallel to the screen
            c.p[1].z = c.p[2].z = c.p[0].z;
            c.q[0].z = c.q[1].z = c.q[2].z = c.p[0].z + (random.chance(0.5) ? 0 : 1);
    }
    c.x = sample.x;
    c.y = sample.y;
    return c;
}

TEST(Predicates, CompareDepthEqualsRationalArithmetic) {
    Random random(1);
    int exact = 0, ties = 0, done = 0;
    while (done < kCases) {
        const Case c = random_case(random);
        const Plane p = plane_through(c.p[0], c.p[1], c.p[2]);
        const Plane q = plane_through(c.q[0], c.q[1], c.q[2]);
        if (p.c == 0 || q.c == 0) continue;
        ++done;
        const int truth = sign(depth_rational(c.p[0], c.p[1], c.p[2], c.x, c.y) -
                               depth_rational(c.q[0], c.q[1], c.q[2], c.x, c.y));
        const DepthOrder order = compare_depth(p, q, c.x, c.y);
        ASSERT_EQ(order.sign, truth) << "case " << done;
        ASSERT_EQ(compare_depth_exactly(p, q, c.x, c.y), truth) << "case " << done;
        ASSERT_EQ(compare_depth(q, p, c.x, c.y).sign, -truth) << "case " << done;
        exact += order.stage == Stage::exact;
        ties += truth == 0;
    }
    std::cout << "compare_depth: " << kCases << " cases, " << ties << " ties, " << exact
              << " went to the exact stage (" << 100.0 * exact / kCases << " %)\n";
    EXPECT_GE(exact, ties);  // no filter can certify a tie
    EXPECT_GT(ties, kCases / 20);
}

TEST(Predicates, TheExactStageIsRareInGeneralPosition) {
    Random random(2);
    int exact = 0;
    constexpr int kGeneral = 100'000;
    for (int i = 0; i < kGeneral; ++i) {
        ScreenPoint s[6];
        for (auto& point : s) point = random_point(random, kExtent);
        const Plane p = plane_through(s[0], s[1], s[2]), q = plane_through(s[3], s[4], s[5]);
        if (p.c == 0 || q.c == 0) continue;
        exact += compare_depth(p, q, s[0].x, s[0].y).stage == Stage::exact;
    }
    std::cout << "compare_depth in general position: " << exact << " of " << kGeneral
              << " went to the exact stage\n";
    EXPECT_LT(exact, 10);
}

TEST(Predicates, CoverageEqualsRationalArithmetic) {
    Random random(3);
    int on_edge = 0, inside = 0;
    for (int i = 0; i < kCases; ++i) {
        const Case c = random_case(random);
        const OrientedTriangle t(c.p[0], c.p[1], c.p[2]);
        bool truth = side_rational(t.p, t.q, t.r.x, t.r.y) > 0;
        const ScreenPoint* corners[] = {&t.p, &t.q, &t.r};
        for (int k = 0; k < 3; ++k) {
            const ScreenPoint &a = *corners[k], &b = *corners[(k + 1) % 3];
            const cpp_int e = side_rational(a, b, c.x, c.y);
            // Top: level, inside below it. Left: the inside lies to its right.
            const bool top = a.y == b.y && b.x > a.x, left = b.y < a.y;
            truth = truth && (e > 0 || (e == 0 && (top || left)));
            on_edge += e == 0;
        }
        ASSERT_EQ(covers(t, c.x, c.y), truth) << "case " << i;
        inside += truth;
    }
    std::cout << "covers: " << kCases << " cases, " << inside << " inside, " << on_edge
              << " on an edge's line, all by integers\n";
    EXPECT_GT(on_edge, kCases / 20);
    EXPECT_GT(inside, kCases / 50);
}

// Triangles that tile a region give each sample one owner, on edges and corners too.
TEST(Predicates, ATilingOwnsEverySampleOnce) {
    Random random(4);
    for (int round = 0; round < 200; ++round) {
        ScreenPoint grid[5][5];
        for (int j = 0; j < 5; ++j)
            for (int i = 0; i < 5; ++i) {
                const bool inner = i % 4 != 0 && j % 4 != 0;
                const auto jitter = [&] {
                    return inner ? static_cast<std::int32_t>(random.below(5)) - 2 : 0;
                };
                grid[j][i] = {8 * i + jitter(), 8 * j + jitter(), 0};
            }
        for (std::int32_t y = 0; y < 32; ++y)
            for (std::int32_t x = 0; x < 32; ++x) {
                int owners = 0;
                for (int j = 0; j < 4; ++j)
                    for (int i = 0; i < 4; ++i) {
                        const ScreenPoint &a = grid[j][i], &b = grid[j][i + 1],
                                          &c = grid[j + 1][i + 1], &d = grid[j + 1][i];
                        owners += covers(OrientedTriangle(a, b, c), x, y);
                        owners += covers(OrientedTriangle(a, c, d), x, y);
                    }
                ASSERT_EQ(owners, 1) << x << ' ' << y << " round " << round;
            }
    }
}

TEST(Depth, StoredAndEvaluatedDepthKeepTheirBounds) {
    Random random(5);
    double worst_stored = 0, worst_evaluated = 0;
    for (int i = 0; i < kCases / 10; ++i) {
        const Case c = random_case(random);
        const Plane plane = plane_through(c.p[0], c.p[1], c.p[2]);
        if (plane.c == 0) continue;
        const cpp_rational truth = depth_rational(c.p[0], c.p[1], c.p[2], c.x, c.y);
        if (truth < 0 || truth > cpp_rational(kDepthMax)) continue;  // outside: clamped
        const auto error = [&](double z) {
            return std::abs(static_cast<double>(cpp_rational(z) - truth));
        };
        worst_stored = std::max(worst_stored, error(stored_depth(plane, c.x, c.y)));
        worst_evaluated = std::max(worst_evaluated, error(evaluate_depth(plane, c.x, c.y)));
    }
    std::cout << "stored_depth is off by at most " << worst_stored << " units, evaluate_depth by "
              << worst_evaluated << '\n';
    EXPECT_LE(worst_stored, kStoredDepthError);
    EXPECT_LE(worst_evaluated, 0x1p-20);
    EXPECT_GT(worst_stored, 1);  // the cases do stress it
}

}  // namespace
}  // namespace sightline
