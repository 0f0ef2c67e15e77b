// The A-buffer on the command line: deep files, mattes, holdouts; and pictures made part by part.
#include <cstring>

#include "cli/run_program.hpp"

namespace sightline::testing {
namespace {

class ABufferCommand : public ProgramTest {
protected:
    void expect_done(std::vector<std::string> words) const {
        const Outcome outcome = run(words);
        std::string shown;
        for (const std::string& word : words) shown += " " + word;
        EXPECT_EQ(outcome.status, 0) << shown << "\n" << outcome.err;
        EXPECT_EQ(outcome.err, "") << shown;
    }
    void expect_wrong_use(std::vector<std::string> words, const std::string& part) const {
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, 2) << outcome.err;
        EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
    }
};

const std::vector<std::string> kSmall = {"render", "cube.obj", "--resolution", "40x30"};

std::vector<std::string> with(std::vector<std::string> words,
                              const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

TEST_F(ABufferCommand, AtSamplesItIsTheZBuffer) {
    expect_done(with(kSmall, {"--samples", "4", "-o", "z.png", "--ids", "z.npy"}));
    expect_done(with(
        kSmall, {"--algorithm", "abuffer", "--samples", "4", "-o", "a.png", "--ids", "a.npy"}));
    EXPECT_EQ(read("a.png"), read("z.png"));
    EXPECT_EQ(read("a.npy"), read("z.npy"));
}

TEST_F(ABufferCommand, DeepFilesFlattenToThePicture) {
    const auto abuffer = with(kSmall, {"--algorithm", "abuffer", "--opacity", "0.6"});
    expect_done(with(abuffer, {"--deep", "-o", "deep.exr"}));
    EXPECT_NE(read("deep.exr").find("deepscanline"), std::string::npos);
    expect_done(with(abuffer, {"--background", "none", "-o", "flat.png"}));
    expect_done({"composite", "deep.exr", "-o", "joined.png"});
    EXPECT_EQ(read("joined.png"), read("flat.png"));
}

TEST_F(ABufferCommand, MattesAreTheAlphaWithoutABackground) {
    expect_done(with(kSmall, {"--algorithm", "abuffer", "--matte", "matte.npy", "-o", "p.png",
                              "--opacity", "0.5"}));
    const std::string bytes = read("matte.npy");
    ASSERT_GT(bytes.size(), 40u * 30 * 4);
    std::vector<float> matte(std::size_t{40} * 30);
    std::memcpy(matte.data(), bytes.data() + bytes.size() - matte.size() * 4, matte.size() * 4);
    EXPECT_EQ(matte.front(), 0);
    EXPECT_NEAR(matte[std::size_t{15} * 40 + 20], 0.75, 1e-6);  // two faces of the cube
}

TEST_F(ABufferCommand, HoldoutsTakeNames) {
    expect_wrong_use(with(kSmall, {"--holdout", "nobody", "-o", "p.png"}), "nobody");
    EXPECT_FALSE(exists("p.png"));
}

TEST_F(ABufferCommand, DeepNeedsTheABufferAndAnExr) {
    expect_wrong_use(with(kSmall, {"--deep", "-o", "p.exr"}), "--algorithm abuffer");
    const auto abuffer = with(kSmall, {"--algorithm", "abuffer", "--deep"});
    expect_wrong_use(with(abuffer, {"-o", "p.png"}), "EXR");
    expect_wrong_use(with(abuffer, {"-o", "p.exr", "--samples", "4"}), "--samples");
    expect_wrong_use(with(abuffer, {"-o", "p.exr", "--shading", "ids"}), "--shading ids");
    expect_wrong_use(with(abuffer, {"-o", "p.exr", "--aov", "ids"}), "--aov");
}

TEST_F(ABufferCommand, StreamedPicturesAreThoseOfTheWhole) {
    const std::vector<std::string> both = {"render", "cube.obj",  "cube.obj", "--resolution",
                                           "40x30",  "--samples", "4"};
    expect_done(with(both, {"-o", "whole.png", "--depth", "whole.npy"}));
    expect_done(with(both, {"--stream", "-o", "parts.png", "--depth", "parts.npy"}));
    EXPECT_EQ(read("parts.png"), read("whole.png"));
    EXPECT_EQ(read("parts.npy"), read("whole.npy"));
    expect_wrong_use(with(both, {"--stream", "--algorithm", "abuffer", "-o", "p.png"}), "A-buffer");
    expect_wrong_use(with(both, {"--stream", "--algorithm", "bsp", "-o", "p.png"}), "bsp");
    expect_wrong_use(with(both, {"--stream", "--opacity", "0.5", "-o", "p.png"}), "--opacity");
}

}  // namespace
}  // namespace sightline::testing
