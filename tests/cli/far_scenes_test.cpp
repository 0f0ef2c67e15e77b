// The program on scenes far from the origin: pictures, drawings and numbers are those of the same
// scene at the origin, and options are in the coordinates of the file.
#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"
#include "support/stairs.hpp"

namespace sightline::testing {
namespace {

using nlohmann::json;

const glm::dvec3 kPlace(431200, 448, -5171800);  // a map grid, in metres

std::string text_of(glm::dvec3 p) { return fmt::format("{},{},{}", p.x, p.y, p.z); }

class FarProgram : public ProgramTest {
protected:
    void SetUp() override {
        ProgramTest::SetUp();
        write("near.obj", as_obj(stairs_at({0, 0, 0})));
        write("far.obj", as_obj(stairs_at(kPlace)));
    }
    /// Runs a command that writes `out`; its bytes.
    [[nodiscard]] std::string made(std::vector<std::string> words, const std::string& out) const {
        words.insert(words.end(), {"-o", out});
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return read(out);
    }
    [[nodiscard]] std::string drawing(const std::string& model) const {
        return made({"draw", model, "--projection", "orthographic", "--direction", "-1,-1,1",
                     "--hidden", "dashed"},
                    "drawing.svg");
    }
    [[nodiscard]] std::string picture(std::vector<std::string> words) const {
        words.insert(words.begin(), "render");
        words.insert(words.end(), {"--resolution", "160x120"});
        return made(words, "picture.png");
    }
};

TEST_F(FarProgram, PicturesAndDrawingsAreThoseAtTheOrigin) {
    // Objects are called after the file, so that takes the same name in every place.
    const auto drawn = [&](const std::vector<glm::dvec3>& corners) {
        write("stairs.obj", as_obj(corners));
        return drawing("stairs.obj");
    };
    const std::string svg = drawn(stairs_at({0, 0, 0})), png = picture({"near.obj"});
    for (const glm::dvec3& place : {kPlace, glm::dvec3(0, 1e3, 0), glm::dvec3(1e5, -1e7, 0x1p24),
                                    glm::dvec3(-0x1p36, 0, 0)}) {
        const std::vector<glm::dvec3> corners = stairs_at(place);
        EXPECT_TRUE(drawn(corners) == svg) << text_of(place);
        EXPECT_TRUE(picture({"stairs.obj"}) == png) << text_of(place);
        write("stairs.ply", as_ply<double>(corners, "binary_big_endian"));
        EXPECT_TRUE(drawing("stairs.ply") == svg) << text_of(place);
    }
    // Decimal fractions, which no double holds, and places that are no whole numbers of steps.
    std::vector<glm::dvec3> corners = stairs_at({0, 0, 0});
    for (glm::dvec3& p : corners) p *= 0.9;
    const std::string smaller = drawn(corners);
    for (glm::dvec3& p : corners) p += glm::dvec3(431200.1, 450.3, -5171800.7);
    EXPECT_TRUE(drawn(corners) == smaller);
}

TEST_F(FarProgram, CameraOptionsAreInTheCoordinatesOfTheFile) {
    const glm::dvec3 eye(6, 5, -4), target(1.5, 0.5, 1.5);
    const std::string png =
        picture({"near.obj", "--eye", text_of(eye), "--target", text_of(target)});
    EXPECT_EQ(
        picture({"far.obj", "--eye", text_of(eye + kPlace), "--target", text_of(target + kPlace)}),
        png);
    const auto turn = [&](const std::string& model, glm::dvec3 place) {
        return made({"render", model, "--eye", text_of(eye + place), "--orbit", "y", "--frames",
                     "4", "--frame", "2", "--resolution", "80x60"},
                    "#.png");
    };
    (void)turn("near.obj", {0, 0, 0});
    const std::string turned = read("2.png");
    (void)turn("far.obj", kPlace);
    EXPECT_EQ(read("2.png"), turned);
    const auto vector = [](glm::dvec3 p) { return "[" + text_of(p) + "]"; };
    write("path.json", R"([{"eye": )" + vector(eye + kPlace) + R"(, "target": )" +
                           vector(target + kPlace) + "}]");
    (void)made({"render", "far.obj", "--path", "path.json", "--resolution", "160x120"}, "#.png");
    EXPECT_EQ(read("1.png"), png);
    const auto complexity = [&](const std::string& model, glm::dvec3 place) {
        const Outcome outcome = run({"bench", model, "--eye", text_of(eye + place), "--json",
                                     "--resolution", "64x48", "--frames", "1"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return json::parse(outcome.out).value("depth_complexity", 0.0);
    };
    EXPECT_GT(complexity("near.obj", {0, 0, 0}), 0.1);
    EXPECT_EQ(complexity("far.obj", kPlace), complexity("near.obj", {0, 0, 0}));
}

TEST_F(FarProgram, InfoTellsTheCoordinatesOfTheFile) {
    const Outcome outcome = run({"info", "far.obj", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json far = json::parse(outcome.out),
               near = json::parse(run({"info", "near.obj", "--json"}).out);
    const auto vector = [](const json& list) {
        return glm::dvec3(list[0].get<double>(), list[1].get<double>(), list[2].get<double>());
    };
    EXPECT_EQ(vector(near["offset"]), glm::dvec3(0));
    EXPECT_EQ(vector(far["offset"]), kPlace);
    EXPECT_EQ(vector(far["bounds"]["min"]), kPlace);
    EXPECT_EQ(vector(far["bounds"]["max"]), kPlace + glm::dvec3(3, 1.125, 3));
    for (const char* what : {"eye", "target"})
        EXPECT_EQ(vector(far["camera"][what]), vector(near["camera"][what]) + kPlace) << what;
    const std::string text = run({"info", "far.obj"}).out;
    EXPECT_NE(text.find("431203, 449.125, -5171797\n"), std::string::npos) << text;
    EXPECT_NE(text.find("offset"), std::string::npos);
    EXPECT_EQ(run({"info", "near.obj"}).out.find("offset"), std::string::npos);
}

// Two files, far from each other compared with their sizes, far from the origin in between.
TEST_F(FarProgram, PartsAreDrawnLikeTheWhole) {
    write("other.obj", as_obj(stairs_at(kPlace + glm::dvec3(1, 40, 0.3))));
    const std::vector<std::string> size = {"--resolution", "160x120"};
    const auto render = [&](std::vector<std::string> words, const std::string& out) {
        words.insert(words.begin(), "render");
        words.insert(words.end(), size.begin(), size.end());
        return made(words, out);
    };
    const std::string whole = render({"far.obj", "other.obj"}, "whole.exr");
    EXPECT_EQ(render({"far.obj", "other.obj", "--stream"}, "stream.exr"), whole);
    const std::vector<std::string> camera = {"--eye",     text_of(kPlace + glm::dvec3(90, 50, 60)),
                                             "--target",  text_of(kPlace + glm::dvec3(2, 20, 2)),
                                             "--near",    "60",
                                             "--far",     "200",
                                             "--samples", "1"};
    const auto with_camera = [&](std::vector<std::string> words, const std::string& out) {
        words.insert(words.end(), camera.begin(), camera.end());
        return render(words, out);
    };
    const std::string seen = with_camera({"far.obj", "other.obj"}, "seen.exr");
    EXPECT_EQ(with_camera({"far.obj", "other.obj", "--stream"}, "stream.exr"), seen);
    (void)with_camera({"far.obj"}, "a.exr");
    (void)with_camera({"other.obj"}, "b.exr");
    EXPECT_EQ(made({"composite", "a.exr", "b.exr"}, "joined.exr"), seen);
}

// What other programs are told is in the file's coordinates too: they read the file themselves.
TEST_F(FarProgram, PeersAreToldTheCoordinatesOfTheFile) {
    write("peer_embree",
          "#!/bin/sh\necho \"$@\" > words\n"
          "echo '{\"triangles\": 72, \"frame_ms_median\": 1}'\n");
    fs::permissions(folder_ / "peer_embree", fs::perms::owner_all);
    const Outcome outcome =
        run({"bench", "far.obj", "--peers", ".", "--rounds", "1", "--frames", "1", "--eye",
             text_of(kPlace + glm::dvec3(6, 5, -4)), "--resolution", "64x48"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(read("words").find("--eye=431206,453,-5171804"), std::string::npos) << read("words");
}

}  // namespace
}  // namespace sightline::testing
