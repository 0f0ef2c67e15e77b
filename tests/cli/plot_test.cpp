// `sightline plot`.
#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"

namespace sightline::testing {
namespace {

using nlohmann::json;

class PlotCommand : public ProgramTest {
protected:
    json report(std::vector<std::string> words) const {
        words.insert(words.begin(), "plot");
        words.push_back("--json");
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return json::parse(outcome.out, nullptr, false);
    }
    void fails(std::vector<std::string> words, int status, const std::string& with) const {
        words.insert(words.begin(), "plot");
        words.insert(words.end(), {"-o", "bad.svg"});
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, status) << outcome.err;
        EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
        EXPECT_NE(outcome.err.find(with), std::string::npos) << outcome.err;
        EXPECT_FALSE(exists("bad.svg"));
    }
};

const std::string kRipple = "y = 8*sin(hypot(x,z))/hypot(x,z)";

TEST_F(PlotCommand, DrawsAFunctionInEveryFormat) {
    const json told = report({kRipple, "--lines", "both", "-o", "a.svg"});
    EXPECT_GT(told["visible_paths"], 80);
    EXPECT_EQ(told["hidden_paths"], 0);
    EXPECT_GT(told["visible_length"], 10000);
    const std::string svg = read("a.svg");
    for (const char* part : {"class=\"upper\"", "class=\"axis\"", "id=\"labels\"", ">-10</text>",
                             "data-object=\"axes\""})
        EXPECT_NE(svg.find(part), std::string::npos) << part;
    for (const char* name : {"a.pdf", "a.eps", "a.dxf", "a.png"})
        EXPECT_EQ(run({"plot", kRipple, "-o", name}).status, 0) << name;
    const std::string dxf = read("a.dxf");
    EXPECT_NE(dxf.find("VISIBLE_UPPER"), std::string::npos);
    EXPECT_NE(dxf.find("LABELS"), std::string::npos);
}

TEST_F(PlotCommand, FirstHeightSeenIsThatOfTheFormula) {
    // A plane from the front: one curve a row, all of them straight and as wide as the picture
    // says.
    const json told = report({"y = z", "--x", "-1:1", "--count", "5", "--projection",
                              "orthographic", "--direction", "0,0,-1", "--ortho-height", "4",
                              "--resolution", "400x400", "--axes", "none", "-o", "a.svg"});
    EXPECT_EQ(told["visible_paths"], 5);
    EXPECT_NEAR(told["visible_length"].get<double>(), 5 * 200, 1e-6);
}

TEST_F(PlotCommand, SidesAndHidden) {
    const std::vector<std::string> base = {kRipple, "--direction",  "0,0.3,-1",    "--axes",
                                           "none",  "--projection", "orthographic"};
    const auto length = [&](std::vector<std::string> more) {
        std::vector<std::string> words = base;
        words.insert(words.end(), more.begin(), more.end());
        words.insert(words.end(), {"-o", "a.svg"});
        return report(words)["visible_length"].get<double>();
    };
    const double both = length({}), upper = length({"--sides", "upper"}),
                 lower = length({"--sides", "lower"});
    EXPECT_LT(upper, both);
    EXPECT_LT(lower, both);
    EXPECT_GT(upper + lower, both);  // the first curve belongs to both sides
    std::vector<std::string> words = base;
    words.insert(words.end(), {"--hidden", "dashed", "-o", "a.svg"});
    EXPECT_GT(report(words)["hidden_length"].get<double>(), 0);
}

TEST_F(PlotCommand, HeightMaps) {
    std::string table;
    for (int k = 0; k < 20; ++k) {
        for (int i = 0; i < 30; ++i)
            table += std::to_string((i - 15) * (k - 10)) + (i < 29 ? "," : "\n");
    }
    write("map.csv", table);
    const json told = report({"map.csv", "--count", "10", "--cell", "2,3", "-o", "a.svg"});
    EXPECT_EQ(told["columns"], 30);
    EXPECT_EQ(told["rows"], 20);
    EXPECT_GE(told["visible_paths"], 10);
    EXPECT_NE(read("a.svg").find(">50</text>"), std::string::npos);  // z: 19 cells of 3
    // A stretched map is a map of other heights, but for the numbers.
    report({"map.csv", "--stretch", "0.1", "--axes", "none", "-o", "b.svg"});
    report({"map.csv", "--height-scale", "0.1", "--axes", "none", "-o", "c.svg"});
    EXPECT_EQ(read("b.svg"), read("c.svg"));
    report({"map.csv", "y = 20", "--stretch", "auto", "-o", "d.svg"});
    report({"map.csv", "--from", "15,100,40", "-o", "e.svg"});
    EXPECT_EQ(read("e.svg").find("class=\"axis\""), std::string::npos);
    const Outcome buried = run({"plot", "map.csv", "--from", "1,-200,3", "-o", "f.svg"});
    EXPECT_EQ(buried.status, 0);
    EXPECT_NE(buried.err.find("below the ground"), std::string::npos);
}

TEST_F(PlotCommand, Styles) {
    report({kRipple, "--style", "ridges", "-o", "a.svg"});
    EXPECT_EQ(read("a.svg").find("class=\"lower\""), std::string::npos);
    report({"y = 3*sin(x)", "--hatch", "-o", "b.svg"});
    EXPECT_NE(read("b.svg").find("class=\"hatch\""), std::string::npos);
    const std::vector<std::string> view = {kRipple, "--projection", "orthographic", "--view",
                                           "front", "--axes",       "none",         "-o"};
    std::vector<std::string> exact = view, image = view;
    exact.push_back("c.svg");
    image.insert(image.end(), {"d.svg", "--image-space"});
    const double a = report(exact)["visible_length"], b = report(image)["visible_length"];
    EXPECT_NEAR(a, b, 0.2 * a);
    EXPECT_NE(a, b);
}

TEST_F(PlotCommand, ImplicitSurfacesInTheBoxThatTheyFill) {
    const json told = report({"x^2 + y^2 + z^2 = 4", "--count", "9", "-o", "a.svg"});
    EXPECT_GT(told["visible_paths"], 9);
    const std::string svg = read("a.svg");
    EXPECT_NE(svg.find("class=\"outline\""), std::string::npos);
    EXPECT_NE(svg.find(">2</text>"), std::string::npos);
    EXPECT_EQ(svg.find(">3</text>"), std::string::npos);
    EXPECT_EQ(svg.find("4294967295"), std::string::npos);
    report({"x^2 + y^2 + z^2 = 4", "--no-outline", "-o", "b.svg"});
    EXPECT_EQ(read("b.svg").find("class=\"outline\""), std::string::npos);
    report({"x^2 + y^2 + z^2 = 4", "y = x/2", "--lines", "both", "-o", "c.svg"});
    EXPECT_NE(read("c.svg").find("class=\"intersection\""), std::string::npos);
}

TEST_F(PlotCommand, TheSameBytesForAnyThreads) {
    for (const char* threads : {"1", "5"})
        report({kRipple, "y = x*z/20", "--lines", "both", "--threads", threads, "-o",
                std::string(threads) + ".svg"});
    EXPECT_EQ(read("1.svg"), read("5.svg"));
}

TEST_F(PlotCommand, BadInput) {
    fails({}, 2, "nothing to plot");
    fails({"y = sin(q)"}, 2, "'q' is unknown");
    fails({"y = 1/0"}, 1, "no height anywhere");
    fails({"y = sqrt(-1-x^2)"}, 1, "no height anywhere");
    fails({"y = x", "--x", "5:5"}, 2, "range '5:5' is empty");
    fails({"y = x", "--x", "five"}, 2, "is no range");
    fails({"y = x", "--y", "100:200"}, 1, "no height anywhere");
    fails({"none.png"}, 1, "no such file");
    fails({"y = x", "--cell", "3"}, 2, "for height maps");
    fails({"y = x", "--count", "1"}, 2, "from 2");
    fails({"y = x", "--from", "0,1,0", "--eye", "1,2,3"}, 2, "--from");
    fails({"y = x", "--near", "1"}, 2, "--near");
    fails({"y = x", "--style", "ridges", "--view", "left"}, 2, "ridges");
    fails({"y = x", "--style", "ridges", "--from", "0,9,9"}, 2, "ridges");
    fails({"x^2 + y^2 + z^2 = -1"}, 1, "has no points");
    fails({"x^2 + y^2 = z", "--hatch"}, 2, "--hatch");
    fails({"y = x", "--scale", "1:2"}, 2, "perspective");
    write("one.csv", "1,2,3\n");
    fails({"one.csv"}, 1, "one.csv: has one row");
    EXPECT_EQ(run({"plot", "y = x"}).status, 2);
}

}  // namespace
}  // namespace sightline::testing
