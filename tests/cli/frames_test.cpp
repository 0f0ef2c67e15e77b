// `render --frames`: what is kept from frame to frame must not show in any of them.
#include "cli/run_program.hpp"

namespace sightline::testing {
namespace {

/// A board, a cube that turns and rises above it for three frames, and a ball that rolls.
const std::string kMovingScene = R"({
  "models": [
    { "path": "board.obj" },
    { "path": "cube.obj", "transform": [{ "translate": [-0.5, 0.2, -0.5] }],
      "frames": [[], [{ "rotate": { "axis": [0, 1, 0], "degrees": 30 } }],
                 [{ "scale": [-1, 1, 1] }, { "translate": [1, 0.5, 0] }]] }
  ],
  "surfaces": [
    { "sphere": { "centre": [-1.5, 0.5, 1], "radius": 0.4 },
      "frames": [[], [{ "translate": [0.7, 0, 0] }]] }
  ]
})";

class Frames : public ProgramTest {
protected:
    void SetUp() override {
        ProgramTest::SetUp();
        write("board.obj", "v -2 0 -2\nv -2 0 2\nv 2 0 2\nv 2 0 -2\nf 1 2 3 4\n");
        write("moving.json", kMovingScene);
    }

    static std::vector<std::string> render(const std::string& model,
                                           std::vector<std::string> options) {
        std::vector<std::string> words = {"render", model, "--resolution", "40x30", "-q"};
        words.insert(words.end(), options.begin(), options.end());
        return words;
    }
    void expect_done(const std::string& model, const std::vector<std::string>& options) const {
        const Outcome outcome = run(render(model, options));
        std::string shown = model;
        for (const std::string& word : options) shown += " " + word;
        EXPECT_EQ(outcome.status, 0) << shown << "\n" << outcome.err;
        EXPECT_EQ(outcome.err, "") << shown;
    }
    void expect_same(const std::string& a, const std::string& b) const {
        EXPECT_NE(read(a), "") << a;
        EXPECT_TRUE(read(a) == read(b)) << a << " and " << b << " differ";
    }
};

TEST_F(Frames, AFullTurnDoesNotRepeatItsFirstPicture) {
    expect_done("cube.obj", {"--frames", "4", "--orbit", "y", "--eye", "3,2,5", "--target", "0,0,0",
                             "-o", "t_##.png", "--ids", "t_##.npy"});
    EXPECT_EQ(files(), (std::vector<std::string>{"board.obj", "cube.obj", "moving.json", "t_01.npy",
                                                 "t_01.png", "t_02.npy", "t_02.png", "t_03.npy",
                                                 "t_03.png", "t_04.npy", "t_04.png"}));
    // Counter-clockwise, seen from above: z becomes x.
    const std::vector<std::string> eyes = {"3,2,5", "5,2,-3", "-3,2,-5", "-5,2,3"};
    for (std::size_t i = 0; i < eyes.size(); ++i) {
        expect_done("cube.obj",
                    {"--eye", eyes[i], "--target", "0,0,0", "-o", "a.png", "--ids", "a.npy"});
        expect_same("a.png", "t_0" + std::to_string(i + 1) + ".png");
        expect_same("a.npy", "t_0" + std::to_string(i + 1) + ".npy");
    }
}

TEST_F(Frames, AnOrbitBeginsWithTheOrdinaryPicture) {
    for (const char* projection : {"perspective", "orthographic", "cavalier"}) {
        expect_done("cube.obj",
                    {"--projection", projection, "--eye", "3,2,5", "--zoom", "1.5", "-o", "a.png"});
        expect_done("cube.obj", {"--projection", projection, "--eye", "3,2,5", "--zoom", "1.5",
                                 "-o", "#.png", "--frames", "2", "--orbit", "x,0,-90"});
        expect_same("a.png", "1.png");
        EXPECT_NE(read("1.png"), read("2.png"));
    }
}

TEST_F(Frames, AnOrbitMayBeginAndEndAnywhere) {
    expect_done("cube.obj", {"--frames", "2", "--orbit", "z,-90,90", "-o", "part#.png"});
    expect_done("cube.obj", {"--frames", "4", "--orbit", "z", "-o", "full#.png"});
    expect_same("part1.png", "full4.png");
    expect_same("part2.png", "full1.png");
}

TEST_F(Frames, APathListsCameras) {
    write("path.json", R"([{"view": "front"}, {"eye": [3, 2, 5], "target": [0, 0, 0], "fov": 25},
                           {"direction": [-1, -2, -3], "projection": "orthographic"}])");
    expect_done("cube.obj", {"--path", "path.json", "-o", "p#.png"});
    EXPECT_FALSE(exists("p4.png"));
    expect_done("cube.obj", {"--view", "front", "-o", "a.png"});
    expect_same("a.png", "p1.png");
    expect_done("cube.obj", {"--eye", "3,2,5", "--target", "0,0,0", "--fov", "25", "-o", "a.png"});
    expect_same("a.png", "p2.png");
    expect_done("cube.obj",
                {"--direction", "-1,-2,-3", "--projection", "orthographic", "-o", "a.png"});
    expect_same("a.png", "p3.png");
    // The command line wins over the list.
    expect_done("cube.obj",
                {"--path", "path.json", "--frames", "2", "--fov", "50", "-o", "q#.png"});
    EXPECT_FALSE(exists("q3.png"));
    expect_done("cube.obj", {"--eye", "3,2,5", "--target", "0,0,0", "--fov", "50", "-o", "a.png"});
    expect_same("a.png", "q2.png");
}

TEST_F(Frames, MovingObjectsStandStillAfterTheirLastFrame) {
    expect_done("moving.json", {"--frames", "4", "-o", "m#.png", "--ids", "m#.npy"});
    EXPECT_NE(read("m1.npy"), read("m2.npy"));
    EXPECT_NE(read("m2.npy"), read("m3.npy"));
    expect_same("m3.npy", "m4.npy");
    expect_same("m3.png", "m4.png");
    // Without frames the first one is drawn, from the same place.
    expect_done("moving.json", {"-o", "a.png", "--ids", "a.npy"});
    expect_same("a.png", "m1.png");
    expect_same("a.npy", "m1.npy");
}

TEST_F(Frames, AFrameIsTheSameWhenItIsDrawnAlone) {
    for (const char* algorithm : {"zbuffer", "scanline", "warnock", "depth-sort", "bsp"}) {
        SCOPED_TRACE(algorithm);
        const std::vector<std::string> common = {"--frames",    "4",       "--orbit",   "y,0,100",
                                                 "--algorithm", algorithm, "--shading", "phong",
                                                 "--samples",   "4"};
        auto all = common;
        all.insert(all.end(), {"-o", "all#.png", "--depth", "all#.exr"});
        expect_done("moving.json", all);
        for (const char* k : {"1", "2", "3", "4"}) {
            auto one = common;
            one.insert(one.end(), {"-o", "one#.png", "--depth", "one#.exr", "--frame", k});
            expect_done("moving.json", one);
            expect_same("all" + std::string(k) + ".png", "one" + std::string(k) + ".png");
            expect_same("all" + std::string(k) + ".exr", "one" + std::string(k) + ".exr");
        }
    }
}

TEST_F(Frames, AlgorithmsAgreeOnMovingObjects) {
    write("triangles.json", R"({"models": [{"path": "board.obj"}, {"path": "cube.obj", "frames":
        [[], [{"rotate": {"axis": [1, 2, 3], "degrees": 50}}], [{"scale": [1, -1, 1]}]]}]})");
    for (const char* algorithm : {"zbuffer", "brute", "scanline", "depth-sort"}) {
        expect_done("triangles.json", {"--frames", "3", "--algorithm", algorithm, "--ids",
                                       std::string(algorithm) + "#.npy"});
    }
    for (const char* frame : {"1.npy", "2.npy", "3.npy"}) {
        for (const char* algorithm : {"brute", "scanline", "depth-sort"}) {
            expect_same(std::string("zbuffer") + frame, std::string(algorithm) + frame);
        }
    }
}

TEST_F(Frames, ATreeIsKeptInAFile) {
    const std::vector<std::string> common = {"--algorithm", "bsp",     "--frames",
                                             "3",           "--orbit", "y,0,90"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), common.begin(), common.end());
        return more;
    };
    expect_done("moving.json", with({"-o", "a#.png"}));
    expect_done("moving.json", with({"-o", "b#.png", "--bsp-save", "t.bsp"}));
    expect_done("moving.json", with({"-o", "c#.png", "--bsp-load", "t.bsp"}));
    for (const char* frame : {"1.png", "2.png", "3.png"}) {
        expect_same(std::string("a") + frame, std::string("b") + frame);
        expect_same(std::string("a") + frame, std::string("c") + frame);
    }
    expect_failure(1,
                   render("cube.obj", {"--algorithm", "bsp", "--bsp-load", "t.bsp", "-o", "d.png"}),
                   {"t.bsp", "another scene"});
    // The same triangles, but nothing moves.
    std::string still = kMovingScene;
    for (std::size_t at; (at = still.find("\"frames\"")) != std::string::npos;) {
        still.replace(at, still.find(']', still.find("]]", at)) + 2 - at, "\"name\": \"still\"");
    }
    write("still.json", still);
    expect_failure(
        1, render("still.json", {"--algorithm", "bsp", "--bsp-load", "t.bsp", "-o", "d.png"}),
        {"t.bsp"});
}

TEST_F(Frames, StagesAreSummed) {
    const Outcome outcome = run(
        render("moving.json", {"--frames", "3", "--algorithm", "bsp", "-o", "#.png", "--json"}));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    for (const char* key : {"\"frames\":3", "\"tree_ms\":", "\"pose_ms\":", "\"resolve_ms\":"}) {
        EXPECT_NE(outcome.out.find(key), std::string::npos) << key << " in " << outcome.out;
    }
    const Outcome one = run(render("cube.obj", {"-o", "a.png", "--json"}));
    for (const char* key : {"\"frames\":", "\"tree_ms\":", "\"pose_ms\":"}) {
        EXPECT_EQ(one.out.find(key), std::string::npos) << key << " in " << one.out;
    }
}

TEST_F(Frames, WrongUseIsOneLine) {
    const auto expect_wrong = [&](const std::vector<std::string>& options,
                                  std::initializer_list<std::string> needles) {
        expect_failure(2, render("cube.obj", options), needles);
    };
    expect_wrong({"-o", "a#.png"}, {"-o", "a#.png", "--frames"});
    expect_wrong({"-o", "a.png", "--frames", "3", "--orbit", "y"}, {"-o", "a.png", "####"});
    expect_wrong({"-o", "a#b#.png", "--frames", "3", "--orbit", "y"}, {"-o", "more than one run"});
    expect_wrong({"-o", "a#.png", "--depth", "d.npy", "--frames", "3", "--orbit", "y"},
                 {"--depth", "d.npy", "####"});
    expect_wrong({"-o", "-", "--output-format", "png", "--frames", "3", "--orbit", "y"},
                 {"-o", "'-'"});
    expect_wrong({"-o", "a#.png", "--frames", "0", "--orbit", "y"}, {"--frames", "'0'"});
    expect_wrong({"-o", "a#.png", "--frames", "3"}, {"--frames", "--orbit"});
    expect_wrong({"-o", "a#.png", "--orbit", "y"}, {"--orbit", "--frames"});
    expect_wrong({"-o", "a#.png", "--frames", "3", "--orbit", "y,0"}, {"--orbit", "'y,0'"});
    expect_wrong({"-o", "a#.png", "--frames", "3", "--orbit", "w"}, {"--orbit", "'w'"});
    expect_wrong({"-o", "a.png", "--frame", "3"}, {"--frame ", "--frames"});
    expect_wrong({"-o", "a#.png", "--frames", "3", "--frame", "4", "--orbit", "y"},
                 {"--frame:", "from 1 to 3"});
    expect_wrong({"-o", "a_#.png", "--depth", "a_##.png", "--frames", "10", "--orbit", "y"},
                 {"a_10.png", "same file"});
    expect_wrong({"-o", "a.png", "--bsp-save", "t.bsp"}, {"--bsp-save", "bsp"});
    expect_wrong({"-o", "a.png", "--bsp-load", "t.bsp", "--algorithm", "zbuffer"}, {"--bsp-load"});
    expect_failure(2, render("board.obj", {"-o", "a#.png", "--frames", "2", "--format", "obj"}),
                   {"nothing moves"});
    write("still.json", R"({"models": [{"path": "cube.obj"}]})");
    expect_failure(2, render("still.json", {"-o", "a#.png", "--frames", "2"}), {"nothing moves"});
}

TEST_F(Frames, ErrorsOfAPathNameThePlace) {
    const auto with_path = [&](std::vector<std::string> more) {
        more.insert(more.end(), {"--path", "path.json", "-o", "p#.png"});
        return render("cube.obj", more);
    };
    expect_failure(1, with_path({}), {"path.json"});
    write("path.json", R"([{"view": "front"}, {"eye": [1, 2]}])");
    expect_failure(1, with_path({}), {"path.json", "[1].eye"});
    write("path.json", "[]");
    expect_failure(1, with_path({}), {"path.json", "at least one camera"});
    write("path.json", R"([{"view": "front"}, {"eye": [1, 2, 3], "target": [1, 2, 3]}])");
    expect_failure(2, with_path({}), {"frame 2", "same point"});
    expect_failure(2, with_path({"--frames", "3"}), {"--frames", "3", "2 cameras"});
    expect_failure(2, with_path({"--frames", "2", "--orbit", "y"}), {"--path", "--orbit"});
}

TEST_F(Frames, FinishedFramesStayAfterAnError) {
    fs::create_directory(folder_ / "out");
    expect_done("cube.obj", {"--frames", "3", "--orbit", "y", "-o", "out/f#.png"});
    fs::remove(folder_ / "out/f1.png");
    fs::remove(folder_ / "out/f2.png");
    fs::remove(folder_ / "out/f3.png");
    fs::create_directory(folder_ / "out/f2.png");
    expect_failure(1, render("cube.obj", {"--frames", "3", "--orbit", "y", "-o", "out/f#.png"}),
                   {"f2.png", "folder"});
    // A folder with a '#' is no place for a number.
    fs::create_directory(folder_ / "take #2");
    expect_done("cube.obj", {"--frames", "2", "--orbit", "y", "-o", "take #2/f_###.png"});
    EXPECT_TRUE(exists("take #2/f_002.png"));
    expect_done("cube.obj", {"-o", "take #2/f.png"});
}

TEST_F(Frames, AnInterruptionLeavesWholeFramesOnly) {
    Running program =
        start({"render", "cube.obj", "--frames", "100000", "--orbit", "y", "--shading", "ids",
               "--resolution", "1500x1500", "-o", "f_#.png", "--ids", "i_#.png", "--frame", "1"});
    EXPECT_EQ(program.wait().status, 0);
    const std::string first = read("f_1.png");
    fs::remove(folder_ / "f_1.png");
    fs::remove(folder_ / "i_1.png");
    Running all = start({"render", "cube.obj", "--frames", "10000", "--orbit", "y", "--shading",
                         "ids", "--resolution", "1500x1500", "-o", "f_#.png", "--ids", "i_#.png"});
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!exists("f_3.png") && std::chrono::steady_clock::now() < deadline) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    all.send(SIGINT);
    EXPECT_EQ(all.wait().status, 130);
    EXPECT_TRUE(read("f_1.png") == first);
    for (const std::string& name : files()) {
        if (name.find(".png") == std::string::npos) continue;
        EXPECT_EQ(png_size(read(name)), (std::array{1500u, 1500u})) << name;
        EXPECT_TRUE(read(name).ends_with("IEND\xae\x42\x60\x82")) << name;
    }
    for (const std::string& name : files()) EXPECT_FALSE(name.starts_with('.')) << name;
}

}  // namespace
}  // namespace sightline::testing
