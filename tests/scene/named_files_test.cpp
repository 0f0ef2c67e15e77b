// Files that a model names: which ones are opened, how often, and how they are found.
#include "scene/load/named_files.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>

#include "scene/meshes.hpp"
#include "support/files.hpp"

namespace sightline {
namespace {

namespace fs = std::filesystem;
using load::NamedFiles;
using scene_test::load_one;
using scene_test::loaded;
using scene_test::message_of;
using testing::TemporaryFolder;
using Verdict = NamedFiles::Verdict;

const std::string kFace = "v 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl m\nf 1 2 3\n";
const std::string kRed = "newmtl m\nKd 1 0 0\n";

/// Folders a, a/models, a/models/below, a/textures and b; files in them, and models/x.obj.
class NamedFilesTest : public ::testing::Test {
protected:
    NamedFilesTest() {
        for (const char* name : {"a/models/below", "a/textures", "b"}) {
            fs::create_directories(folder_.file(name));
        }
        for (const char* name :
             {"a/models/m.mtl", "a/models/below/m.mtl", "a/textures/m.mtl", "a/m.mtl", "b/m.mtl"}) {
            (void)folder_.write(name, kRed);
        }
        fs::create_symlink("../../b/m.mtl", folder_.file("a/models/link.mtl"));
        EXPECT_EQ(mkfifo(folder_.file("a/models/pipe.mtl").c_str(), 0600), 0);
    }
    [[nodiscard]] std::string model(const std::string& text) const {
        return folder_.write("a/models/x.obj", text);
    }
    TemporaryFolder folder_;
};

TEST_F(NamedFilesTest, LieInTheFolderOfTheModelOrBesideIt) {
    const std::string at = folder_.file("a/models/");
    const NamedFiles named(at + "x.obj", {});
    EXPECT_EQ(named.judge(at + "m.mtl"), Verdict::readable);
    EXPECT_EQ(named.judge(at + "below/m.mtl"), Verdict::readable);
    EXPECT_EQ(named.judge(at + "../textures/m.mtl"), Verdict::readable);
    EXPECT_EQ(named.judge(at + "below/../m.mtl"), Verdict::readable);
    EXPECT_EQ(named.judge(at + "none.mtl"), Verdict::missing);
    EXPECT_EQ(named.judge(at + "../m.mtl"), Verdict::outside);
    EXPECT_EQ(named.judge(at + "../../b/m.mtl"), Verdict::outside);
    EXPECT_EQ(named.judge(at + "../../b/none.mtl"), Verdict::outside);
    EXPECT_EQ(named.judge(at + "link.mtl"), Verdict::outside);
    EXPECT_EQ(named.judge("/etc/passwd"), Verdict::outside);
    EXPECT_EQ(named.judge(at + "pipe.mtl"), Verdict::special);
    EXPECT_EQ(named.judge(at + "below"), Verdict::special);
    // A folder whose name begins alike is another one.
    EXPECT_EQ(named.judge(at + "../models2/m.mtl"), Verdict::outside);
}

TEST_F(NamedFilesTest, MayLieWhereTheUserAllowsThem) {
    const std::string at = folder_.file("a/models/");
    const NamedFiles named(at + "x.obj", {folder_.file("b")});
    EXPECT_EQ(named.judge(at + "../../b/m.mtl"), Verdict::readable);
    EXPECT_EQ(named.judge(at + "link.mtl"), Verdict::readable);
    EXPECT_EQ(named.judge(at + "../m.mtl"), Verdict::outside);
    const NamedFiles all("", {"/"});
    EXPECT_EQ(all.judge(at + "m.mtl"), Verdict::readable);
    EXPECT_EQ(all.judge("/dev/zero"), Verdict::special);
    EXPECT_EQ(all.judge("/proc/self/status"), Verdict::special);
}

TEST_F(NamedFilesTest, AMaterialLibraryOutsideIsAWarning) {
    for (const char* name : {"../m.mtl", "link.mtl", "../../b/m.mtl"}) {
        fs::remove(folder_.file("a/models/m.mtl"));
        const std::string path = model("mtllib " + std::string(name) + "\n" + kFace);
        const Scene scene = loaded(load_one(path));
        ASSERT_EQ(scene.notes.size(), 1u) << name;
        EXPECT_NE(scene.notes[0].find(name), std::string::npos) << scene.notes[0];
        EXPECT_NE(scene.notes[0].find("--allow-path"), std::string::npos) << scene.notes[0];
        EXPECT_NE(scene.materials[0].base_color, glm::vec3(1, 0, 0)) << name;
        LoadOptions options;
        options.allowed_paths = {folder_.file("a"), folder_.file("b")};
        EXPECT_EQ(loaded(load_one(path, options)).materials[0].base_color, glm::vec3(1, 0, 0));
    }
}

TEST_F(NamedFilesTest, PathsOfOtherSystemsAreFoundBesideTheModel) {
    for (const char* name : {"C:\\models of mine\\m.mtl", "/home/somebody/m.mtl", "below\\m.mtl",
                             "..\\textures\\m.mtl", "lost/m.mtl"}) {
        const Scene scene = loaded(load_one(model("mtllib " + std::string(name) + "\n" + kFace)));
        EXPECT_TRUE(scene.notes.empty()) << name;
        EXPECT_EQ(scene.materials[0].base_color, glm::vec3(1, 0, 0)) << name;
    }
    const Scene lost = loaded(load_one(model("mtllib C:\\x\\none.mtl\n" + kFace)));
    ASSERT_EQ(lost.notes.size(), 1u);
    EXPECT_NE(lost.notes[0].find("'C:\\x\\none.mtl' is missing"), std::string::npos);
}

TEST_F(NamedFilesTest, AMaterialLibraryIsReadOnce) {
    std::string large;
    for (int i = 0; i < 20'000; ++i) large += "newmtl n" + std::to_string(i) + "\nKd 0 1 0\n";
    (void)folder_.write("a/models/m.mtl", large + kRed);
    std::string text;
    for (std::size_t i = 0; i < 3'000; ++i) {
        text += i % 2 == 0 ? "mtllib m.mtl\n" : "mtllib " + std::string(i, '/') + "m.mtl\n";
        text += "mtllib below/../m.mtl\n";
    }
    LoadOptions options;
    options.time_limit_seconds = 10;  // reading it 6000 times takes longer
    EXPECT_EQ(loaded(load_one(model(text + kFace), options)).materials.size(), 20'001u);
}

TEST_F(NamedFilesTest, AByteOrderMarkIsSkipped) {
    (void)folder_.write("a/models/m.mtl", "\xef\xbb\xbf" + kRed);
    const Scene scene = loaded(load_one(model("\xef\xbb\xbfmtllib m.mtl\n" + kFace)));
    EXPECT_EQ(scene.materials[0].base_color, glm::vec3(1, 0, 0));
}

TEST_F(NamedFilesTest, BlackUnderATextureIsGrey) {
    (void)folder_.write("a/models/m.mtl",
                        "newmtl m\nKd 0 0 0\nmap_Kd wood.png\nnewmtl n\nKd 0 0 0\n");
    const Scene scene = loaded(load_one(model("mtllib m.mtl\n" + kFace + "usemtl n\nf 3 2 1\n")));
    EXPECT_GT(scene.materials[0].base_color.r, 0.2f);
    EXPECT_EQ(scene.materials[1].base_color, glm::vec3(0));
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_NE(scene.notes[0].find("wood.png"), std::string::npos);
}

TEST_F(NamedFilesTest, DevicesAndFilesOfTheKernelAreNoModels) {
    LoadOptions options;
    options.format = "obj";
    EXPECT_EQ(message_of(load_one("/dev/zero", options)), "/dev/zero: it is a device; name a file");
    EXPECT_EQ(message_of(load_one("/proc/self/maps", options)),
              "/proc/self/maps: it is a file of the kernel; name a file on a disk");
    const std::string pipe = folder_.file("a/models/pipe.mtl");
    EXPECT_EQ(message_of(load_one(pipe, options)),
              pipe + ": it is a pipe that nobody writes to; start what writes to it");
}

}  // namespace
}  // namespace sightline
