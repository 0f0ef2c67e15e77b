// Height maps that GDAL reads.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plot/height_table.hpp"
#include "plot/heights.hpp"

namespace sightline {
namespace {

using namespace sightline::testing;

/// Three columns and two rows of an ESRI ASCII grid, cells of 10 from (500, 2000) on.
constexpr const char* kGrid =
    "ncols 3\nnrows 2\nxllcorner 500\nyllcorner 2000\ncellsize 10\nNODATA_value -9999\n"
    "1.5 2 3\n4 -9999 6\n";

class HeightMapGdal : public ::testing::Test {
protected:
    void SetUp() override {
        static const bool installed = [] {
            const TemporaryFolder folder;
            const Result<HeightMap> map = load_height_map(folder.write("m.asc", kGrid));
            return map.ok() || map.error().message.find("is not installed") == std::string::npos;
        }();
        if (!installed) GTEST_SKIP() << "no libgdal here";
    }

    /// A virtual raster (GDAL's XML) of the grid.
    [[nodiscard]] Result<HeightMap> load_virtual(const std::string& in_file,
                                                 const std::string& in_band,
                                                 const HeightMapOptions& options = {},
                                                 const std::string& type = "Float32",
                                                 const std::string& source = "m.asc") const {
        write_file(folder_.file("m.asc"), kGrid);
        return load_height_map(
            folder_.write("m.vrt", "<VRTDataset rasterXSize=\"3\" rasterYSize=\"2\">" + in_file +
                                       "<VRTRasterBand dataType=\"" + type + "\" band=\"1\">" +
                                       in_band + "<SimpleSource><SourceFilename relativeToVRT=\"" +
                                       (source == "m.asc" ? "1" : "0") + "\">" + source +
                                       "</SourceFilename></SimpleSource></VRTRasterBand>"
                                       "</VRTDataset>"),
            options);
    }

    TemporaryFolder folder_;
};

void expect_map(const Result<HeightMap>& map, const std::vector<double>& x,
                const std::vector<double>& z, const std::vector<double>& y) {
    expect_heights(map, y);
    if (!map) return;
    EXPECT_EQ(map->x, x);
    EXPECT_EQ(map->z, z);
}

TEST_F(HeightMapGdal, GridWithItsPlace) {
    const std::string path = folder_.write("m.asc", kGrid);
    const Result<HeightMap> map = load_height_map(path);
    // North at the top: the first row's centre has northing 2015.
    expect_map(map, {505, 515, 525}, {-2015, -2005}, {1.5, 2, 3, 4, kMissing, 6});
    EXPECT_TRUE(map->placed);
    HeightMapOptions options;
    options.cell = glm::dvec2(30, 20);
    options.height_scale = 2;
    options.no_data = 3;  // besides the file's own
    const Result<HeightMap> moved = load_height_map(path, options);
    expect_map(moved, {0, 30, 60}, {0, 20}, {3, 4, kMissing, 8, kMissing, 12});
    EXPECT_FALSE(moved->placed);
}

TEST_F(HeightMapGdal, WithoutAPlace) {
    const Result<HeightMap> map = load_virtual("", "<NoDataValue>-9999</NoDataValue>");
    expect_map(map, {0, 1, 2}, {0, 1}, {1.5, 2, 3, 4, kMissing, 6});
    EXPECT_FALSE(map->placed);
}

TEST_F(HeightMapGdal, FromTheSouthUp) {
    const Result<HeightMap> map =
        load_virtual("<GeoTransform>500, 10, 0, 2000, 0, 5</GeoTransform>", "");
    expect_map(map, {505, 515, 525}, {-2007.5, -2002.5}, {4, -9999, 6, 1.5, 2, 3});
    EXPECT_TRUE(map->placed);
}

TEST_F(HeightMapGdal, RotatedNeedsACell) {
    const std::string rotated = "<GeoTransform>500, 10, 1, 2000, 1, -10</GeoTransform>";
    expect_error(load_virtual(rotated, ""), "do not run from west to east");
    expect_error(load_virtual("<GeoTransform>500, -10, 0, 2000, 0, -10</GeoTransform>", ""),
                 "do not run from west to east");
    HeightMapOptions options;
    options.cell = glm::dvec2(1, 1);
    expect_map(load_virtual(rotated, "", options), {0, 1, 2}, {0, 1}, {1.5, 2, 3, 4, -9999, 6});
}

TEST_F(HeightMapGdal, ScaleAndOffset) {
    const std::string band =
        "<NoDataValue>-9999</NoDataValue><Offset>100</Offset><Scale>0.5</Scale>";
    HeightMapOptions options;
    options.no_data = 2;  // as it stands in the file
    options.height_scale = 10;
    expect_map(load_virtual("", band, options, "Float64"), {0, 1, 2}, {0, 1},
               {1007.5, kMissing, 1015, 1020, kMissing, 1030});
}

TEST_F(HeightMapGdal, NoDataOfFloats) {
    HeightMapOptions options;
    options.no_data = -3.4028235e38;  // a little beyond the least float, which is meant
    const std::string path =
        folder_.write("f.asc",
                      "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n"
                      "1.5 2\n-3.4028234663852886e38 4\n");
    expect_map(load_height_map(path, options), {0.5, 1.5}, {-1.5, -0.5}, {1.5, 2, kMissing, 4});
}

TEST_F(HeightMapGdal, WhatIsRefused) {
    expect_error(load_height_map(folder_.write("a.asc", "once upon a time\n")),
                 "GDAL does not know its format");
    expect_error(load_height_map(folder_.write("cut.asc", std::string(kGrid).substr(0, 90))),
                 "cut.asc: ");
    expect_error(load_virtual("", "<ColorInterp>Red</ColorInterp>"),
                 "its first band holds colours");
    expect_error(load_height_map(
                     folder_.write("large.vrt",
                                   "<VRTDataset rasterXSize=\"99999\" rasterYSize=\"99999\">"
                                   "<VRTRasterBand dataType=\"Byte\" band=\"1\"/></VRTDataset>")),
                 "at most 268435456");
    expect_error(load_height_map(folder_.write(
                     "none.vrt", "<VRTDataset rasterXSize=\"9\" rasterYSize=\"9\"/>")),
                 "not a height map");
    expect_error(load_virtual("", "", {}, "Float32", folder_.file("gone.asc")), "m.vrt: ");
    expect_error(load_height_map(folder_.write(
                     "row.asc", "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n")),
                 "has one row");
}

TEST(HeightMapWithoutGdal, TellsHowToInstallIt) {
    const TemporaryFolder folder;
    const std::string path = folder.write("m.asc", kGrid);
    const auto table = heights::read_gdal_heights(path, {"libno-such-gdal.so.1"});
    ASSERT_FALSE(table.ok());
    EXPECT_EQ(table.error().kind, ErrorKind::io);
    EXPECT_NE(table.error().message.find("apt install libgdal32"), std::string::npos);
    // A library that has none of the functions is no GDAL either.
    const auto other = heights::read_gdal_heights(path, {"libc.so.6"});
    ASSERT_FALSE(other.ok());
    EXPECT_NE(other.error().message.find("is not installed"), std::string::npos);
}

}  // namespace
}  // namespace sightline
