// Ranges, grids and breaks of functions and maps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sightline/plot.hpp"
#include "sightline/scene.hpp"
#include "support/scenes.hpp"

namespace sightline {
namespace {

PlotField field(const char* text) { return field_of(testing::must(parse_formula(text))); }

PlotDomain domain(double size) {
    PlotDomain out;
    out.x = out.z = {-size, size};
    return out;
}

Camera camera_for(const PlotDomain& domain, double height) {
    const Box box{{domain.x.x, -height, domain.z.x}, {domain.x.y, height, domain.z.y}};
    CameraOptions options;
    options.projection = Projection::orthographic;
    return testing::must(make_camera(options, box, {1024, 768}));
}

glm::dvec2 range(const char* text, double size) {
    return testing::must(height_range({field(text)}, domain(size)));
}

TEST(PlotRange, HoldsPeaksAndLeavesPolesOut) {
    const glm::dvec2 peak = range("exp(-50*((x-0.123)^2 + (z-0.777)^2))", 10);
    EXPECT_NEAR(peak.y, 1, 1e-6);  // narrower than the sample is fine
    const glm::dvec2 plane = range("x + 2*z", 10);
    EXPECT_NEAR(plane.x, -30, 1e-9);
    EXPECT_NEAR(plane.y, 30, 1e-9);
    const glm::dvec2 pole = range("1/x", 10);
    EXPECT_LT(pole.y, 50);
    EXPECT_GT(pole.y, 1);
    const glm::dvec2 flat = range("3", 10);
    EXPECT_EQ(flat, glm::dvec2(3, 3));
    EXPECT_FALSE(height_range({field("sqrt(-1-x^2)")}, domain(1)));
    EXPECT_FALSE(height_range({field("1/0")}, domain(1)));
}

TEST(PlotSampling, HasTheCurvesAndIsStraightBetweenNodes) {
    const PlotDomain over = domain(10);
    const PlotField wave = field("3*sin(x)*cos(0.5*z)");
    const Camera camera = camera_for(over, 3);
    PlotCurves curves;
    curves.along_z = true;
    curves.count = 23;
    const double tolerance = 0.05;
    const HeightGrid grid = sample({wave}, over, curves, camera, tolerance);
    const auto drawn = [](const std::vector<LineUse>& uses) {
        return std::count(uses.begin(), uses.end(), LineUse::curve);
    };
    EXPECT_EQ(drawn(grid.row_use), 23);
    EXPECT_EQ(drawn(grid.column_use), 23);
    EXPECT_EQ(grid.x.front(), -10);
    EXPECT_EQ(grid.x.back(), 10);
    EXPECT_TRUE(grid.layers[0].cuts.empty());
    const auto height = wave.make();
    const double pixels = camera.pixels_per_unit();
    double worst = 0;
    for (std::size_t k = 0; k + 1 < grid.z.size(); ++k) {
        for (std::size_t i = 0; i + 1 < grid.x.size(); ++i) {
            const std::vector<double>& y = grid.layers[0].y;
            const double a = y[grid.node(i, k)], b = y[grid.node(i + 1, k)],
                         c = y[grid.node(i, k + 1)];
            const double x = 0.5 * (grid.x[i] + grid.x[i + 1]),
                         z = 0.5 * (grid.z[k] + grid.z[k + 1]);
            worst = std::max({worst, std::abs(height(x, grid.z[k]) - 0.5 * (a + b)),
                              std::abs(height(grid.x[i], z) - 0.5 * (a + c))});
        }
    }
    EXPECT_LT(worst * pixels, 2 * tolerance);
    EXPECT_LT(grid.x.size() * grid.z.size(), 1'000'000u);
}

TEST(PlotSampling, FindsEndsToDoublePrecision) {
    const PlotDomain over = domain(1);
    const HeightGrid grid =
        sample({field("sqrt(0.5 - x^2 - z^2)")}, over, {}, camera_for(over, 1), 0.1);
    ASSERT_FALSE(grid.layers[0].cuts.empty());
    for (const Cut& cut : grid.layers[0].cuts) {
        const std::size_t node = cut.edge / 2, i = node % grid.x.size(), k = node / grid.x.size();
        const bool along_z = cut.edge % 2 != 0;
        const double share = std::isnan(cut.y0) ? cut.end1 : cut.end0;
        const double x = along_z ? grid.x[i] : grid.x[i] + share * (grid.x[i + 1] - grid.x[i]),
                     z = along_z ? grid.z[k] + share * (grid.z[k + 1] - grid.z[k]) : grid.z[k];
        EXPECT_NEAR(x * x + z * z, 0.5, 1e-12);
    }
}

TEST(PlotSampling, FindsJumpsAndLeavesSteepSlopesWhole) {
    const PlotDomain over = domain(5);
    const Camera camera = camera_for(over, 3);
    const HeightGrid steps = sample({field("floor(x + 0.3)")}, over, {}, camera, 0.1);
    ASSERT_FALSE(steps.layers[0].cuts.empty());
    for (const Cut& cut : steps.layers[0].cuts) {
        ASSERT_EQ(cut.edge % 2, 0u);
        const std::size_t i = cut.edge / 2 % steps.x.size();
        const double x = steps.x[i] + cut.end0 * (steps.x[i + 1] - steps.x[i]) + 0.3;
        EXPECT_NEAR(x, std::round(x), 1e-12);
        EXPECT_EQ(std::abs(cut.y1 - cut.y0), 1);
    }
    const HeightGrid steep = sample({field("3*atan(200*x)")}, over, {}, camera, 0.1);
    EXPECT_TRUE(steep.layers[0].cuts.empty());
}

TEST(PlotSampling, MapsKeepTheirNodesAndGaps) {
    HeightMap map;
    map.x = {0, 1, 2.5, 3};
    map.z = {0, 2, 3};
    map.y = {0, 1, 2, 3, 4, NAN, 6, 7, 8, 9, 10, 11};
    PlotCurves curves;
    curves.count = 2;
    const HeightGrid plain = grid_of(map, curves);
    EXPECT_EQ(plain.x, map.x);
    EXPECT_EQ(plain.row_use, (std::vector<LineUse>{LineUse::curve, LineUse::none, LineUse::curve}));
    EXPECT_FALSE(plain.layers[0].open_gaps);
    const auto height = field_of(map).make();
    for (std::size_t k = 0; k < map.z.size(); ++k) {
        for (std::size_t i = 0; i < map.x.size(); ++i) {
            const double there = map.y[k * map.x.size() + i], found = height(map.x[i], map.z[k]);
            EXPECT_TRUE(there == found || (std::isnan(there) && std::isnan(found)));
        }
    }
    EXPECT_TRUE(std::isnan(height(1.2, 1.9)));
    EXPECT_TRUE(std::isnan(height(-0.1, 1)));
    EXPECT_DOUBLE_EQ(height(2.75, 2.5), 8.5 + 0.0);
    PlotDomain over;
    over.x = {0, 3};
    over.z = {0, 3};
    const HeightGrid sampled = sample({field_of(map)}, over, curves, camera_for(over, 5), 0.1);
    for (const double x : map.x)
        EXPECT_TRUE(std::binary_search(sampled.x.begin(), sampled.x.end(), x));
}

TEST(PlotAxes, AreThoseBehindAndHaveNumbers) {
    const Box box{{-10, 0, -10}, {10, 5, 10}};
    const Camera camera = testing::must(make_camera({}, box, {1024, 768}));
    const PlotAxes axes = axes_around(box, camera, {1, 0.5, 1});
    std::vector<std::string> words;
    for (const Label& label : axes.labels) words.push_back(label.text);
    for (const char* word : {"x", "y", "z", "-10", "0", "10"})
        EXPECT_NE(std::find(words.begin(), words.end(), word), words.end()) << word;
    // Nine edges, and a tick for each number but names; none of them inside of the box.
    EXPECT_GT(axes.lines.size(), 9u + 9u);
    for (const AxisLine& line : axes.lines) {
        const glm::dvec3 middle = 0.5 * (line[0] + line[1]);
        EXPECT_FALSE(std::abs(middle.x) < 10 && std::abs(middle.z) < 10 && middle.y > 0 &&
                     middle.y < 5);
        EXPECT_FALSE(line[0] == glm::dvec3(10, 5, 10) || line[1] == glm::dvec3(10, 5, 10));
    }
}

}  // namespace
}  // namespace sightline
