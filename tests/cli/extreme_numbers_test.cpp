// Numbers near the ends of what doubles can say, and other values that are hardly any.
#include <sys/stat.h>

#include "cli/run_program.hpp"

namespace sightline::testing {
namespace {

class Extremes : public ProgramTest {
protected:
    [[nodiscard]] static std::vector<std::string> render(const std::vector<std::string>& more) {
        std::vector<std::string> words = {"render",       "cube.obj", "-o",     "a.png",
                                          "--resolution", "40x30",    "--quiet"};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
    [[nodiscard]] std::string picture(const std::vector<std::string>& more) const {
        const Outcome outcome = run(render(more));
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return read("a.png");
    }
};

TEST_F(Extremes, AreWrongUseWhereSquaresOverflow) {
    const std::vector<std::vector<std::string>> all = {
        {"--fov", "1e-320"},          {"--zoom", "1e-320"},   {"--zoom", "1e300"},
        {"--ortho-height", "1e-320"}, {"--eye", "1e308,0,0"}, {"--target", "0,-1e308,0"},
        {"--near", "1e-308"},         {"--far", "1e-320"},    {"--far", "1e308"}};
    for (const auto& words : all) expect_failure(2, render(words), {words[0], "1e"});
    expect_failure(2, render({"--near", "1e-308", "--far", "2e-308"}), {"--near"});
    expect_failure(2, render({"--near", "1e-320", "--far", "1e308"}), {"1e"});
}

TEST_F(Extremes, DirectionsHaveAnyLength) {
    const std::string wanted = picture({"--direction", "-1,0,-1"});
    EXPECT_EQ(picture({"--direction", "-1e-320,0,-1e-320"}), wanted);
    EXPECT_EQ(picture({"--direction", "-1e308,0,-1e308", "--up", "0,1e-320,0"}), wanted);
    EXPECT_EQ(picture({"--eye", "0,0,0", "--target", "0,0,1e-320"}),
              picture({"--eye", "0,0,0", "--direction", "0,0,1"}));
    const auto point = [&](const std::string& direction) {
        const std::string text = run({"info", "cube.obj", "--vanishing-direction", direction}).out;
        return text.substr(text.find_last_of(' ', text.size() - 10));
    };
    EXPECT_EQ(point("-1e-300,0,-1e-300"), point("-1,0,-1"));
    EXPECT_EQ(point("-1e-300,0,-1e-300").find("inf"), std::string::npos);
}

TEST_F(Extremes, SmallScenesAreRefused) {
    write("tiny.obj", "v 0 0 0\nv 1e-300 0 0\nv 0 1e-300 0\nf 1 2 3\n");
    const Outcome outcome = run({"render", "tiny.obj", "-o", "a.png"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_NE(outcome.err.find("none below 1e-30 can be drawn"), std::string::npos) << outcome.err;
}

TEST_F(Extremes, EmptyNames) {
    expect_failure(2, render({"--holdout", ""}), {"--holdout", "empty"});
    write("nameless.obj", kCube.substr(kCube.find('v')));
    std::vector<std::string> words = render({"--opacity", "x=0.5"});
    words[1] = "nameless.obj";
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.err.find("mean ''"), std::string::npos) << outcome.err;
}

TEST_F(Extremes, PipesAreNotWaitedForInVain) {
    ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
    expect_failure(2, {"render", "pipe", "--format", "obj", "--stream", "-o", "a.png"},
                   {"--stream", "pipe"});
    expect_failure(1, {"render", "cube.obj", "-o", "pipe", "--output-format", "png"},
                   {"pipe", "nobody reads"});
}

}  // namespace
}  // namespace sightline::testing
