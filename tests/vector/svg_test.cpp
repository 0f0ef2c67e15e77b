// SVG drawings: their structure, their numbers and their names.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <string>
#include <vector>

#include "support/files.hpp"
#include "vector/drawings.hpp"

namespace {

using namespace sightline;
using sightline::testing::add_part;
using sightline::testing::pixel_options;
using sightline::testing::read_file;
using sightline::testing::small_drawing;
using sightline::testing::TemporaryFolder;

std::string svg_of(const Drawing& drawing, const VectorOptions& options) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.svg");
    EXPECT_TRUE(write_drawing(path, VectorFormat::svg, drawing, options).ok());
    EXPECT_EQ(folder.count(), 1);
    return read_file(path);
}

/// The first group of each match. Patterns must match short texts: std::regex recurses.
std::vector<std::string> all_matches(const std::string& text, const std::string& pattern) {
    const std::regex regex(pattern);
    std::vector<std::string> out;
    for (auto i = std::sregex_iterator(text.begin(), text.end(), regex);
         i != std::sregex_iterator(); ++i) {
        out.push_back((*i)[1]);
    }
    return out;
}

/// What stands between `before` and the next quotation mark, each time.
std::vector<std::string> quoted_after(const std::string& text, const std::string& before) {
    std::vector<std::string> out;
    for (std::size_t at = text.find(before); at != std::string::npos; at = text.find(before, at)) {
        at += before.size();
        out.push_back(text.substr(at, text.find('"', at) - at));
    }
    return out;
}

/// Checks that every element is closed in its turn, and how deep they nest at most.
int depth_of(const std::string& svg) {
    std::vector<std::string> open;
    std::size_t deepest = 0;
    const std::regex tag("<(/?)([a-z]+)([^>]*?)(/?)>");
    for (auto i = std::sregex_iterator(svg.begin(), svg.end(), tag); i != std::sregex_iterator();
         ++i) {
        const std::string name = (*i)[2];
        if ((*i)[1].length() > 0) {
            EXPECT_FALSE(open.empty());
            if (open.empty()) return -1;
            EXPECT_EQ(open.back(), name);
            open.pop_back();
        } else if ((*i)[4].length() == 0) {
            open.push_back(name);
            deepest = std::max(deepest, open.size());
        }
    }
    EXPECT_TRUE(open.empty());
    return static_cast<int>(deepest);
}

TEST(Svg, GroupsStandInTheirOrder) {
    const std::string svg = svg_of(small_drawing(), pixel_options(small_drawing()));
    EXPECT_EQ(quoted_after(svg, "<g id=\""),
              (std::vector<std::string>{"fill", "hidden", "visible", "construction"}));
    EXPECT_EQ(quoted_after(svg, "<g class=\""),
              (std::vector<std::string>{"crease", "silhouette", "crease"}));
    EXPECT_EQ(quoted_after(svg, "path class=\""), (std::vector<std::string>{"x", "y"}));
    EXPECT_EQ(depth_of(svg), 3);  // svg, layer, kind or colour
}

TEST(Svg, AnEmptyDrawingHasItsGroups) {
    Drawing drawing;
    drawing.regions.first_loop = drawing.regions.first_point = {0};
    for (const Drawing& empty : {drawing, Drawing()}) {
        const std::string svg = svg_of(empty, pixel_options(empty));
        EXPECT_EQ(quoted_after(svg, "<g id=\""),
                  (std::vector<std::string>{"fill", "hidden", "visible"}));
        EXPECT_EQ(svg.find("<path"), std::string::npos);
        EXPECT_EQ(svg.find("<rect"), std::string::npos);
        EXPECT_EQ(depth_of(svg), 2);
    }
}

TEST(Svg, PathsSayWhereTheyComeFrom) {
    const std::string svg = svg_of(small_drawing(), pixel_options(small_drawing()));
    EXPECT_EQ(quoted_after(svg, "data-source=\""),
              (std::vector<std::string>{"8", "7", "7,9", "7 7 7 7", "7,8 7,8"}));
    EXPECT_EQ(quoted_after(svg, "data-object=\""),
              (std::vector<std::string>{"0", "0", "0", "0", "1"}));
    EXPECT_EQ(quoted_after(svg, " d=\""),
              (std::vector<std::string>{
                  "M90 10l100 40-100 40z", "M10 10l80 0 0 80-80 0zM30 30l0 40 40 0 0-40z",
                  "M10 10l80 80", "M10 10l80 0 0 80-80 0z", "M90 10l100.063 40.5-100.063 39.5",
                  "M100 50L200 50", "M100 50L100 0"}));
    EXPECT_EQ(quoted_after(svg, "<g fill=\""), (std::vector<std::string>{"#0000ff", "#ff0000"}));
}

TEST(Svg, RelativeStepsAddUpToTheRoundedPoints) {
    Drawing drawing;
    drawing.resolution = {1'000, 1'000};
    std::vector<glm::dvec2> points;
    points.reserve(2'000);
    for (int i = 0; i < 2'000; ++i) {
        points.emplace_back(500 + 300 * std::cos(i * 0.7), 500 + 300 * std::sin(i * 1.3));
    }
    sightline::testing::add_polyline(drawing.lines, points);
    const std::string path = quoted_after(svg_of(drawing, pixel_options(drawing)), " d=\"").at(0);
    std::vector<std::int64_t> thousandths;
    for (const std::string& n : all_matches(path, "(-?[0-9]*\\.?[0-9]+)")) {
        thousandths.push_back(std::llround(std::stod(n) * 1000));
    }
    ASSERT_EQ(thousandths.size(), 2 * points.size());
    std::int64_t x = 0, y = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        x += thousandths[2 * i];
        y += thousandths[2 * i + 1];
        EXPECT_EQ(x, std::llround(points[i].x * 1000));
        EXPECT_EQ(y, std::llround(points[i].y * 1000));
    }
}

TEST(Svg, PaperHasRealUnits) {
    VectorOptions options;
    options.layout = {210, 297, true, 0.05, {10, 98.5}};
    const std::string svg = svg_of(small_drawing(), options);
    EXPECT_NE(svg.find(" width=\"210mm\" height=\"297mm\" viewBox=\"0 0 210 297\""),
              std::string::npos);
    EXPECT_NE(svg.find("M14.5 99l5.0031 2.025-5.0031 1.975\""), std::string::npos) << svg;
}

TEST(Svg, HiddenLinesAreThinnerAndDashedOnRequest) {
    VectorOptions options = pixel_options(small_drawing());
    options.stroke = 2;
    const std::string dashed = svg_of(small_drawing(), options);
    const std::regex hidden("id=\"hidden\"[^>]*stroke-width=\"1.2\"[^>]*stroke-dasharray=\"8 6\"");
    EXPECT_TRUE(std::regex_search(dashed, hidden));
    options.dashed_hidden = false;
    EXPECT_FALSE(std::regex_search(svg_of(small_drawing(), options), hidden));
}

TEST(Svg, NamesMayHoldAnyBytes) {
    VectorOptions options = pixel_options(small_drawing());
    options.object_names = {"a<b>&\"c\"\n\xFF\xC3\xA4\xED\xA0\x80\xEF\xBF\xBF", ""};
    options.title = "x < y\x01\xE2\x82";
    const std::string bad = "\xEF\xBF\xBD";
    const std::string svg = svg_of(small_drawing(), options);
    const auto names = quoted_after(svg, "data-object=\"");
    ASSERT_EQ(names.size(), 5u);
    EXPECT_EQ(names[0],
              "a&lt;b&gt;&amp;&quot;c&quot;" + bad + bad + "\xC3\xA4" + bad + bad + bad + bad);
    EXPECT_EQ(names[4], "1");  // no name: its number
    EXPECT_NE(svg.find("<title>x &lt; y" + bad + bad + bad + "</title>"), std::string::npos);
}

TEST(Svg, TheBackgroundIsARectangleBeforeTheGroups) {
    VectorOptions options = pixel_options(small_drawing());
    options.background = {1, 1, 1, 1};
    const std::string opaque = svg_of(small_drawing(), options);
    EXPECT_LT(opaque.find("<rect"), opaque.find("<g "));
    EXPECT_NE(opaque.find("fill=\"#ffffff\"/>"), std::string::npos);
    options.background.a = 0.5f;
    EXPECT_NE(svg_of(small_drawing(), options).find("fill-opacity=\"0.5\""), std::string::npos);
}

TEST(Svg, LongDrawingsPassThroughTheBuffer) {
    Drawing drawing;
    drawing.resolution = {1'000, 1'000};
    for (int i = 0; i < 30'000; ++i) {
        const glm::dvec2 from(i % 173, std::floor(i / 173.0));
        add_part(drawing.lines, from, from + glm::dvec2(0.5, 0.25));
    }
    VectorOptions options = pixel_options(drawing);
    options.title = std::string(600'000, 't');
    const std::string svg = svg_of(drawing, options);
    EXPECT_NE(svg.find(options.title + "</title>"), std::string::npos);
    EXPECT_EQ(all_matches(svg.substr(svg.find("</title>")), "l(.5 .25)\"").size(), 30'000u);
}

}  // namespace
