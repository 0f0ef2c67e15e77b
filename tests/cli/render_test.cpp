// `render`: the files that it promises, whatever the way of asking.
#include <cmath>

#include "cli/run_program.hpp"

namespace sightline::testing {
namespace {

class Render : public ProgramTest {
protected:
    void expect_done(std::vector<std::string> options,
                     const std::string& model = "cube.obj") const {
        std::vector<std::string> words = {"render", model, "--resolution", "40x30"};
        words.insert(words.end(), options.begin(), options.end());
        const Outcome outcome = run(words);
        std::string shown;
        for (const std::string& word : words) shown += " " + word;
        EXPECT_EQ(outcome.status, 0) << shown << "\n" << outcome.err;
        EXPECT_EQ(outcome.err, "") << shown;
        EXPECT_EQ(outcome.out, "") << shown;
    }
    /// Little-endian values of an NPY file.
    template <class T>
    [[nodiscard]] std::vector<T> values(const std::string& name) const {
        const std::string bytes = read(name);
        EXPECT_TRUE(bytes.starts_with("\x93NUMPY\x01")) << name;
        if (bytes.size() < 10) return {};
        const std::size_t start = 10u + static_cast<unsigned char>(bytes[8]) +
                                  256u * static_cast<unsigned char>(bytes[9]);
        std::vector<T> result((bytes.size() - start) / sizeof(T));
        std::copy_n(bytes.data() + start, result.size() * sizeof(T),
                    reinterpret_cast<char*>(result.data()));
        return result;
    }
};

TEST_F(Render, WritesEveryFormat) {
    expect_done({"-o", "a.png"});
    EXPECT_EQ(png_size(read("a.png")), (std::array{40u, 30u}));
    expect_done({"-o", "a.EXR", "--aov", "normals,ids"});
    EXPECT_TRUE(read("a.EXR").starts_with("\x76\x2f\x31\x01"));
    for (const char* channel : {"N.X", "object", "triangle", "Z"}) {
        EXPECT_NE(read("a.EXR").find(channel), std::string::npos) << channel;
    }
    expect_done({"--output", "a.npy"});
    EXPECT_EQ(values<float>("a.npy").size(), 40u * 30 * 4);
}

TEST_F(Render, WritesMapsTogetherAndAlone) {
    expect_done({"-o", "a.png", "--depth", "d.npy", "--ids", "i.npy", "--normals", "n.npy",
                 "--mask", "m.npy"});
    const auto depth = values<float>("d.npy");
    const auto ids = values<std::uint32_t>("i.npy");
    const auto mask = values<std::uint8_t>("m.npy");
    EXPECT_EQ(values<float>("n.npy").size(), 40u * 30 * 3);
    ASSERT_EQ(depth.size(), 1200u);
    ASSERT_EQ(ids.size(), 1200u);
    ASSERT_EQ(mask.size(), 1200u);
    std::size_t covered = 0;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const bool seen = ids[i] != 0xFFFFFFFFu;
        covered += seen ? 1 : 0;
        EXPECT_TRUE(!seen || ids[i] < 12) << ids[i];
        EXPECT_EQ(std::isinf(depth[i]), !seen);
        EXPECT_EQ(mask[i] != 0, seen);
    }
    EXPECT_GT(covered, 100u);
    EXPECT_LT(covered, 1200u);
    EXPECT_EQ(files().size(), 6u);

    for (const char* option : {"--depth", "--ids", "--normals", "--mask"}) {
        expect_done({option, "alone.png"});
        EXPECT_EQ(png_size(read("alone.png")), (std::array{40u, 30u})) << option;
    }
    for (const char* option : {"--depth", "--ids", "--normals"}) {
        expect_done({option, "alone.exr"});
        EXPECT_TRUE(read("alone.exr").starts_with("\x76\x2f\x31\x01")) << option;
    }
}

TEST_F(Render, IdsAreThoseAtTheCentreWhateverTheSamples) {
    expect_done({"-o", "a.png", "--ids", "one.npy", "--depth", "d1.npy"});
    expect_done({"-o", "b.png", "--ids", "sixteen.npy", "--depth", "d16.npy", "--samples", "16"});
    EXPECT_EQ(read("one.npy"), read("sixteen.npy"));
    EXPECT_EQ(read("d1.npy"), read("d16.npy"));
    EXPECT_NE(read("a.png"), read("b.png"));
}

TEST_F(Render, ThreadsAndAlgorithmsGiveTheSameBytes) {
    expect_done({"-o", "one.png", "--ids", "one.npy", "--threads", "1"});
    expect_done({"-o", "two.png", "--ids", "two.npy", "--threads", "2"});
    expect_done({"-o", "brute.png", "--ids", "brute.npy", "--algorithm", "brute"});
    EXPECT_EQ(read("one.png"), read("two.png"));
    EXPECT_EQ(read("one.png"), read("brute.png"));
    EXPECT_EQ(read("one.npy"), read("brute.npy"));
}

TEST_F(Render, ValuesMayBeginWithAMinus) {
    expect_done({"--direction", "-1,-1,-1", "-o", "a.png"});
    expect_done({"--direction=-1,-1,-1", "-o", "b.png"});
    expect_done({"--eye", "-3,-.5,-2", "--target", "-1e-1,0,0", "-o", "c.png"});
    expect_done({"--projection", "orthographic", "--near", "-5", "--far", "50", "-o", "d.png"});
    expect_done({"--oblique-angle", "-30", "--projection", "cabinet", "-o", "e.png"});
    EXPECT_EQ(read("a.png"), read("b.png"));
    // (1, 1, 1) is where the isometric eye stands.
    expect_done({"--view", "isometric", "-o", "iso.png"});
    EXPECT_EQ(read("a.png"), read("iso.png"));
}

TEST_F(Render, EveryLook) {
    for (const char* shading : {"flat", "gouraud", "phong", "unlit", "depth", "normals", "ids"}) {
        expect_done({"--shading", shading, "-o", std::string(shading) + ".png"});
    }
    EXPECT_NE(read("flat.png"), read("ids.png"));
    expect_done({"--background", "none", "-o", "none.png"});
    expect_done({"--background", "#ff0000", "-o", "hex.png"});
    expect_done({"--background", "255, 0, 0", "-o", "list.png"});
    EXPECT_EQ(read("hex.png"), read("list.png"));
    EXPECT_NE(read("hex.png"), read("none.png"));
    for (const char* cull : {"auto", "none", "back", "front"}) {
        expect_done({"--cull", cull, "-o", std::string(cull) + ".png"});
    }
    EXPECT_EQ(read("auto.png"), read("none.png"));
    EXPECT_NE(read("auto.png"), read("front.png"));
}

TEST_F(Render, EverySpellingOfAnOption) {
    for (const char* spelling : {"-os.png", "-o=s.png", "--output=s.png"}) {
        fs::remove(folder_ / "s.png");
        expect_done({spelling});
        EXPECT_TRUE(exists("s.png")) << spelling;
    }
}

TEST_F(Render, TheLastOfAnOptionCounts) {
    expect_done({"--fov", "10", "--fov", "60", "-o", "a.png"});
    expect_done({"--fov", "60", "-o", "b.png"});
    EXPECT_EQ(read("a.png"), read("b.png"));
}

TEST_F(Render, TranslucencyIsWarnedOfOnce) {
    const std::vector<std::string> words = {"render",       "cube.obj", "-o",        "a.png",
                                            "--resolution", "8x8",      "--opacity", "cube=0.5"};
    const Outcome loud = run(words);
    EXPECT_EQ(loud.status, 0);
    EXPECT_EQ(loud.error_lines(), 1) << loud.err;
    EXPECT_NE(loud.err.find("opaque"), std::string::npos);
    auto quiet = words;
    quiet.push_back("--quiet");
    EXPECT_EQ(run(quiet).err, "");
}

TEST_F(Render, Streams) {
    expect_done({"-o", "a.png"});
    const Outcome outcome = run({"render", "-", "--format", "obj", "-o", "-", "--output-format",
                                 "png", "--resolution", "40x30"},
                                kCube);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.out, read("a.png"));
    expect_done({"-o", "strange.name", "--output-format", "png"});
    EXPECT_EQ(read("strange.name"), read("a.png"));
}

TEST_F(Render, SeveralModelsAndOddNames) {
    fs::create_directory(folder_ / "an odd, näme");
    write("an odd, näme/-x.obj", kCube);
    write("-5.obj", kCube);
    const Outcome outcome = run({"render", "cube.obj", "an odd, näme/-x.obj", "--ids",
                                 "an odd, näme/i.npy", "--resolution", "8x8", "--", "-5.obj"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(exists("an odd, näme/i.npy"));
}

TEST_F(Render, ReplacesThroughLinksAndKeepsPermissions) {
    write("real.png", "old");
    write("real.npy", "old");
    fs::permissions(folder_ / "real.npy", fs::perms(0640));
    fs::create_symlink("real.png", folder_ / "link.png");
    expect_done({"-o", "link.png", "--ids", "real.npy"});
    EXPECT_TRUE(fs::is_symlink(folder_ / "link.png"));
    EXPECT_EQ(png_size(read("real.png")), (std::array{40u, 30u}));
    EXPECT_EQ(fs::status(folder_ / "real.npy").permissions(), fs::perms(0640));
}

}  // namespace
}  // namespace sightline::testing
