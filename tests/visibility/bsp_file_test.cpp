// Files of trees: what is written comes back, and no file does harm.
#include <gtest/gtest.h>

#include "sightline/bsp.hpp"
#include "support/files.hpp"
#include "support/scenes.hpp"
#include "visibility/bsp_tree.hpp"

namespace sightline {
namespace {

using namespace testing;

/// As a stranger would who wants the file to be believed.
void correct_checksum(std::string& bytes) {
    std::uint64_t sum = 0xCBF29CE484222325u;
    for (std::size_t k = 0; k + 8 < bytes.size(); ++k)
        sum = (sum ^ static_cast<unsigned char>(bytes[k])) * 0x100000001B3u;
    for (std::size_t k = 0; k < 8; ++k)
        bytes[bytes.size() - 8 + k] = static_cast<char>(sum >> (8 * k));
}

class BspFile : public ::testing::Test {
protected:
    [[nodiscard]] std::string path(const char* name) const { return folder_.file(name); }

    /// Loads what may be anything; a tree that comes of it is used.
    bool try_to_use(const std::string& bytes) {
        write_file(path("tried"), bytes);
        const Result<BspTree> tree = load_bsp(path("tried"), scene_);
        if (!tree) {
            EXPECT_EQ(tree.error().kind, ErrorKind::bad_input) << tree.error().message;
            EXPECT_NE(tree.error().message.find("tried: "), std::string::npos);
            EXPECT_EQ(tree.error().message.find('\n'), std::string::npos);
            return false;
        }
        ResolveOptions options;
        options.tree = &*tree;
        (void)run("bsp", screen_, options);
        return true;
    }

    TemporaryFolder folder_;
    Scene scene_ = SceneBuilder()
                       .triangle({-1, -1, 0}, {1, -1, 0}, {0, 1, 0.1})
                       .triangle({-1, 0, -1}, {1, 0.1, -1}, {0, 0, 1})
                       .triangle({0, -1, -1}, {0.1, 1, -1}, {0, 0, 1})
                       .build();
    ScreenScene screen_ = must(project(scene_, must(make_camera({}, scene_.bounds, {32, 24}))));
};

TEST_F(BspFile, ATreeComesBackAsItWas) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Scene scene = hostile_scene(seed);
        std::vector<std::uint8_t> moving(seed % 2 == 0 ? 0 : scene.triangles.size());
        for (std::size_t t = 0; t < moving.size(); t += 3) moving[t] = 1;
        const BspTree tree = must(build_bsp(scene, {0, moving}));
        (void)must(save_bsp(tree, path("tree")));
        const BspTree back = must(load_bsp(path("tree"), scene));
        const bsp::Tree &s = tree.data(), &t = back.data();
        EXPECT_TRUE(s.nodes == t.nodes && s.planes == t.planes && s.parts == t.parts &&
                    s.cuts == t.cuts && s.moving == t.moving && s.grid.step == t.grid.step &&
                    s.grid.origin == t.grid.origin && s.fingerprint == t.fingerprint);
        (void)must(save_bsp(back, path("again")));
        EXPECT_EQ(read_file(path("tree")), read_file(path("again")));
    }
}

TEST_F(BspFile, AnyNumberOfThreadsGivesTheSameBytes) {
    const Scene scene = sphere_scene(50, 70);
    (void)must(save_bsp(must(build_bsp(scene, {1, {}})), path("one")));
    (void)must(save_bsp(must(build_bsp(scene, {8, {}})), path("eight")));
    EXPECT_EQ(read_file(path("one")), read_file(path("eight")));
}

TEST_F(BspFile, TheTreeOfAnotherSceneIsRefused) {
    (void)must(save_bsp(must(build_bsp(scene_)), path("tree")));
    Scene other = scene_;
    other.positions[0].x += 1e-9;
    finish_scene(other);
    for (const Scene& scene : {other, hostile_scene(2)}) {
        const Result<BspTree> tree = load_bsp(path("tree"), scene);
        ASSERT_FALSE(tree.ok());
        EXPECT_EQ(tree.error().kind, ErrorKind::bad_input);
        EXPECT_NE(tree.error().message.find("another scene"), std::string::npos);
    }
}

TEST_F(BspFile, WhatMovesMayStandElsewhere) {
    const std::vector<std::uint8_t> moving{0, 0, 1};
    (void)must(save_bsp(must(build_bsp(scene_, {0, moving})), path("tree")));
    Scene other = scene_;
    other.positions[other.triangles[2].x].x += 0.5;
    finish_scene(other);
    EXPECT_TRUE(load_bsp(path("tree"), other).ok());
}

TEST_F(BspFile, FilesThatAreCutOffAreRefused) {
    (void)must(save_bsp(must(build_bsp(scene_)), path("tree")));
    const std::string bytes = read_file(path("tree"));
    for (std::size_t size = 0; size < bytes.size(); ++size)
        EXPECT_FALSE(try_to_use(bytes.substr(0, size))) << size;
    std::string longer = bytes;
    longer.push_back(0);
    EXPECT_FALSE(try_to_use(longer));
    EXPECT_TRUE(try_to_use(bytes));
}

TEST_F(BspFile, EveryChangedByteIsNoticed) {
    (void)must(save_bsp(must(build_bsp(scene_)), path("tree")));
    const std::string bytes = read_file(path("tree"));
    for (std::size_t k = 0; k < bytes.size(); ++k) {
        for (const int change : {0x01, 0x80, 0xFF}) {
            std::string changed = bytes;
            changed[k] = static_cast<char>(changed[k] ^ change);
            EXPECT_FALSE(try_to_use(changed)) << k;
        }
    }
}

// With a right checksum it may pass for a tree, but not as one that is walked for ever or that
// points anywhere else.
TEST_F(BspFile, FilesOfStrangersDoNoHarm) {
    (void)must(save_bsp(must(build_bsp(scene_)), path("tree")));
    const std::string bytes = read_file(path("tree"));
    Random random(1);
    int taken = 0;
    for (int k = 0; k < 4000; ++k) {
        std::string changed = bytes;
        for (std::uint32_t times = 1 + random.below(3); times > 0; --times) {
            const std::uint32_t at = random.below(static_cast<std::uint32_t>(bytes.size() - 8));
            changed[at] =
                static_cast<char>(random.chance(0.5) ? random.below(6) : random.below(256));
        }
        correct_checksum(changed);
        taken += try_to_use(changed);
    }
    EXPECT_LT(taken, 4000);
}

TEST_F(BspFile, WhatIsNoFileIsAnError) {
    EXPECT_EQ(load_bsp(path("nothing here"), scene_).error().kind, ErrorKind::io);
    EXPECT_EQ(load_bsp(path("."), scene_).error().kind, ErrorKind::io);
    EXPECT_FALSE(save_bsp(must(build_bsp(scene_)), path("no/such/folder/tree")).ok());
}

}  // namespace
}  // namespace sightline
