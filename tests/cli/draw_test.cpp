// `sightline draw` and `sightline visible`.
#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"

namespace sightline::testing {
namespace {

using nlohmann::json;

std::size_t count_of(const std::string& text, const std::string& needle) {
    std::size_t count = 0;
    for (std::size_t at = text.find(needle); at != std::string::npos;
         at = text.find(needle, at + needle.size()))
        ++count;
    return count;
}

class DrawCommand : public ProgramTest {
protected:
    [[nodiscard]] json report(std::vector<std::string> words) const {
        words.push_back("--json");
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return json::parse(outcome.out, nullptr, false);
    }
    [[nodiscard]] std::vector<std::vector<std::string>> table(
        std::vector<std::string> words) const {
        const Outcome outcome = run(std::move(words));
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        std::vector<std::vector<std::string>> rows;
        std::istringstream lines(outcome.out);
        for (std::string line; std::getline(lines, line);) {
            rows.emplace_back();
            std::istringstream cells(line);
            for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
        }
        return rows;
    }
};

TEST_F(DrawCommand, ACubeShowsNineEdgesAndHidesThree) {
    const json report = this->report({"draw", "cube.obj", "-o", "cube.svg", "--hidden", "dashed"});
    EXPECT_EQ(report["edges"], 12);
    EXPECT_EQ(report["visible_segments"], 9);
    EXPECT_EQ(report["hidden_segments"], 3);
    EXPECT_EQ(report["regions"], 0);
    const std::string svg = read("cube.svg");
    const std::size_t fill = svg.find("id=\"fill\""), hidden = svg.find("id=\"hidden\""),
                      visible = svg.find("id=\"visible\"");
    EXPECT_LT(fill, hidden);
    EXPECT_LT(hidden, visible);
    EXPECT_NE(visible, std::string::npos);
    EXPECT_NE(svg.find("viewBox=\"0 0 1024 768\""), std::string::npos);
    EXPECT_NE(svg.find("class=\"silhouette\""), std::string::npos);
    EXPECT_NE(svg.find("class=\"crease\""), std::string::npos);
    EXPECT_NE(svg.find("data-object=\"cube\""), std::string::npos);
    EXPECT_NE(svg.find("data-source="), std::string::npos);
    EXPECT_NE(svg.find("stroke-dasharray"), std::string::npos);
}

TEST_F(DrawCommand, FacesThereForEachSideAreOneFace) {
    write("both.obj", kCube + "f 1 2 3 4\nf 8 7 6 5\nf 5 6 2 1\nf 6 7 3 2\nf 4 8 7 3\nf 8 5 1 4\n");
    for (const char* edges : {"all", "mesh", "silhouette", "crease"}) {
        const auto drawn = [&](const char* model) {
            return report({"draw", model, "--edges", edges, "--projection", "orthographic",
                           "--hidden", "dashed", "-o", "a.svg"});
        };
        const json both = drawn("both.obj"), cube = drawn("cube.obj");
        for (const char* key : {"edges", "visible_segments", "visible_length", "hidden_length"})
            EXPECT_EQ(both[key], cube[key]) << edges << ' ' << key;
    }
    const auto areas = [&](const char* model) {
        auto row =
            table({"visible", model, "--by", "object", "--projection", "orthographic"}).at(1);
        row.erase(row.begin(), row.begin() + 2);  // object, name
        return row;
    };
    EXPECT_EQ(areas("both.obj"), areas("cube.obj"));
}

TEST_F(DrawCommand, BothMethodsWriteTheSameFile) {
    const std::vector<std::string> words = {
        "draw",    "cube.obj", "--hidden",          "solid",      "--fill",
        "lambert", "--edges",  "mesh,intersection", "--algorithm"};
    for (const std::string method : {"fast", "pairwise"}) {
        auto all = words;
        all.insert(all.end(), {method, "-o", method + ".svg"});
        EXPECT_EQ(run(all).status, 0);
    }
    EXPECT_EQ(read("fast.svg"), read("pairwise.svg"));
    EXPECT_NE(read("fast.svg").size(), 0U);
}

TEST_F(DrawCommand, EdgesAreChosenByKind) {
    const auto edges = [&](const std::string& kinds) {
        return report({"draw", "cube.obj", "-o", "c.svg", "--edges", kinds})["edges"].get<int>();
    };
    EXPECT_EQ(edges("all"), 12);
    EXPECT_EQ(edges("mesh"), 12);
    EXPECT_EQ(edges("silhouette"), 6);
    EXPECT_EQ(edges("crease"), 6);
    EXPECT_EQ(edges("crease,silhouette"), 12);
    EXPECT_EQ(edges("boundary,border,intersection"), 0);
    EXPECT_EQ(edges("none"), 0);
}

TEST_F(DrawCommand, FillsOneRegionAFace) {
    const json report = this->report({"draw", "cube.obj", "-o", "c.svg", "--fill", "lambert"});
    EXPECT_EQ(report["regions"], 3);
    // Three quads, each in one piece: the diagonals are gone.
    const std::string svg = read("c.svg"), fill = svg.substr(0, svg.find("id=\"hidden\""));
    EXPECT_EQ(count_of(fill, "<path"), 3U);
}

TEST_F(DrawCommand, EveryFormatIsWrittenAndRepeats) {
    const std::vector<std::pair<std::string, std::string>> formats = {
        {"svg", "<?xml"}, {"pdf", "%PDF"}, {"eps", "%!PS"}, {"dxf", ""}, {"png", "\x89PNG"}};
    for (const auto& [format, magic] : formats) {
        SCOPED_TRACE(format);
        const std::string name = "c." + format;
        EXPECT_EQ(
            run({"draw", "cube.obj", "-o", name, "--page", "a4", "--vanishing-points"}).status, 0);
        const std::string first = read(name);
        EXPECT_TRUE(first.starts_with(magic));
        const Outcome piped = run({"draw", "cube.obj", "-o", "-", "--output-format", format,
                                   "--page", "a4", "--vanishing-points"});
        EXPECT_EQ(piped.status, 0) << piped.err;
        EXPECT_EQ(piped.out, first);
    }
    EXPECT_NE(read("c.svg").find("id=\"construction\""), std::string::npos);
}

TEST_F(DrawCommand, PagesHaveRealUnits) {
    const std::vector<std::string> scaled = {"draw",         "cube.obj",     "-o",      "c.svg",
                                             "--projection", "orthographic", "--view",  "front",
                                             "--page",       "200x100mm",    "--scale", "20:1"};
    EXPECT_EQ(run(scaled).status, 0);
    const std::string svg = read("c.svg");
    EXPECT_NE(svg.find("width=\"200mm\""), std::string::npos);
    EXPECT_NE(svg.find("viewBox=\"0 0 200 100\""), std::string::npos);
    // A unit cube seen from the front, twenty times as large: its outline is 80 mm long.
    const json report = this->report(scaled);
    EXPECT_NEAR(report["visible_length"].get<double>(), 80, 1e-4);
}

TEST_F(DrawCommand, WrongUse) {
    const auto wrong = [&](std::vector<std::string> more,
                           std::initializer_list<std::string> needles) {
        std::vector<std::string> words = {"draw", "cube.obj"};
        words.insert(words.end(), more.begin(), more.end());
        expect_failure(2, words, needles);
    };
    wrong({}, {"-o"});
    wrong({"-o", "c.jpg"}, {"c.jpg", "svg"});
    wrong({"-o", "-"}, {"--output-format"});
    wrong({"-o", "c.svg", "--edges", "creases"}, {"--edges", "creases", "crease"});
    wrong({"-o", "c.svg", "--hidden", "dotted"}, {"--hidden", "dotted"});
    wrong({"-o", "c.svg", "--fill", "lamber"}, {"--fill", "lambert"});
    wrong({"-o", "c.svg", "--page", "a5"}, {"--page", "a5"});
    wrong({"-o", "c.svg", "--page", "0x10mm"}, {"--page"});
    wrong({"-o", "c.svg", "--scale", "2"}, {"--scale", "1:50"});
    wrong({"-o", "c.svg", "--scale", "1:50"}, {"--scale", "--projection"});
    wrong({"-o", "c.svg", "--margin", "5"}, {"--margin", "--page"});
    wrong({"-o", "c.svg", "--page", "a4", "--margin", "200"}, {"--margin"});
    wrong({"-o", "c.svg", "--stroke", "0"}, {"--stroke"});
    wrong({"-o", "c.svg", "--crease-angle", "200"}, {"--crease-angle"});
    wrong({"-o", "c.svg", "--algorithm", "zbuffer"}, {"--algorithm", "pairwise"});
    wrong({"-o", "-", "--output-format", "svg", "--json"}, {"--json"});
    wrong({"-o", "cube.obj"}, {"cube.obj"});
    expect_failure(1, {"draw", "cube.obj", "-o", "nowhere/c.svg"}, {"nowhere"});
    expect_failure(1, {"draw", "missing.obj", "-o", "c.svg"}, {"missing.obj"});
}

TEST_F(DrawCommand, VisibleSumsToTheSilhouette) {
    const auto rows =
        table({"visible", "cube.obj", "--projection", "orthographic", "--view", "front"});
    ASSERT_EQ(rows.size(), 13U);
    EXPECT_EQ(rows[0].size(), 8U);
    double visible = 0;
    for (std::size_t i = 1; i < rows.size(); ++i) visible += std::stod(rows[i][6]);
    EXPECT_NEAR(visible, 1, 1e-6);  // the front of a unit cube, in its own unit; pages have steps
}

TEST_F(DrawCommand, VisibleBySourcePolygonAndObject) {
    EXPECT_EQ(table({"visible", "cube.obj", "--by", "polygon"}).size(), 7U);
    const auto objects = table({"visible", "cube.obj", "--by", "object"});
    ASSERT_EQ(objects.size(), 2U);
    EXPECT_EQ(objects[1][1], "cube");
    const json all = report({"visible", "cube.obj", "--projection", "orthographic"});
    EXPECT_EQ(all["unit"], "scene");
    EXPECT_EQ(all["rows"].size(), 12U);
    EXPECT_TRUE(all["rows"][0].contains("area_visible_pixels"));
    EXPECT_NEAR(all["total"]["area_visible"].get<double>(), std::sqrt(3.0), 1e-5);
}

TEST_F(DrawCommand, VisibleFromManyDirections) {
    write("sun.txt", "# noon and evening\n0,-1,0\n-1 0 0\n\n1,1,1\n");
    const auto rows = table({"visible", "cube.obj", "--from-directions", "sun.txt"});
    ASSERT_EQ(rows.size(), 5U);
    EXPECT_NEAR(std::stod(rows[1][5]), 1, 1e-5);
    EXPECT_EQ(rows[1][4], "2");
    EXPECT_NEAR(std::stod(rows[3][5]), std::sqrt(3.0), 1e-5);
    EXPECT_EQ(rows[4][0], "union");
    EXPECT_EQ(rows[4][4], "10");  // the front of the cube sees nothing of it, nor does the left
    const json data = report({"visible", "cube.obj", "--from-directions", "sun.txt"});
    EXPECT_EQ(data["directions"].size(), 3U);
    write("bad.txt", "0,0,0\n");
    expect_failure(1, {"visible", "cube.obj", "--from-directions", "bad.txt"}, {"bad.txt:1"});
    expect_failure(1, {"visible", "cube.obj", "--from-directions", "no.txt"}, {"no.txt"});
    expect_failure(2, {"visible", "cube.obj", "--csv", "--json"}, {"--csv"});
}

}  // namespace
}  // namespace sightline::testing
