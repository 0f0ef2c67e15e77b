// The horizon and its bands, by the example and problem 6 of the lecture notes (set 2, "The
// Floating Horizon Algorithm").
#include "drawing/horizon.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "drawing/skyline.hpp"

namespace sightline {
namespace {

using Points = std::vector<glm::dvec2>;

std::vector<Seen> pass(Skyline& skyline, const Points& curve) {
    std::vector<Seen> all, seen;
    for (std::size_t k = 0; k + 1 < curve.size(); ++k) {
        skyline.see_and_raise(slope_of(curve[k], curve[k + 1]), seen);
        const double from = curve[k].x, width = curve[k + 1].x - from;
        for (Seen part : seen) {
            part.t0 = from + part.t0 * width;
            part.t1 = from + part.t1 * width;
            if (!all.empty() && all.back().t1 == part.t0 && all.back().side == part.side) {
                all.back().t1 = part.t1;
            } else {
                all.push_back(part);
            }
        }
    }
    return all;
}

void expect_parts(const std::vector<Seen>& parts, Side side, const Points& expected) {
    std::vector<Seen> of_side;
    for (const Seen& part : parts)
        if (part.side == side) of_side.push_back(part);
    ASSERT_EQ(of_side.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) {
        EXPECT_NEAR(of_side[k].t0, expected[k].x, 1e-9);
        EXPECT_NEAR(of_side[k].t1, expected[k].y, 1e-9);
    }
}

/// The upper horizon at 0, 5, ..., 40.
void expect_heights(const Skyline& skyline, const std::vector<double>& expected) {
    for (std::size_t k = 0; k < expected.size(); ++k) {
        const auto height = skyline.upper().at(5.0 * static_cast<double>(k));
        ASSERT_TRUE(height);
        EXPECT_NEAR(*height, expected[k], 1e-9) << "at " << 5 * k;
    }
}

const Points kValley = {{0, 20}, {20, 0}, {40, 20}}, kRoof = {{0, 0}, {20, 20}, {40, 0}},
             kLevel = {{0, 10}, {40, 10}};

TEST(Horizon, ExampleOfTheNotes) {
    Skyline skyline(0, 40);
    expect_parts(pass(skyline, kValley), Side::either, {{0, 40}});
    expect_heights(skyline, {20, 15, 10, 5, 0, 5, 10, 15, 20});
    const std::vector<Seen> second = pass(skyline, kRoof);
    expect_parts(second, Side::upper, {{10, 30}});
    expect_parts(second, Side::lower, {{0, 10}, {30, 40}});
    expect_heights(skyline, {20, 15, 10, 15, 20, 15, 10, 15, 20});
    EXPECT_TRUE(pass(skyline, kLevel).empty());  // it touches at 10 and 30
    expect_heights(skyline, {20, 15, 10, 15, 20, 15, 10, 15, 20});
}

/// Chords of y = base + sign (x - 20)^2 so short that the curve itself is meant.
Points parabola(double from, double to, double sign, double base) {
    Points out;
    const int steps = 40000;
    for (int k = 0; k <= steps; ++k) {
        const double x = from + (to - from) * k / steps;
        out.emplace_back(x, base + sign * (x - 20) * (x - 20));
    }
    return out;
}

void expect_near(const std::vector<Seen>& parts, Side side, const Points& expected) {
    Points found;
    for (const Seen& part : parts)
        if (part.side == side) found.emplace_back(part.t0, part.t1);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) {
        EXPECT_NEAR(found[k].x, expected[k].x, 1e-5);
        EXPECT_NEAR(found[k].y, expected[k].y, 1e-5);
    }
}

TEST(Horizon, Problem6OfTheNotes) {
    Skyline skyline(0, 40);
    const double root = std::sqrt(200.0), near = 20 - std::sqrt(300.0), far = 40 - near;
    expect_near(pass(skyline, parabola(0, 40, 1, 0)), Side::either, {{0, 40}});
    expect_heights(skyline, {400, 225, 100, 25, 0, 25, 100, 225, 400});
    expect_near(pass(skyline, parabola(0, 40, -1, 400)), Side::upper, {{20 - root, 20 + root}});
    expect_heights(skyline, {400, 225, 300, 375, 400, 375, 300, 225, 400});
    expect_near(pass(skyline, {{0, 300}, {40, 300}}), Side::upper, {{near, 10}, {30, far}});
    expect_heights(skyline, {400, 300, 300, 375, 400, 375, 300, 300, 400});
}

TEST(Horizon, Problem6AsPrinted) {
    Skyline skyline(0, 40);
    pass(skyline, parabola(0, 40, 1, 0));
    expect_near(pass(skyline, parabola(20, 40, -1, 400)), Side::upper,
                {{20, 20 + std::sqrt(200.0)}});
    const double near = 20 - std::sqrt(300.0);
    expect_near(pass(skyline, {{0, 300}, {40, 300}}), Side::upper, {{near, 20}, {30, 40 - near}});
}

TEST(Horizon, ALineOnTheHorizonIsNotAboveIt) {
    Skyline skyline(0, 40);
    pass(skyline, kRoof);
    EXPECT_TRUE(pass(skyline, kRoof).empty());
    EXPECT_TRUE(pass(skyline, {{3, 3}, {20, 20}, {25, 15}}).empty());
}

/// Against the greatest height of all lines so far, column by column.
TEST(Horizon, IsTheUpperEnvelopeOfRandomLines) {
    for (unsigned seed = 1; seed <= 200; ++seed) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> any(0, 1);
        Horizon horizon(0.05, 0.95);
        std::vector<Slope> lines;
        for (int n = 0; n < 60; ++n) {
            const double at = any(random), width = any(random) * (n % 3 == 0 ? 1 : 0.2);
            const Slope line{at, any(random), at + width, any(random)};
            double told = 0, expected = 0;
            horizon.raise(line, [&](const Overlap& part) { told += part.to - part.from; });
            constexpr int kColumns = 2000;
            for (int c = 0; c < kColumns; ++c) {
                const double u = 0.05 + 0.9 * (c + 0.5) / kColumns;
                if (u < line.u0 || u > line.u1) continue;
                bool above = true;
                for (const Slope& old : lines)
                    above = above && !(u >= old.u0 && u <= old.u1 && old.at(u) >= line.at(u));
                if (above) expected += 0.9 / kColumns;
            }
            EXPECT_NEAR(told, expected, 0.01) << "seed " << seed << ", line " << n;
            lines.push_back(line);
        }
        for (int k = 0; k <= 100; ++k) {
            const double u = 0.05 + 0.009 * k;
            double highest = -1;
            for (const Slope& line : lines)
                if (u >= line.u0 && u <= line.u1) highest = std::max(highest, line.at(u));
            const auto height = horizon.at(u);
            ASSERT_EQ(height.has_value(), highest >= 0);
            if (height) {
                EXPECT_NEAR(*height, highest, 1e-12);
            }
        }
    }
}

TEST(Horizon, OneLooksThroughWhatWasSetAside) {
    Skyline skyline(0, 40);
    pass(skyline, {{0, 0}, {40, 0}});
    pass(skyline, {{0, 5}, {40, 5}});
    skyline.set_aside(10, 30);          // the surface ends
    pass(skyline, {{10, 8}, {30, 8}});  // and begins again
    std::vector<Seen> seen;
    skyline.see(slope_of({20, 3}, {21, 3}), seen);
    EXPECT_TRUE(seen.empty());
    skyline.see(slope_of({5, 6}, {35, 6}), seen);
    double length = 0;
    for (const Seen& part : seen) length += 30 * (part.t1 - part.t0);
    EXPECT_NEAR(length, 30, 1e-9);  // above at the sides, through the gap in the middle
    skyline.see(slope_of({20, -10}, {20, 10}), seen);  // straight up
    length = 0;
    for (const Seen& part : seen) length += 20 * (part.t1 - part.t0);
    EXPECT_NEAR(length, 15, 1e-9);
}

}  // namespace
}  // namespace sightline
