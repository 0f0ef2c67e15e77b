// Height maps that GDAL reads.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
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

/// A TIFF of one strip; three samples a pixel are colours.
std::string tiff(std::uint32_t width, std::uint32_t height, std::uint32_t bits,
                 const std::string& samples, std::uint32_t samples_per_pixel = 1) {
    std::string out = "II*";
    const auto put = [&](std::uint32_t value, int bytes) {
        for (int k = 0; k < bytes; ++k) out += static_cast<char>(value >> 8 * k & 255);
    };
    const auto size = static_cast<std::uint32_t>(samples.size());
    const std::uint32_t is_float = bits == 32 ? 3 : 1;
    const std::vector<std::array<std::uint32_t, 2>> tags = {{256, width},
                                                            {257, height},
                                                            {258, bits},
                                                            {259, 1},
                                                            {262, samples_per_pixel == 3 ? 2u : 1u},
                                                            {273, 8},
                                                            {277, samples_per_pixel},
                                                            {278, height},
                                                            {279, size},
                                                            {339, is_float}};
    put(0, 1);
    put(8 + size, 4);
    out += samples;
    put(static_cast<std::uint32_t>(tags.size()), 2);
    for (const auto& [tag, value] : tags) {
        put(tag, 2);
        put(4, 2);  // of 32 bits
        put(1, 4);
        put(value, 4);
    }
    put(0, 4);
    return out;
}

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

    /// The heights of the grid as a TIFF, with what GDAL keeps beside a file: its place, and the
    /// meaning of the numbers.
    [[nodiscard]] Result<HeightMap> load_raw(const std::string& in_file, const std::string& in_band,
                                             const HeightMapOptions& options = {}) const {
        const std::array<float, 6> heights = {1.5F, 2, 3, 4, -9999, 6};
        write_file(folder_.file("m.tif"),
                   tiff(3, 2, 32, {reinterpret_cast<const char*>(heights.data()), sizeof heights}));
        write_file(folder_.file("m.tif.aux.xml"), "<PAMDataset>" + in_file +
                                                      "<PAMRasterBand band=\"1\">" + in_band +
                                                      "</PAMRasterBand></PAMDataset>");
        return load_height_map(folder_.file("m.tif"), options);
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
    const Result<HeightMap> map = load_raw("", "<NoDataValue>-9999</NoDataValue>");
    expect_map(map, {0, 1, 2}, {0, 1}, {1.5, 2, 3, 4, kMissing, 6});
    EXPECT_FALSE(map->placed);
}

TEST_F(HeightMapGdal, FromTheSouthUp) {
    const Result<HeightMap> map =
        load_raw("<GeoTransform>500, 10, 0, 2000, 0, 5</GeoTransform>", "");
    expect_map(map, {505, 515, 525}, {-2007.5, -2002.5}, {4, -9999, 6, 1.5, 2, 3});
    EXPECT_TRUE(map->placed);
}

TEST_F(HeightMapGdal, RotatedNeedsACell) {
    const std::string rotated = "<GeoTransform>500, 10, 1, 2000, 1, -10</GeoTransform>";
    expect_error(load_raw(rotated, ""), "do not run from west to east");
    expect_error(load_raw("<GeoTransform>500, -10, 0, 2000, 0, -10</GeoTransform>", ""),
                 "do not run from west to east");
    HeightMapOptions options;
    options.cell = glm::dvec2(1, 1);
    expect_map(load_raw(rotated, "", options), {0, 1, 2}, {0, 1}, {1.5, 2, 3, 4, -9999, 6});
}

TEST_F(HeightMapGdal, ScaleAndOffset) {
    const std::string band =
        "<NoDataValue>-9999</NoDataValue><Offset>100</Offset><Scale>0.5</Scale>";
    HeightMapOptions options;
    options.no_data = 2;  // as it stands in the file
    options.height_scale = 10;
    expect_map(load_raw("", band, options), {0, 1, 2}, {0, 1},
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
    expect_error(load_height_map(folder_.write("rgb.tif", tiff(3, 2, 8, std::string(18, 'x'), 3))),
                 "its first band holds colours");
    expect_error(load_height_map(folder_.write("large.tif", tiff(99'999, 99'999, 8, "few"))),
                 "at most 268435456");
    expect_error(load_height_map(folder_.write(
                     "row.asc", "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n")),
                 "has one row");
}

/// A server that nobody may call.
class Listener {
public:
    Listener() {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        const auto generic = reinterpret_cast<sockaddr*>(&address);
        open_ = socket_ >= 0 && bind(socket_, generic, size) == 0 && listen(socket_, 16) == 0 &&
                getsockname(socket_, generic, &size) == 0;
        port_ = std::to_string(ntohs(address.sin_port));
    }
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;
    ~Listener() { close(socket_); }

    [[nodiscard]] bool is_open() const { return open_; }
    [[nodiscard]] std::string url(const std::string& file) const {
        return "http://127.0.0.1:" + port_ + "/" + file;
    }
    [[nodiscard]] bool was_called() const {
        pollfd watched{socket_, POLLIN, 0};
        return poll(&watched, 1, 0) > 0;
    }

private:
    int socket_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    bool open_ = false;
    std::string port_;
};

TEST_F(HeightMapGdal, NothingIsFetchedAndNoOtherFileIsRead) {
    const Listener server;
    if (!server.is_open()) GTEST_SKIP() << "no loopback here";
    write_file(folder_.file("m.asc"), kGrid);
    const auto raster = [](const std::string& source, const std::string& relative) {
        return R"(<VRTDataset rasterXSize="3" rasterYSize="2"><VRTRasterBand dataType="Float32" )"
               R"(band="1"><SimpleSource><SourceFilename relativeToVRT=")" +
               relative + R"(">)" + source +
               "</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>";
    };
    const std::string service = "<GDAL_WMS><Service name=\"TMS\"><ServerUrl>" +
                                server.url("${z}/${x}/${y}.png") +
                                "</ServerUrl></Service><DataWindow><SizeX>64</SizeX><SizeY>64"
                                "</SizeY></DataWindow></GDAL_WMS>";
    const std::string address = "/vsicurl/" + server.url("x.none");
    for (const std::string& text : {raster("m.asc", "1"), raster(address, "0"),
                                    raster("/vsicurl/" + server.url("none"), "0"), service}) {
        for (const std::string name : {"v.vrt", "v.tif", "v.xml"}) {
            expect_error(load_height_map(folder_.write(name, text)), "not a height map");
        }
    }
    // A mask or an overview that a file beside it names.
    const std::string domain = "<Metadata domain=\"OVERVIEWS\"><MDI key=\"OVERVIEW_FILE\">" +
                               address + "</MDI></Metadata>";
    EXPECT_TRUE(load_raw(domain, "").ok());
    EXPECT_FALSE(load_height_map(address).ok());
    EXPECT_FALSE(server.was_called());
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
