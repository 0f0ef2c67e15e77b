// Every file that can't be used: one line that names it, the cause and the way out.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "scene/meshes.hpp"
#include "sightline/load.hpp"
#include "support/files.hpp"

namespace sightline {
namespace {

using scene_test::load_one;
using scene_test::load_text;
using scene_test::message_of;
using scene_test::raw;
using testing::TemporaryFolder;

const std::string kPoints = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";

TEST(BadInput, MissingFilesAndFolders) {
    const TemporaryFolder folder;
    const std::string missing = folder.path() + "/nothing.obj";
    const Result<Scene> result = load_one(missing);
    EXPECT_EQ(message_of(result),
              missing + ": cannot read it: No such file or directory; check the path");
    EXPECT_EQ(result.error().kind, ErrorKind::io);
    EXPECT_EQ(message_of(load_one(folder.path())),
              folder.path() + ": it is a folder; name a model file in it");
}

TEST(BadInput, NoModels) { EXPECT_EQ(load_scene({}).error().kind, ErrorKind::bad_option); }

TEST(BadInput, UnknownFormats) {
    const TemporaryFolder folder;
    const std::string known =
        "; known ones are obj, ply, stl, off, gltf, glb, dae, fbx, 3ds, json and more (or name it "
        "with --format)";
    const std::string path = folder.write("a.xyz", "1 2 3\n");
    EXPECT_EQ(message_of(load_one(path)), path + ": unknown format 'xyz'" + known);
    const std::string bare = folder.write("bare", "1 2 3\n");
    EXPECT_EQ(message_of(load_one(bare)), bare + ": no extension that tells its format" + known);
    EXPECT_EQ(message_of(load_text("x", "xyz")), "input.xyz: unknown format 'xyz'" + known);
}

TEST(BadInput, EmptyFiles) {
    const TemporaryFolder folder;
    for (const char* name : {"a.obj", "a.ply", "a.stl", "a.json"}) {
        const std::string path = folder.write(name, "");
        EXPECT_EQ(message_of(load_one(path)), path + ": it is empty; give it a model");
    }
    EXPECT_EQ(message_of(load_text("", "obj")), "input.obj: it is empty; give it a model");
}

TEST(BadInput, TooLargeAFile) {
    const TemporaryFolder folder;
    LoadOptions options;
    options.file_limit_bytes = 10;
    const std::string path = folder.write("a.obj", kPoints + "f 1 2 3\n");
    EXPECT_NE(message_of(load_one(path, options)).find("use a smaller model"), std::string::npos);
}

TEST(BadInput, TruncatedFiles) {
    const std::string stl = std::string(80, ' ') + raw(std::uint32_t{2}) + std::string(60, '\0');
    EXPECT_NE(message_of(load_text(stl, "stl")).find("not a readable stl file"), std::string::npos);
    const std::string ply =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float "
        "y\nproperty float z\nelement face 1\nproperty list uchar int "
        "vertex_indices\nend_header\n" +
        std::string(20, '\0');
    (void)message_of(load_text(ply, "ply"));
    const std::string off = "OFF\n3 2 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n";
    EXPECT_NE(message_of(load_text(off, "off")).find("not a readable off file"), std::string::npos);
}

TEST(BadInput, Nonsense) {
    std::string bytes;
    for (int i = 0; i < 5000; ++i) bytes += static_cast<char>(i * i % 251);
    for (const char* format : {"obj", "ply", "stl", "off", "gltf", "glb", "dae", "fbx", "3ds"}) {
        (void)message_of(load_text(bytes, format));
    }
}

TEST(BadInput, NoTriangles) {
    EXPECT_EQ(
        message_of(load_text(kPoints + "l 1 2\nl 2 3\n", "obj")),
        "input.obj: no triangles in it (2 points and lines, which are not drawn); use a model "
        "with faces");
}

TEST(BadInput, Coordinates) {
    EXPECT_NE(message_of(load_text(kPoints + "v nan 0 0\nf 1 2 4\n", "obj")).find("not a number"),
              std::string::npos);
    EXPECT_NE(message_of(load_text(kPoints + "v 1e999 0 0\nf 1 2 4\n", "obj")).find("infinite"),
              std::string::npos);
    for (const std::string large : {"1e31", "1e39"})  // below and beyond the largest float
        EXPECT_NE(message_of(load_text(kPoints + "v " + large + " 0 0\nf 1 2 4\n", "obj"))
                      .find("beyond 1e30"),
                  std::string::npos);
}

TEST(BadInput, IndicesOutOfRange) {
    EXPECT_EQ(
        message_of(load_text(kPoints + "f 1 2 9\n", "obj")),
        "input.obj:4: face refers to vertex 9, but there are 3; repair the line or export the "
        "file again");
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
        "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 "
        "0\n1 1 0\n3 0 1 9\n";
    EXPECT_EQ(
        message_of(load_text(ply, "ply")),
        "input.ply:13: face refers to vertex 9, but there are 3; repair the line or export the "
        "file again");
    EXPECT_NE(message_of(load_text("OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 9\n", "off"))
                  .find("out of range"),
              std::string::npos);
}

TEST(BadInput, OnePoint) {
    EXPECT_EQ(
        message_of(load_text("v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n", "obj")),
        "input.obj: a scene of one point: every corner is at (1, 2, 3); use a model that has a "
        "size");
}

TEST(BadInput, TooSmallToCompute) {
    EXPECT_EQ(message_of(load_text("v 0 0 0\nv 2e-31 0 0\nv 0 1e-120 0\nf 1 2 3\n", "obj")),
              "input.obj: a scene of size 2e-31, and none below 1e-30 can be drawn; use larger "
              "numbers");
    EXPECT_TRUE(load_text("v 0 0 0\nv 2e-30 0 0\nv 0 2e-30 0\nf 1 2 3\n", "obj"));
}

TEST(BadInput, TimeLimit) {
    LoadOptions options;
    options.format = "obj";
    options.time_limit_seconds = 1e-9;
    const std::string text = kPoints + "f 1 2 3\n";
    const Result<Scene> result =
        load_scene_from_memory(std::as_bytes(std::span(text)), "slow.obj", options);
    EXPECT_EQ(message_of(result),
              "slow.obj: reading it took longer than 1e-09 s; use a smaller or repaired file");
    EXPECT_EQ(result.error().kind, ErrorKind::bad_input);
}

TEST(BadInput, MemoryLimit) {
    LoadOptions options;
    options.format = "obj";
    options.memory_limit_bytes = 100;
    const std::string text = kPoints + "f 1 2 3\n";
    const Result<Scene> result =
        load_scene_from_memory(std::as_bytes(std::span(text)), "large.obj", options);
    EXPECT_NE(message_of(result).find("memory"), std::string::npos);
}

TEST(BadInput, PipesAreReadButOnlyOnce) {
    const TemporaryFolder folder;
    const std::string path = folder.path() + "/pipe.obj";
    ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
    const std::string text = kPoints + "f 1 2 3\n";
    std::FILE* const both = std::fopen(path.c_str(), "r+");  // does not block on Linux
    ASSERT_NE(both, nullptr);
    std::fputs(text.c_str(), both);
    std::fflush(both);
    LoadOptions options;
    options.file_limit_bytes = text.size() - 1;  // the end of file never comes
    EXPECT_NE(message_of(load_one(path, options)).find("use a smaller model"), std::string::npos);
    std::fclose(both);
}

}  // namespace
}  // namespace sightline
