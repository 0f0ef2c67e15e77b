// Height maps in text, and what those of all formats share.
#include "sightline/height_map.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "plot/heights.hpp"

namespace sightline {
namespace {

using namespace sightline::testing;

TEST(HeightMapCsv, Separators) {
    const TemporaryFolder folder;
    for (const std::string text :
         {"1,2.5,-3e2\n4,5,6\n", "1;2.5;-3e2\r\n4;5;6", "1\t2.5\t-3e2\r4\t5\t6\r",
          "  1   2.5\t-3e2 \n4 5 6  \n\n", " 1 , 2.5 , -3e2 \n\n \t\n+4 , 5 ,+6",
          "# heights, in m\n1,2.5,-3e2  # first\n\n4,5,6\n#",
          "\xef\xbb\xbf"
          "1,2.5,-3e2\n4,5,6"}) {
        expect_heights(load_height_map(folder.write("a.csv", text)), {1, 2.5, -300, 4, 5, 6});
    }
    for (const char* name : {"a.txt", "a.DAT", "a.tsv"}) {
        expect_heights(load_height_map(folder.write(name, "1 2\n3 4")), {1, 2, 3, 4});
    }
}

TEST(HeightMapCsv, NoData) {
    const TemporaryFolder folder;
    expect_heights(load_height_map(folder.write("a.csv", "1,,nan\n,NA,na\nNaN,-nan, \ninf,-inf,7")),
                   {1, kMissing, kMissing, kMissing, kMissing, kMissing, kMissing, kMissing,
                    kMissing, kMissing, kMissing, 7});
    expect_heights(load_height_map(folder.write("b.csv", "1\t\t3\n\t\t6")),
                   {1, kMissing, 3, kMissing, kMissing, 6});
}

TEST(HeightMapCsv, ErrorsNameTheLine) {
    const TemporaryFolder folder;
    const auto load = [&](const std::string& text) {
        return load_height_map(folder.write("a.csv", text));
    };
    expect_error(load("1,2\n\n# three\n1,2,3\n"), "a.csv:4: 3 heights, but the rows before have 2");
    expect_error(load("1,2\r\n1\r\n"), "a.csv:2: 1 heights");
    expect_error(load("x,y\n1,2\n"), "a.csv:1: column 1: 'x' is no number");
    expect_error(load("1,2\n3,4m\n"), "a.csv:2: column 2: '4m' is no number");
    expect_error(load("1;2,5\n"), "column 2: '2,5' is no number");
    expect_error(load("1 2\n+ 4\n"), "a.csv:2: column 1: '+' is no number");
    expect_error(load("1 +-2\n"), "'+-2' is no number");
    expect_error(load("1,1e999\n"), "'1e999' is beyond the range");
    expect_error(load("1,0x10\n"), "'0x10' is no number");
    expect_error(load(std::string("1,\0\n", 4)), "'?' is no number");
    expect_error(load("1," + std::string(1'000'000, 'a')), std::string(40, 'a') + "' is no number");
}

TEST(HeightMapCsv, DamagedFiles) {
    check_damaged("a.csv", "# heights\n1,2.5,-3e2\n4,,nan\n7,8,9\n", 1'000);
    check_damaged("b.csv", "1 2.5 -3e2\r\n4 5 6\r\n", 1'000);
}

TEST(HeightMap, Options) {
    const TemporaryFolder folder;
    const std::string path = folder.write("a.csv", "1,2,3\n4,-9999,6\n");
    HeightMapOptions options;
    options.no_data = -9999;
    options.height_scale = 0.5;
    options.cell = glm::dvec2(30, 20);
    const Result<HeightMap> map = load_height_map(path, options);
    expect_heights(map, {0.5, 1, 1.5, 2, kMissing, 3});
    EXPECT_EQ(map->x, (std::vector<double>{0, 30, 60}));
    EXPECT_EQ(map->z, (std::vector<double>{0, 20}));
    options.height_scale = 1e306;
    expect_heights(load_height_map(folder.write("b.csv", "1 2\n3 1000"), options),
                   {1e306, 2e306, 3e306, kMissing});
}

TEST(HeightMap, WrongOptions) {
    const TemporaryFolder folder;
    const std::string path = folder.write("a.csv", "1,2,3\n4,5,6\n");
    HeightMapOptions options;
    const double infinite = std::numeric_limits<double>::infinity();
    for (const glm::dvec2 cell :
         {glm::dvec2(0, 1), glm::dvec2(1, -1), glm::dvec2(kMissing, 1), glm::dvec2(1, infinite)}) {
        options.cell = cell;
        const Result<HeightMap> map = load_height_map(path, options);
        ASSERT_FALSE(map.ok());
        EXPECT_EQ(map.error().kind, ErrorKind::bad_option);
        EXPECT_NE(map.error().message.find("must be positive"), std::string::npos);
    }
    options.cell = glm::dvec2(1e308, 1);
    expect_error(load_height_map(path, options), "not apart");
    options = {};
    for (const double scale : {infinite, kMissing}) {
        options.height_scale = scale;
        const Result<HeightMap> map = load_height_map(path, options);
        ASSERT_FALSE(map.ok());
        EXPECT_EQ(map.error().kind, ErrorKind::bad_option);
    }
}

TEST(HeightMap, TooSmallOrWithoutHeights) {
    const TemporaryFolder folder;
    const auto load = [&](const std::string& text, const HeightMapOptions& options = {}) {
        return load_height_map(folder.write("a.csv", text), options);
    };
    expect_error(load("1,2,3"), "has one row: a height map needs two or more");
    expect_error(load("1\n2\n3"), "has one column: a height map needs two or more");
    expect_error(load("# nothing\n\n"), "has no row");
    expect_error(load_height_map(folder.write("a.npy", npy(npy_header("<f4", "(0, 3)"), ""))),
                 "has no row");
    expect_error(load(",\n,\n"), "no height in it");
    HeightMapOptions options;
    options.no_data = 0;
    expect_error(load("0,0\n0,0\n", options), "no height in it");
}

TEST(HeightMap, FilesThatCannotBeRead) {
    const TemporaryFolder folder;
    expect_error(load_height_map("-"), "standard input", ErrorKind::bad_option);
    expect_error(load_height_map(folder.path()), "it is a folder");
    expect_error(load_height_map(folder.file("none.png")), "check the path", ErrorKind::io);
    expect_error(load_height_map(""), "check the path", ErrorKind::io);
    expect_error(load_height_map("/dev/zero"), "it is a device");
    for (const char* name : {"a.png", "a.csv", "a.npy", "a.asc"}) {
        expect_error(load_height_map(folder.write(name, "")), "it is empty");
    }
    expect_error(load_height_map(folder.write("b.png", "GIF89a")), "does not begin like a PNG");
    expect_error(load_height_map(folder.write("b.npy", "1,2")), "does not begin like an NPY");
    const std::string path = folder.write("secret.csv", "1,2\n3,4");
    ASSERT_EQ(chmod(path.c_str(), 0), 0);
    if (geteuid() != 0) expect_error(load_height_map(path), "permissions", ErrorKind::io);
}

TEST(HeightMap, Pipes) {
    const TemporaryFolder folder;
    const auto load = [&](const std::string& name, const std::string& bytes) {
        const std::string path = folder.file(name);
        EXPECT_EQ(mkfifo(path.c_str(), 0600), 0);
        std::thread writer([&] { testing::write_file(path, bytes); });
        const Result<HeightMap> map = load_height_map(path);
        writer.join();
        return map;
    };
    expect_heights(load("a", npy(npy_header("<u1"), "abcdef")), {97, 98, 99, 100, 101, 102});
    expect_heights(load("b.csv", "1,2\n3,4"), {1, 2, 3, 4});
    expect_error(load("c.asc", "ncols 2"), "GDAL does not read from a pipe");
}

}  // namespace
}  // namespace sightline
