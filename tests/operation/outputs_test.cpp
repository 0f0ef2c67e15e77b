// Outputs among planted links, other writers, and inputs of the same name.
#include <sys/stat.h>

#include <cerrno>

#include "image/rename_all.hpp"
#include "image/temporary_file.hpp"
#include "operation/shell.hpp"

namespace sightline::testing {
namespace {

class OutputFiles : public ShellTest {};

TEST_F(OutputFiles, PlantedLinksAreNotFollowed) {
    write("victim", "precious");
    // The names that could be guessed: the shell's number is the program's.
    const Outcome outcome = shell(
        "for n in 0 1 2 3 4 5; do for e in staged tmp; do\n"
        "  ln -s victim .sightline-$$-$n.$e\n"
        "done; done\n"
        "exec $S render cube.obj -o a.png --depth d.npy --ids i.png");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(read("victim"), "precious");
    EXPECT_EQ(temporary_files().size(), 12u);  // the links
    EXPECT_EQ(png_size(read("a.png")), (std::array<unsigned, 2>{1024, 768}));
    EXPECT_EQ(png_size(read("i.png")), (std::array<unsigned, 2>{1024, 768}));
}

TEST_F(OutputFiles, TemporaryNamesAreNotTheSameTwice) {
    const TemporaryFile one(folder_), other(folder_);
    const std::string name = fs::path(one.path()).filename();
    EXPECT_NE(one.path(), other.path());
    EXPECT_EQ(name.size(), std::string(".sightline-.tmp").size() + 32);
    EXPECT_EQ(name.find(std::to_string(getpid())), std::string::npos);
}

TEST_F(OutputFiles, TwoWritersAtOnce) {
    const auto words = [](const std::string& view) {
        return std::vector<std::string>{"render",  "cube.obj", "--view", view,      "--resolution",
                                        "400x300", "-o",       "a.png",  "--depth", "d.npy"};
    };
    const fs::path other_streams = root_.file("other");
    fs::create_directories(other_streams);
    std::array<std::array<std::string, 2>, 2> wanted;
    for (const std::size_t k : {0u, 1u}) {
        ASSERT_EQ(run(words(k == 0 ? "front" : "isometric")).status, 0);
        wanted[k] = {read("a.png"), read("d.npy")};
    }
    for (int round = 0; round < 8; ++round) {
        Running one = start(words("front"));
        Running other(folder_, words("isometric"), "", other_streams);
        EXPECT_EQ(one.wait().status, 0);
        EXPECT_EQ(other.wait().status, 0);
        EXPECT_TRUE(read("a.png") == wanted[0][0] || read("a.png") == wanted[1][0]);
        EXPECT_TRUE(read("d.npy") == wanted[0][1] || read("d.npy") == wanted[1][1]);
        EXPECT_EQ(temporary_files(), std::vector<std::string>{});
    }
}

TEST_F(OutputFiles, AllAreRenamedOrNone) {
    write("one.tmp", "new one");
    write("two.tmp", "new two");
    write("three.tmp", "new three");
    write("one", "old one");
    fs::create_directories(folder_ / "three" / "inside");
    const auto path = [&](const std::string& name) { return (folder_ / name).string(); };
    std::vector<Renaming> renamings;
    for (const std::string name : {"one", "two", "three"}) {
        renamings.push_back({path(name + ".tmp"), path(name)});
    }
    const auto failed = rename_all(renamings);
    ASSERT_TRUE(failed.has_value());
    EXPECT_EQ(failed->index, 2u);
    EXPECT_EQ(failed->error_number, EISDIR);
    EXPECT_EQ(read("one"), "old one");
    EXPECT_EQ(read("one.tmp"), "new one");
    EXPECT_FALSE(exists("two"));
    EXPECT_EQ(read("two.tmp"), "new two");
    EXPECT_TRUE(exists("three/inside"));
    fs::remove_all(folder_ / "three");
    EXPECT_FALSE(rename_all(renamings).has_value());
    EXPECT_EQ(read("one"), "new one");
    EXPECT_EQ(read("two"), "new two");
    EXPECT_EQ(read("three"), "new three");
    EXPECT_EQ(files(), (std::vector<std::string>{"cube.obj", "one", "three", "two"}));
}

TEST_F(OutputFiles, AMissingFileTakesTheOthersBack) {
    write("one.tmp", "new");
    write("one", "old");
    const std::vector<Renaming> renamings = {
        {(folder_ / "one.tmp").string(), (folder_ / "one").string()},
        {(folder_ / "gone.tmp").string(), (folder_ / "gone").string()}};
    const auto failed = rename_all(renamings);
    ASSERT_TRUE(failed.has_value());
    EXPECT_EQ(failed->error_number, ENOENT);
    EXPECT_EQ(read("one"), "old");
    EXPECT_EQ(read("one.tmp"), "new");
}

TEST_F(OutputFiles, ThatAModelReadsAreWrongUse) {
    fs::create_directories(folder_ / "textures");
    write("m.obj", "mtllib m.mtl\nusemtl a\n" + kCube);
    write("m.mtl", "newmtl a\nKd 1 0 0\nmap_Kd textures\\wood.png\n");
    write("textures/wood.png", "a texture");
    write("scene.json", R"({"models":[{"path":"m.obj"}]})");
    write("g.gltf",
          R"({"asset":{"version":"2.0"},"buffers":[{"uri":"b.bin","byteLength":36}],)"
          R"("bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,)"
          R"("componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],)"
          R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],)"
          R"("scenes":[{"nodes":[0]}],"scene":0})");
    const std::array<float, 9> corners = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    write("b.bin", {reinterpret_cast<const char*>(corners.data()), sizeof corners});
    fs::create_symlink("m.mtl", folder_ / "link.mtl");
    for (const auto& [model, output] : {std::pair("m.obj", "m.mtl"),
                                        {"scene.json", "m.mtl"},
                                        {"scene.json", "./m.obj"},
                                        {"m.obj", "textures/wood.png"},
                                        {"scene.json", "textures/../textures/wood.png"},
                                        {"g.gltf", "b.bin"},
                                        {"m.obj", "link.mtl"}}) {
        for (const std::string command : {"render", "draw"}) {
            expect_failure(2, {command, model, "-o", output, "--output-format", "png"},
                           {"is an input", "choose another name"});
        }
        expect_failure(
            2, {"render", model, "-o", "a.png", "--depth", output, "--output-format", "png"}, {});
    }
    EXPECT_EQ(run({"render", "scene.json", "-o", "a.png"}).status, 0);
    EXPECT_EQ(run({"render", "g.gltf", "-o", "textures/new.png"}).status, 0);
}

TEST_F(OutputFiles, StandardOutputIsAPlaceLikeOthers) {
    write("m.obj", kCube);
    write("scene.json", R"({"models":[{"path":"m.obj"}]})");
    write("sun.txt", "0,0,-1\n");
    fs::create_hard_link(folder_ / "m.obj", folder_ / "link.obj");
    const std::string png = " -o - --output-format png ";
    for (const std::string& command :
         {"render m.obj" + png + "--ids ids.npy > ids.npy", "render m.obj" + png + ">> m.obj",
          "draw m.obj" + png + "1<> m.obj", std::string("visible m.obj 1<> m.obj"),
          std::string("info link.obj >> m.obj"),
          std::string("info - --format obj < m.obj >> m.obj"),
          std::string("info scene.json >> m.obj"), std::string("bench m.obj --frames 1 >> m.obj"),
          std::string("render m.obj -o a.png --json > a.png"),
          std::string("compare m.obj --difference a.png > a.png"),
          std::string("visible m.obj --from-directions sun.txt >> sun.txt"),
          std::string("render - --format obj -o m.obj --output-format png < m.obj")}) {
        SCOPED_TRACE(command);
        const Outcome outcome = shell("exec $S " + command);
        EXPECT_EQ(outcome.status, 2) << outcome.err;
        EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
        EXPECT_EQ(read("m.obj"), kCube);
        EXPECT_EQ(read("sun.txt"), "0,0,-1\n");
    }
    for (const std::string& command :
         {"render m.obj" + png + "> a.png", std::string("visible m.obj >> list.csv"),
          std::string("render m.obj -o /dev/stdout --output-format png > a.png"),
          std::string("render m.obj -o b.png > b.png"),
          std::string("render m.obj -o /dev/null --output-format png --json > /dev/null")}) {
        SCOPED_TRACE(command);
        const Outcome outcome = shell("exec $S " + command);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
    }
    EXPECT_EQ(png_size(read("a.png")), (std::array<unsigned, 2>{1024, 768}));
}

TEST_F(OutputFiles, PlacesThatAreNone) {
    write("file.txt", "no folder");
    expect_failure(1, {"render", "cube.obj", "-o", "file.txt/x.png"}, {"file.txt", "is a file"});
    expect_failure(1, {"plot", "y=x", "-o", "file.txt/x.svg"}, {"file.txt", "is a file"});
    expect_failure(1, {"render", "cube.obj", "-o", "none/x.png"}, {"none", "create it"});
    const Outcome outcome =
        shell("TMPDIR=/no/such/folder exec $S bench cube.obj --frames 1 --resolution 32x32");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("TMPDIR"), std::string::npos) << outcome.err;
}

TEST_F(OutputFiles, HeightsThatCannotBeDrawnAndLongFormulas) {
    write("huge.csv", "1e308,-1e308\n1e308,1e308\n");
    expect_failure(1, {"plot", "huge.csv", "-o", "x.svg"}, {"huge.csv", "1e+308", "-1e+308"});
    EXPECT_EQ(run({"plot", "huge.csv", "--height-scale", "1e-307", "-o", "x.svg"}).status, 0);
    std::string formula = "y = x";
    for (int i = 0; i < 500; ++i) formula += " + sin(x)";
    for (const std::string& wrong : {formula + " + q", formula + " = 1 = 2", std::string(3000, 'q'),
                                     formula + " + sqrt(0-1-x*x)"}) {
        const Outcome outcome = run({"plot", wrong, "-o", "y.svg"});
        EXPECT_GT(outcome.status, 0);
        EXPECT_LT(outcome.err.size(), 400u) << outcome.err;
        EXPECT_EQ(outcome.error_lines(), 1);
    }
}

}  // namespace
}  // namespace sightline::testing
