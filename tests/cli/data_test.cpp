// What the program prints: help, versions, tables and JSON.
#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"

namespace sightline::testing {
namespace {

using nlohmann::json;

class Data : public ProgramTest {
protected:
    /// Runs with --json; the last line of the output is one object.
    [[nodiscard]] json data(std::vector<std::string> words, int status = 0) const {
        words.push_back("--json");
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, status) << outcome.err;
        EXPECT_TRUE(outcome.out.ends_with("\n"));
        std::string text = outcome.out;
        if (!text.empty()) text.pop_back();
        const json object = json::parse(text.substr(text.rfind('\n') + 1), nullptr, false);
        EXPECT_TRUE(object.is_object()) << outcome.out;
        return object;
    }
    static void expect_keys(const json& object, std::initializer_list<const char*> keys) {
        for (const char* key : keys) EXPECT_TRUE(object.contains(key)) << key;
    }
};

TEST_F(Data, HelpOfTheProgramAndOfEachCommand) {
    const Outcome program = run({"--help"});
    EXPECT_EQ(program.status, 0);
    EXPECT_EQ(program.err, "");
    for (const char* name :
         {"render", "draw", "visible", "composite", "info", "algorithms", "compare", "bench"}) {
        EXPECT_NE(program.out.find(name), std::string::npos);
        for (const char* flag : {"--help", "-h"}) {
            const Outcome help = run({name, flag});
            EXPECT_EQ(help.status, 0);
            EXPECT_NE(help.out.find(std::string("Usage: sightline ") + name), std::string::npos);
            EXPECT_NE(help.out.find("Examples:"), std::string::npos);
        }
    }
    EXPECT_EQ(run({"help"}).out, program.out);
    EXPECT_EQ(run({"help", "info"}).out, run({"info", "--help"}).out);
    EXPECT_TRUE(run({"--version"}).out.starts_with("sightline "));
}

TEST_F(Data, Algorithms) {
    const json object = data({"algorithms"});
    EXPECT_EQ(object["default"], "zbuffer");
    std::vector<std::string> names;
    for (const json& row : object["algorithms"]) {
        names.push_back(row["name"]);
        expect_keys(row, {"title", "space", "exact", "help", "citation"});
    }
    EXPECT_NE(std::find(names.begin(), names.end(), "brute"), names.end());
    EXPECT_NE(run({"algorithms"}).out.find("zbuffer"), std::string::npos);
}

TEST_F(Data, InfoOfACube) {
    const json object = data({"info", "cube.obj"});
    EXPECT_EQ(object["triangles"], 12);
    EXPECT_EQ(object["polygons"], 6);
    EXPECT_EQ(object["degenerate_triangles"], 0);
    EXPECT_EQ(object["joined_vertices"], 0);
    EXPECT_EQ(object["equal_faces"], 0);
    EXPECT_EQ(object["objects"][0]["name"], "cube");
    EXPECT_EQ(object["objects"][0]["closed"], true);
    EXPECT_EQ(object["bounds"]["min"], json({0.0, 0.0, 0.0}));
    EXPECT_EQ(object["bounds"]["max"], json({1.0, 1.0, 1.0}));
    expect_keys(object["camera"], {"eye", "target", "near", "far", "fov", "resolution"});
    EXPECT_EQ(object["finite_vanishing_points"], 3);
    EXPECT_NE(run({"info", "cube.obj"}).out.find("three-point perspective"), std::string::npos);
}

TEST_F(Data, VanishingPoints) {
    const std::vector<std::string> front = {"info",  "cube.obj",     "--view",
                                            "front", "--resolution", "200x100"};
    json object = data(front);
    EXPECT_EQ(object["perspective"], "one-point perspective");
    EXPECT_TRUE(object["vanishing_points"]["x"].is_null());
    EXPECT_EQ(object["vanishing_points"]["z"], json({100.0, 50.0}));
    object = data({"info", "cube.obj", "--eye", "3,0,4", "--target", "0,0,0",
                   "--vanishing-direction", "-3,0,-4", "--vanishing-direction", "4,0,-3"});
    EXPECT_EQ(object["perspective"], "two-point perspective");
    ASSERT_EQ(object["vanishing_directions"].size(), 2u);
    EXPECT_NEAR(object["vanishing_directions"][0]["point"][0].get<double>(), 512, 1e-6);
    EXPECT_TRUE(object["vanishing_directions"][1]["point"].is_null());
    object = data({"info", "cube.obj", "--projection", "orthographic"});
    EXPECT_EQ(object["perspective"], "parallel projection");
}

TEST_F(Data, RenderReports) {
    const json object = data({"render", "cube.obj", "-o", "a.png", "--resolution", "40x30"});
    expect_keys(object, {"load_ms", "project_ms", "resolve_ms", "shade_ms", "write_ms",
                         "degenerate_triangles", "culled", "peak_rss_mb"});
    EXPECT_EQ(object["triangles"], 12);
    EXPECT_EQ(object["culled_percent"], 50.0);
    const Outcome stats = run({"render", "cube.obj", "-o", "a.png", "--stats"});
    EXPECT_EQ(stats.out, "");
    for (const char* word : {"load", "project", "resolve", "shade", "write", "degenerate", "MiB"}) {
        EXPECT_NE(stats.err.find(word), std::string::npos) << word;
    }
}

TEST_F(Data, Compare) {
    const json object = data({"compare", "cube.obj", "--resolution", "64x48"});
    EXPECT_EQ(object["reference"], "brute");
    ASSERT_GE(object["rows"].size(), 2u);
    for (const json& row : object["rows"]) {
        EXPECT_EQ(row["differ"], 0) << row;
        EXPECT_EQ(row["samples"], 64 * 48);
        expect_keys(row, {"algorithm", "ms", "peak_mib", "exact", "counts"});
        EXPECT_FALSE(row["counts"].empty()) << row;
    }
    const json one = data({"compare", "cube.obj", "--algorithms", "zbuffer", "--resolution",
                           "64x48", "--difference", "d.png"});
    EXPECT_EQ(one["rows"].size(), 1u);
    EXPECT_EQ(png_size(read("d.png")), (std::array{64u, 48u}));
    EXPECT_NE(run({"compare", "cube.obj", "--resolution", "16x16"}).out.find("reference: brute"),
              std::string::npos);
}

TEST_F(Data, Bench) {
    const std::vector<std::string> quick = {"--resolution", "64x48", "--frames", "2"};
    const auto bench = [&](std::vector<std::string> words) {
        words.insert(words.begin(), "bench");
        words.insert(words.end(), quick.begin(), quick.end());
        return data(words);
    };
    const json cube = bench({"cube.obj"});
    expect_keys(cube, {"load_ms", "setup_ms", "prepare_ms", "project_ms", "resolve_ms", "shade_ms",
                       "write_ms", "frame_ms_min", "frame_ms_median", "mtris_per_s", "mpix_per_s",
                       "threads", "frames", "algorithm", "peak_rss_mb"});
    EXPECT_EQ(cube["mesh"], "cube.obj");
    EXPECT_EQ(cube["triangles"], 12);
    EXPECT_EQ(cube["size"], "64x48");
    EXPECT_EQ(bench({"cube.obj", "--subdivide", "2", "--repeat", "3"})["triangles"], 12 * 16 * 3);
    EXPECT_EQ(bench({"--generate", "500"})["triangles"], 500);
    bench({"cube.obj", "--view", "front", "--projection", "orthographic", "--repeat", "2"});
    EXPECT_EQ(files(), std::vector<std::string>{"cube.obj"});
}

TEST_F(Data, AFullDiskBehindStandardOutputIsAnError) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "needs /dev/full";
    const std::string command = std::string("'") + SIGHTLINE_PROGRAM + "' info '" +
                                (folder_ / "cube.obj").string() + "' > /dev/full 2> /dev/null";
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
}

}  // namespace
}  // namespace sightline::testing
