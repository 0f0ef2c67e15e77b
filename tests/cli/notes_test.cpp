// What a user is told when a job is done, but not as it was meant: planes that cut or waste,
// pictures that are blank, what files hold that is not drawn, and options without effect.
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/run_program.hpp"

namespace sightline::testing {
namespace {

class Notes : public ProgramTest {
protected:
    /// The run is done, and says exactly this many lines, one of which has all of the words.
    void expect_line(std::vector<std::string> words, std::initializer_list<std::string> needles,
                     long lines = 1) const {
        std::string shown;
        for (const std::string& word : words) shown += " " + word;
        SCOPED_TRACE("sightline" + shown);
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.error_lines(), lines) << outcome.err;
        std::istringstream text(outcome.err);
        bool found = false;
        for (std::string line; std::getline(text, line);) {
            EXPECT_TRUE(line.starts_with("sightline: warning: ") ||
                        line.starts_with("sightline: note: "))
                << line;
            found = found || std::ranges::all_of(needles, [&](const std::string& needle) {
                        return line.find(needle) != std::string::npos;
                    });
        }
        EXPECT_TRUE(found) << outcome.err;
        words.emplace_back("--quiet");
        EXPECT_EQ(run(words).err, "");
    }
    void expect_silence(std::vector<std::string> words) const {
        const Outcome outcome = run(std::move(words));
        EXPECT_EQ(outcome.status, 0);
        EXPECT_EQ(outcome.err, "");
    }
    static std::vector<std::string> with(std::vector<std::string> words,
                                         std::initializer_list<std::string> more) {
        words.insert(words.end(), more);
        return words;
    }

    const std::vector<std::string> render_ = {"render", "cube.obj", "--resolution",
                                              "40x30",  "-o",       "a.png"};
    const std::vector<std::string> draw_ = {"draw",  "cube.obj", "--resolution",
                                            "40x30", "-o",       "a.svg"};
    const std::vector<std::string> visible_ = {"visible", "cube.obj", "--resolution", "40x30"};
    const std::vector<std::string> compare_ = {"compare",       "cube.obj",     "--algorithms",
                                               "zbuffer,brute", "--resolution", "40x30"};
};

TEST_F(Notes, NothingToSayOfAnOrdinaryRun) {
    for (const auto& words : {render_, draw_, visible_, compare_}) expect_silence(words);
    expect_silence(with(render_, {"--near", "0.5", "--far", "50", "--fov", "30"}));
    expect_silence({"info", "cube.obj"});
}

TEST_F(Notes, PlanesThatWasteThePrecision) {
    write("two.obj",
          "v -900 -900 -1000.5\nv 900 -900 -1000.5\nv 0 900 -1000.5\nf 1 2 3\n"
          "v -900 -600 -1000\nv 900 -600 -1000\nv 0 600 -1000\nf 4 5 6\n");
    const std::initializer_list<std::string> planes = {
        "two.obj", "--eye", "0,0,0", "--target", "0,0,-1", "--near", "1e-4", "--far", "1e6"};
    const std::initializer_list<std::string> words = {"warning", "steps of 9.", "--near 999",
                                                      "--far 1010"};
    expect_line(with({"render", "-o", "a.png"}, planes), words);
    expect_line(with({"render", "-o", "a.png", "--stream"}, planes), words);
    expect_line(with({"draw", "-o", "a.svg"}, planes), words);
    expect_line(with({"visible"}, planes), words);
    expect_line(with({"info"}, planes), words);
    // The planes that it names are good ones.
    expect_silence({"render", "-o", "a.png", "two.obj", "--eye", "0,0,0", "--target", "0,0,-1",
                    "--near", "999", "--far", "1010"});
    expect_line(with(render_, {"--projection", "orthographic", "--near", "-1e7", "--far", "1e7"}),
                {"steps of 0.0"});
}

TEST_F(Notes, AFittedNearPlaneThatCuts) {
    write("deep.obj",
          "v -2e5 -2e5 -1e6\nv 2e5 -2e5 -1e6\nv 0 2e5 -1e6\nf 1 2 3\n"
          "v -0.1 -0.1 -0.5\nv 0.1 -0.1 -0.5\nv 0 0.1 -0.5\nf 4 5 6\n");
    const std::vector<std::string> view = {"--eye", "0,0,0", "--target", "0,0,-1", "deep.obj"};
    const std::initializer_list<std::string> words = {"near plane, fitted at 10", "from depth 0.5",
                                                      "--near"};
    for (std::vector<std::string> command : {std::vector<std::string>{"render", "-o", "a.png"},
                                             {"render", "--stream", "-o", "a.png"},
                                             {"draw", "-o", "a.svg"},
                                             {"visible"}}) {
        command.insert(command.end(), view.begin(), view.end());
        expect_line(command, words);
        expect_silence(with(command, {"--near", "0.4", "--far", "2"}));
    }
}

TEST_F(Notes, PartsOfAStreamGetThePlanesOfTheWhole) {
    write("hall.obj", "v 0 0 0\nv 9 0 0\nv 9 0 9\nv 0 0 9\nf 4 3 2 1\n");
    write("roof.obj", "v 0 3 0\nv 9 3 0\nv 9 3 9\nv 0 3 9\nf 1 2 3 4\n");
    const std::vector<std::string> view = {"render",   "hall.obj", "roof.obj",    "--eye",
                                           "4,2.99,4", "--fov",    "90",          "--target",
                                           "9,0,4.1",  "--depth",  "--resolution"};
    std::vector<std::string> whole = view, stream = view;
    whole.insert(whole.end() - 1, "whole.npy");
    stream.insert(stream.end() - 1, "stream.npy");
    expect_silence(with(whole, {"80x60"}));
    expect_silence(with(stream, {"80x60", "--stream"}));
    EXPECT_EQ(read("whole.npy"), read("stream.npy"));
}

TEST_F(Notes, BlankPictures) {
    const std::initializer_list<std::string> behind = {"--eye", "0,0,9", "--target", "0,0,99"};
    const std::initializer_list<std::string> words = {"warning", "behind the eye",
                                                      "depths -9 to -8"};
    for (const auto& command : {render_, draw_, visible_, compare_})
        expect_line(with(command, behind), words);
    for (const char* algorithm : {"abuffer", "scanline", "depth-sort"})
        expect_line(with(with(render_, behind), {"--algorithm", algorithm}), words);
    expect_line(with(with(render_, behind), {"--opacity", "0.5", "--algorithm", "bsp"}), words);
    expect_line(with(with(render_, behind), {"--stream"}), words);
    expect_line(with({"render", "cube.obj", "--ids", "i.npy"}, behind), words);

    expect_line(with(render_, {"--target", "90,0,0", "--eye", "90,0,50", "--fov", "5"}),
                {"picture is blank", "beside the view"});
    expect_line(with(render_, {"--far", "0.1", "--near", "0.01"}),
                {"blank", "behind the far plane"});
    expect_line(with(render_, {"--near", "90", "--far", "99"}), {"blank", "before the near plane"});
    expect_line({"draw", "cube.obj", "--edges", "none", "-o", "a.svg"}, {"blank", "--fill"});
    expect_line({"plot", "y = x", "--eye", "0,0,90", "--target", "0,0,999", "-o", "p.svg"},
                {"plot is blank"});
    // A grain of dust between the samples.
    write("dust.obj", "v 0 0 0\nv 1e-9 0 0\nv 0 1e-9 0\nf 1 2 3\n");
    expect_line({"render", "dust.obj", "--view", "front", "--projection", "orthographic",
                 "--ortho-height", "9", "--resolution", "40x30", "-o", "a.png"},
                {"blank", "shows nothing"});
}

TEST_F(Notes, BlankFramesAreCounted) {
    write(
        "path.json",
        R"([{"eye":[3,2,5]},{"eye":[3,2,5],"target":[9,9,50]},{"eye":[3,2,5],"target":[9,9,60]}])");
    expect_line(
        {"render", "cube.obj", "--path", "path.json", "--resolution", "40x30", "-o", "f#.png"},
        {"blank in 2 frames", "frame 2: ", "behind the eye"});
}

TEST_F(Notes, BlankComposites) {
    ASSERT_EQ(run({"render", "cube.obj", "--eye", "0,0,9", "--target", "0,0,99", "--quiet", "-o",
                   "nothing.exr", "--resolution", "40x30"})
                  .status,
              0);
    expect_line({"composite", "nothing.exr", "nothing.exr", "-o", "all.exr"}, {"picture is blank"});
}

TEST_F(Notes, MoreThanHalfOfTheTrianglesDropped) {
    write("flat.obj", kCube +
                          "v 0 0 2\nv 1 0 2\nv 2 0 2\nf 9 10 11\nf 10 11 9\nf 11 9 10\n"
                          "f 9 10 9\nf 10 11 10\nf 11 9 11\nf 9 11 9\nf 10 9 10\nf 11 10 11\n"
                          "f 9 9 10\nf 10 10 11\nf 11 11 9\nf 9 9 11\n");
    const std::initializer_list<std::string> words = {"note", "of 25 triangles 13 are degenerate",
                                                      "depths"};
    expect_line({"render", "flat.obj", "-o", "a.png"}, words);
    expect_line({"draw", "flat.obj", "-o", "a.svg"}, words);
    expect_line({"visible", "flat.obj"}, words);
    // Backs that are culled are not dropped.
    expect_silence(with(render_, {"--cull", "back"}));
}

TEST_F(Notes, WhatFilesHoldThatIsNotDrawn) {
    write("lines.obj", kCube + "l 1 2 3\np 1 2\nmtllib lost.mtl\n");
    for (std::vector<std::string> command : {std::vector<std::string>{"render", "-o", "a.png"},
                                             {"draw", "-o", "a.svg"},
                                             {"visible"},
                                             {"info"}}) {
        command.emplace_back("lines.obj");
        expect_line(command, {"warning: lines.obj: ", "points, lines", "4"}, 2);
        expect_line(command, {"warning: lines.obj: ", "'lost.mtl'", "missing"}, 2);
    }
    write("cloth.mtl", "newmtl cloth\nKd 1 0 0\nmap_Kd -s 2 2 2 cloth.png\nbump weave.png\n");
    write("cloth.obj", "mtllib cloth.mtl\nusemtl cloth\n" + kCube);
    expect_line({"render", "cloth.obj", "-o", "a.png"}, {"textures", "2", "'cloth.png'"});
    expect_line({"render", "cloth.obj", "cube.obj", "--stream", "-o", "a.png"}, {"'cloth.png'"});
    write("t.ply",
          "ply\nformat ascii 1.0\ncomment TextureFile skin.png\nelement vertex 3\n"
          "property float x\nproperty float y\nproperty float z\nelement face 1\n"
          "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    expect_line({"render", "t.ply", "-o", "a.png"}, {"'skin.png'"});
    // Found under the model's own name, as it always was.
    write("lines.mtl", "newmtl a\nKd 1 0 0\n");
    expect_line({"render", "lines.obj", "-o", "a.png"}, {"points, lines"});
    const auto json = nlohmann::json::parse(run({"info", "cloth.obj", "--json"}).out);
    EXPECT_EQ(json["notes"].size(), 1u);
}

TEST_F(Notes, TrianglesWithoutArea) {
    write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 3 2 1\n");
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"render", "flat.obj", "-o", "a.png"},
          {"draw", "flat.obj", "-o", "a.svg"},
          {"visible", "flat.obj"},
          {"info", "flat.obj"}}) {
        expect_line(command, {"degenerate", "all 2", "repair the model"});
    }
}

TEST_F(Notes, OptionsWithoutEffect) {
    const auto idle = [&](const std::vector<std::string>& command, const std::string& option,
                          std::initializer_list<std::string> more) {
        expect_line(with(command, more), {"warning: " + option + " has no effect: "});
    };
    for (const auto& command : {render_, draw_, visible_, compare_}) {
        idle(command, "--ortho-height", {"--ortho-height", "3"});
        idle(command, "--fov", {"--fov", "30", "--projection", "orthographic"});
        idle(command, "--oblique-angle", {"--oblique-angle", "30"});
    }
    idle({"info", "cube.obj"}, "--oblique-angle", {"--oblique-angle", "30"});
    idle({"bench", "cube.obj", "--frames", "1", "--resolution", "40x30"}, "--repeat-gap",
         {"--repeat-gap", "2"});
    idle(render_, "--crease-angle", {"--crease-angle", "20"});
    const std::vector<std::string> maps = {"render", "cube.obj", "--resolution",
                                           "40x30",  "--ids",    "i.npy"};
    idle(maps, "--samples", {"--samples", "4"});
    idle(maps, "--background", {"--background", "none"});
    idle(maps, "--shading", {"--shading", "flat"});
    idle(maps, "--holdout", {"--holdout", "cube"});
    idle(draw_, "--crease-angle", {"--crease-angle", "20", "--edges", "silhouette"});
    idle(draw_, "--vanishing-points", {"--vanishing-points", "--projection", "orthographic"});
    const std::vector<std::string> filled = {"draw",   "cube.obj", "--edges", "none",
                                             "--fill", "flat",     "-o",      "a.svg"};
    idle(filled, "--hidden", {"--hidden", "dashed"});
    idle(filled, "--stroke", {"--stroke", "2"});
    idle(filled, "--sort", {"--sort"});
    idle({"draw", "cube.obj", "-o", "a.dxf"}, "--background", {"--background", "#ff0000"});
    write("up.txt", "0 0 -1\n");
    idle(visible_, "--by", {"--by", "object", "--from-directions", "up.txt"});
    idle({"plot", "y = x", "-o", "p.svg"}, "--no-outline", {"--no-outline"});
    idle({"plot", "y = x", "-o", "p.svg", "--image-space"}, "--axes", {"--axes", "box"});
    ASSERT_EQ(run({"render", "cube.obj", "-o", "a.exr", "--resolution", "40x30"}).status, 0);
    idle({"composite", "a.exr", "-o", "b.exr"}, "--flatten", {"--flatten"});
}

}  // namespace
}  // namespace sightline::testing
