// Standard streams that are closed, full or read by nobody.
#include "operation/shell.hpp"

namespace sightline::testing {
namespace {

class Streams : public ShellTest {
protected:
    void SetUp() override {
        ShellTest::SetUp();
        ASSERT_EQ(run(words("whole.png", "whole.npy")).status, 0);
        picture_ = read("whole.png");
        depths_ = read("whole.npy");
    }

    /// Two files and a warning.
    static std::vector<std::string> words(const std::string& picture, const std::string& depths) {
        return {"render", "cube.obj", "--projection", "orthographic", "--fov",
                "30",     "-o",       picture,        "--depth",      depths};
    }
    static std::string command() {
        std::string all = "$S";
        for (const std::string& word : words("a.png", "d.npy")) all += " " + word;
        return all;
    }
    void expect_pictures(const std::string& streams) const {
        SCOPED_TRACE(streams);
        fs::remove(folder_ / "a.png");
        fs::remove(folder_ / "d.npy");
        EXPECT_EQ(shell(command() + " " + streams).status, 0);
        EXPECT_EQ(read("a.png"), picture_);
        EXPECT_EQ(read("d.npy"), depths_);
        EXPECT_EQ(temporary_files(), std::vector<std::string>{});
    }
    /// Status and standard error of a command whose output nobody reads.
    [[nodiscard]] Outcome unread(const std::string& arguments) const {
        Outcome outcome = shell("{ sleep 0.1; $S " + arguments + "; echo $? >status; } | true");
        outcome.status = std::stoi("0" + read("status"));
        return outcome;
    }

    std::string picture_, depths_;
};

TEST_F(Streams, ClosedOnesDoNotHarmAJobThatNeedsNone) {
    expect_pictures("<&-");
    expect_pictures(">&-");
    expect_pictures("2>&-");
    expect_pictures("<&- >&- 2>&-");
    expect_pictures("2>/dev/full");
    expect_pictures("--stats 2>&-");
}

TEST_F(Streams, WhatIsForAClosedOrFullOutputIsAnError) {
    for (const std::string command : {"$S info cube.obj", "$S --help", "$S visible cube.obj --json",
                                      "$S render cube.obj -o - --output-format png",
                                      "$S render cube.obj -o - --output-format exr"}) {
        for (const std::string stream : {" >&-", " >/dev/full", " <&- >&-"}) {
            SCOPED_TRACE(command + stream);
            const Outcome outcome = shell(command + stream);
            EXPECT_EQ(outcome.status, 1);
            EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
            EXPECT_NE(outcome.err.find("standard output"), std::string::npos) << outcome.err;
        }
    }
    EXPECT_EQ(shell("$S info cube.obj >&- 2>&-").status, 1);
    EXPECT_EQ(shell("$S info - --format obj <&-").status, 1);
    EXPECT_EQ(shell("$S info missing.obj 2>/dev/full").status, 1);
    EXPECT_EQ(shell("$S info --no-such 2>&-").status, 2);
}

TEST_F(Streams, AReaderThatGoesAwayEndsTheProgramQuietly) {
    for (const std::string arguments :
         {"--help", "info cube.obj", "info cube.obj --json", "visible cube.obj",
          "render cube.obj -o - --output-format png", "render cube.obj -o - --output-format exr"}) {
        SCOPED_TRACE(arguments);
        const Outcome outcome = unread(arguments);
        EXPECT_EQ(outcome.status, 141);
        EXPECT_EQ(outcome.err, "");
    }
}

TEST_F(Streams, WarningsThatNobodyReadsStopNothing) {
    static_cast<void>(shell("{ sleep 0.1; " + command() + "; echo $? >status; } 2>&1 | true"));
    EXPECT_EQ(read("status"), "0\n");
    EXPECT_EQ(read("a.png"), picture_);
}

TEST_F(Streams, ControlCharactersReachNoTerminal) {
    const Outcome missing = shell("$S info \"$(printf 'a\\033[31mb\\nc\\302\\233.obj')\"");
    EXPECT_EQ(missing.status, 1);
    EXPECT_EQ(missing.error_lines(), 1) << missing.err;
    EXPECT_NE(missing.err.find("a?[31mb?c?"), std::string::npos) << missing.err;
    write("scene.json", R"({"models":[{"path":"tri.obj\u001b[31m\n.obj"}]})");
    const Outcome scene = run({"info", "scene.json"});
    EXPECT_EQ(scene.err.find('\x1b'), std::string::npos);
    EXPECT_EQ(scene.error_lines(), 1) << scene.err;
    write("o.obj", "o \x1b[2J\xc2\x9bx\n" + kCube.substr(kCube.find('v')));
    for (const std::string command : {"info", "visible"}) {
        const Outcome outcome = run({command, "o.obj"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.out.find('\x1b'), std::string::npos);
        EXPECT_EQ(outcome.out.find("\xc2\x9b"), std::string::npos);
    }
}

TEST_F(Streams, NamesOfSceneFilesAndJsonAreClean) {
    write("scene.json",
          R"({"models":[{"path":"cube.obj","name":"\t=1\u001b[31m\nY\u009b31m\r\u0000\u202eZ"}]})");
    for (const std::string format : {"--csv", "--json"}) {
        const Outcome outcome = run({"visible", "scene.json", "--by", "object", format});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_NE(outcome.out.find("?=1?[31m?Y??31m?????Z"), std::string::npos) << outcome.out;
    }
    write("scene.json", R"({"models":[{"path":"cube.obj","name":" =1+1"}]})");
    const Outcome formula = run({"visible", "scene.json", "--by", "object"});
    EXPECT_NE(formula.out.find("\"' =1+1\""), std::string::npos) << formula.out;
}

TEST_F(Streams, NamesThatLookLikeFormulasAreTextInCsv) {
    const std::string mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    write("names.obj",
          mesh + "o =1+2\nf 1 2 3\no @x\"\nf 1 2 3\no -5\nf 1 2 3\no plain\nf 1 2 3\n");
    const Outcome outcome = run({"visible", "names.obj", "--by", "object"});
    EXPECT_NE(outcome.out.find("0,\"'=1+2\","), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("1,\"'@x\"\"\","), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("2,-5,"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("3,plain,"), std::string::npos) << outcome.out;
}

TEST_F(Streams, InfoIsLinearInObjectsAndMaterials) {
    std::string model, library;
    const int count = 20'000;  // took 16 s
    for (int i = 0; i < count; ++i) {
        const std::string n = std::to_string(i);
        library += "newmtl m" + n + "\nKd 1 0 0\n";
        model += "o o" + n + "\nv " + n + " 0 0\nv " + n + " 1 0\nv " + n + ".5 0 1\nusemtl m" + n +
                 "\nf -3 -2 -1\n";
    }
    write("many.mtl", library);
    write("many.obj", "mtllib many.mtl\n" + model);
    const auto begun = std::chrono::steady_clock::now();
    const Outcome outcome = run({"info", "many.obj"});
    const auto taken = std::chrono::steady_clock::now() - begun;
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n') / 10'000, 4);
#ifndef SIGHTLINE_SANITIZED
    EXPECT_LT(taken, std::chrono::seconds(5));
#else
    static_cast<void>(taken);
#endif
}

}  // namespace
}  // namespace sightline::testing
