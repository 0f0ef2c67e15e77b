// Jobs that fail: exit status 1, one line, and neither a new file nor harm to an old one.
#include "cli/run_program.hpp"

namespace sightline::testing {
namespace {

class FailedJob : public ProgramTest {
protected:
    void expect_failed(const std::string& model, std::initializer_list<std::string> needles) const {
        expect_failure(1, {"render", model, "-o", "a.png"}, needles);
    }
};

TEST_F(FailedJob, BadModels) {
    expect_failed("missing.obj", {"missing.obj"});
    write("empty.obj", "");
    expect_failed("empty.obj", {"empty.obj"});
    write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    expect_failed("points.obj", {"points.obj"});
    write("what.xyzzy", kCube);
    expect_failed("what.xyzzy", {"what.xyzzy"});
    write("truncated.ply",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
          "property float y\nproperty float z\nelement face 1\n"
          "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n");
    expect_failed("truncated.ply", {"truncated.ply"});
    write("bad.json", "{ \"models\": [ ");
    expect_failed("bad.json", {"bad.json"});
    fs::create_directory(folder_ / "folder.obj");
    expect_failed("folder.obj", {"folder.obj"});
}

TEST_F(FailedJob, AllCommandsReportTheFile) {
    for (const char* command : {"info", "compare", "bench"}) {
        expect_failure(1, {command, "missing.obj"}, {"missing.obj"});
    }
    expect_failure(1, {"info", "-", "--format", "obj"}, {"standard input"}, "v 0 0 0\n");
}

TEST_F(FailedJob, BadPlacesAreFoundBeforeTheModelIsRead) {
    expect_failure(1, {"render", "missing.obj", "-o", "no/such/a.png"}, {"-o", "'no/such'"});
    fs::create_directory(folder_ / "dir.png");
    expect_failure(1, {"render", "missing.obj", "-o", "dir.png"}, {"-o", "dir.png", "folder"});
    expect_failure(1, {"render", "cube.obj", "-o", "a.png", "--depth", "no/d.npy"}, {"--depth"});
}

TEST_F(FailedJob, AnOldFileStays) {
    write("old.png", "precious");
    expect_failed("missing.obj", {"missing.obj"});
    expect_failure(1, {"render", "missing.obj", "-o", "old.png"}, {"missing.obj"});
    expect_failure(2, {"render", "cube.obj", "-o", "old.png", "--fov", "0"}, {"--fov"});
    EXPECT_EQ(read("old.png"), "precious");
}

TEST_F(FailedJob, AFullDiskLeavesNoneOfSeveralFiles) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "needs /dev/full";
    write("old.npy", "precious");
    fs::create_symlink("/dev/full", folder_ / "full.png");
    expect_failure(1,
                   {"render", "cube.obj", "-o", "full.png", "--depth", "old.npy", "--ids", "i.npy"},
                   {"full.png"});
    EXPECT_EQ(read("old.npy"), "precious");
}

}  // namespace
}  // namespace sightline::testing
