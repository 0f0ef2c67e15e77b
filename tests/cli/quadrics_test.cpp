// Surfaces that are not polygons, from scene.json to files.
#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"

namespace sightline::testing {
namespace {

const std::string kBall = R"({"surfaces": [
    {"sphere": {"centre": [0, 0, 0], "radius": 1}, "name": "ball"}]})";
const std::string kMixed = R"({"models": [{"path": "cube.obj"}], "surfaces": [
    {"sphere": {"centre": [1, 1, 1], "radius": 0.6}, "name": "ball"},
    {"cylinder": {"from": [0, 0.5, -1], "to": [0.5, 0.5, 2], "radius": 0.3}}]})";

class Surfaces : public ProgramTest {
protected:
    [[nodiscard]] Outcome render(const std::string& scene, const std::string& algorithm,
                                 const std::string& stem) const {
        return run({"render", scene, "--resolution", "60x50", "--samples", "4", "--algorithm",
                    algorithm, "-o", stem + ".png", "--ids", stem + ".npy", "--depth",
                    stem + ".exr"});
    }
};

TEST_F(Surfaces, RenderAlikeByEveryAlgorithmThatTakesThem) {
    write("ball.json", kBall);
    write("mixed.json", kMixed);
    for (const std::string scene : {"ball.json", "mixed.json"}) {
        for (const std::string algorithm : {"zbuffer", "scanline-zbuffer", "brute"}) {
            const Outcome outcome = render(scene, algorithm, algorithm);
            EXPECT_EQ(outcome.status, 0) << outcome.err;
            EXPECT_EQ(outcome.err, "");
            for (const std::string end : {".png", ".npy", ".exr"})
                EXPECT_EQ(read(algorithm + end), read("zbuffer" + end)) << algorithm << end;
        }
    }
}

TEST_F(Surfaces, AreTessellatedForTheOthersWhichSaySo) {
    write("mixed.json", kMixed);
    const Outcome outcome = render("mixed.json", "warnock", "w");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("'warnock' takes triangles only: 2 surfaces are tessellated"),
              std::string::npos)
        << outcome.err;
    const Outcome quiet = run({"render", "mixed.json", "--resolution", "60x50", "--algorithm",
                               "warnock", "-o", "w.png", "--quiet"});
    EXPECT_EQ(quiet.err, "");
}

TEST_F(Surfaces, AreComparedOnTheirTessellation) {
    write("mixed.json", kMixed);
    const Outcome outcome = run({"compare", "mixed.json", "--resolution", "40x30", "--json"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("compared on triangles: 2 surfaces"), std::string::npos);
    const auto rows = nlohmann::json::parse(outcome.out).at("rows");
    EXPECT_GE(rows.size(), 6u);
    for (const auto& row : rows) EXPECT_EQ(row.at("differ"), 0) << row;
    EXPECT_EQ(run({"compare", "mixed.json", "--resolution", "40x30", "--quiet"}).err, "");
}

TEST_F(Surfaces, AreCountedByInfoAndTimedByBench) {
    write("ball.json", kBall);
    const Outcome info = run({"info", "ball.json", "--json"});
    EXPECT_EQ(info.status, 0) << info.err;
    EXPECT_EQ(nlohmann::json::parse(info.out).at("quadrics"), 1);
    EXPECT_EQ(nlohmann::json::parse(info.out).at("triangles"), 0);
    for (const std::string algorithm : {"zbuffer", "spans"}) {
        const Outcome bench = run({"bench", "ball.json", "--resolution", "40x30", "--frames", "1",
                                   "--algorithm", algorithm, "--quiet"});
        EXPECT_EQ(bench.status, 0) << bench.err;
    }
}

TEST_F(Surfaces, MayBeMadeTranslucentByName) {
    write("ball.json", kBall);
    const Outcome outcome =
        run({"render", "ball.json", "--resolution", "8x8", "--opacity", "ball=0.5", "-o", "a.png"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("opaque"), std::string::npos) << outcome.err;
}

TEST_F(Surfaces, ThatMakeNoSenseAreRefusedInOneLine) {
    write("bad.json", R"({"surfaces": [{"sphere": {"centre": [0, 0, 0], "radius": -1}}]})");
    const Outcome outcome = run({"render", "bad.json", "-o", "a.png"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.error_lines(), 1);
    EXPECT_NE(outcome.err.find("bad.json: surfaces[0].sphere.radius: expected a number above 0"),
              std::string::npos)
        << outcome.err;
    EXPECT_FALSE(exists("a.png"));
}

}  // namespace
}  // namespace sightline::testing
