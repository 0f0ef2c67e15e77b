// `bench --table`: its data, its picture, and the generated scenes behind it.
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"
#include "sightline/generate.hpp"
#include "sightline/visibility.hpp"

namespace sightline::testing {
namespace {

using nlohmann::json;

class BenchTable : public ProgramTest {
protected:
    [[nodiscard]] static std::vector<std::string> words(std::vector<std::string> more = {}) {
        std::vector<std::string> all = {"bench",        "--table", "--sizes",  "500,100",
                                        "--resolution", "40x30",   "--frames", "1"};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
};

TEST_F(BenchTable, EveryAlgorithmOnEveryScene) {
    const Outcome outcome = run(words({"--json"}));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json object = json::parse(outcome.out);
    EXPECT_EQ(object["unit"], default_algorithm().name);
    EXPECT_EQ(object["size"], "40x30");
    ASSERT_EQ(object["scenes"].size(), 2u);
    EXPECT_EQ(object["scenes"][0]["triangles"], 100);  // sorted
    for (const json& scene : object["scenes"]) {
        EXPECT_NEAR(scene["depth_complexity"], 4, 0.01);
        EXPECT_GT(scene["covered"], 0.5);
        EXPECT_GE(scene["project_ms"], 0);
    }
    ASSERT_EQ(object["rows"].size(), algorithms().size());
    for (const json& row : object["rows"]) {
        EXPECT_NE(find_algorithm(row["algorithm"].get<std::string>()), nullptr);
        ASSERT_EQ(row["resolve_ms"].size(), 2u);
        EXPECT_GT(row["relative"][1], 0);
        EXPECT_TRUE(row["growth"].is_number()) << row;
    }
    EXPECT_EQ(object["rows"][0]["relative"][0], 1.0);
    // Painter, z-buffer and Warnock of 1974 at 100; at 500 they have no figure.
    ASSERT_EQ(object["historical"].size(), 3u);
    EXPECT_NEAR(object["historical"][0]["relative"][0], 1.0 / 54, 1e-12);
    EXPECT_TRUE(object["historical"][2]["relative"][1].is_null());
}

/// Whether every element that is opened is closed, in order, and what stands between is escaped.
bool is_well_formed(const std::string& svg) {
    std::vector<std::string> open;
    std::size_t at = 0;
    while ((at = svg.find_first_of("<&", at)) != std::string::npos) {
        if (svg[at] == '&') {
            if (svg.substr(at, 4) != "&lt;" && svg.substr(at, 4) != "&gt;" &&
                svg.substr(at, 5) != "&amp;") {
                return false;
            }
            ++at;
            continue;
        }
        const std::size_t end = svg.find('>', at);
        if (end == std::string::npos) return false;
        const std::string tag = svg.substr(at + 1, end - at - 1);
        if (std::count(tag.begin(), tag.end(), '"') % 2 != 0) return false;
        const std::string name = tag.substr(0, tag.find_first_of(" /", 1));
        if (tag.starts_with('/')) {
            if (open.empty() || "/" + open.back() != tag) return false;
            open.pop_back();
        } else if (!tag.ends_with('/')) {
            open.push_back(name);
        }
        at = end;
    }
    return open.empty();
}

TEST_F(BenchTable, ThePictureIsWellFormedAndHasAllRows) {
    const Outcome outcome =
        run(words({"-o", "table.svg", "--algorithms", "zbuffer,brute", "--complexity", "2"}));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::string svg = read("table.svg");
    EXPECT_TRUE(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\""));
    EXPECT_TRUE(svg.ends_with("</svg>\n"));
    EXPECT_TRUE(is_well_formed(svg));
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
    for (const char* word : {">zbuffer<", ">brute<", ">painter (1974)<", ">Warnock (1974)<",
                             "stroke-dasharray", "depth complexity 2.00"}) {
        EXPECT_NE(svg.find(word), std::string::npos) << word;
    }
    EXPECT_NE(outcome.out.find("depth complexity"), std::string::npos);
    EXPECT_EQ(files(), (std::vector<std::string>{"cube.obj", "table.svg"}));
}

TEST_F(BenchTable, ExhaustiveAlgorithmsAreLeftOutWhereTheWorkIsTooMuch) {
    // 2^22 samples times 2^16 triangles and one more are over the bound.
    const Outcome outcome = run({"bench", "--table", "--sizes", "65537", "--resolution",
                                 "2048x2048", "--frames", "1", "--json", "--complexity", "0.001"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json object = json::parse(outcome.out);
    for (const json& row : object["rows"]) {
        const Algorithm* algorithm = find_algorithm(row["algorithm"].get<std::string>());
        ASSERT_NE(algorithm, nullptr);
        EXPECT_EQ(row["resolve_ms"][0].is_null(), algorithm->exhaustive) << row;
    }
}

TEST_F(BenchTable, WrongUse) {
    expect_failure(2, words({"cube.obj"}), {"--table", "cube.obj"});
    expect_failure(2, words({"--fov", "30"}), {"--fov", "--table"});
    expect_failure(2, words({"--peers", "."}), {"--peers", "--table"});
    expect_failure(2, words({"--sizes", "1,x"}), {"--sizes", "'x'"});
    expect_failure(2, words({"--sizes", "0"}), {"--sizes", "'0'"});
    expect_failure(2, words({"--complexity", "0"}), {"--complexity", "'0'"});
    expect_failure(2, words({"-o", "a.png"}), {"-o", "'a.png'", ".svg"});
    expect_failure(2, words({"--algorithms", "zbufer"}), {"--algorithms", "zbuffer"});
    expect_failure(1, words({"-o", "none/a.svg"}), {"-o", "'none'"});
    expect_failure(2, {"bench", "--sizes", "100"}, {"--sizes", "--table"});
    expect_failure(2, {"bench", "cube.obj", "--complexity", "2"}, {"--complexity", "cube.obj"});
}

TEST(RandomTriangles, TheirAreasSumUpToTheComplexityAndTheyStayInTheBox) {
    for (const std::uint32_t count : {50u, 1000u, 20000u}) {
        const RandomBox box{3, {2, 1, 4}};
        const auto scene = random_triangles(count, 7, box);
        ASSERT_TRUE(scene.ok());
        double area = 0;
        for (const Corners& c : scene->triangles) {
            const glm::dvec3 u = scene->positions[c.y] - scene->positions[c.x];
            const glm::dvec3 v = scene->positions[c.z] - scene->positions[c.x];
            area += 0.5 * std::abs(u.x * v.y - u.y * v.x);
        }
        EXPECT_NEAR(area / 2, 3, 1e-3) << count;
        for (const glm::dvec3& p : scene->positions) {
            for (int k = 0; k < 3; ++k) EXPECT_TRUE(p[k] >= 0 && p[k] <= box.size[k]);
        }
    }
}

}  // namespace
}  // namespace sightline::testing
