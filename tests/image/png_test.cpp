// PNG files read back through libpng.
#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "image/png_writer.hpp"
#include "sightline/image.hpp"
#include "support/files.hpp"

namespace {

using namespace sightline;
using sightline::testing::read_file;
using sightline::testing::TemporaryFolder;

/// A file as it stands: its pixels in the format in which they are stored.
struct Decoded {
    std::uint32_t width = 0, height = 0;
    int color_type = -1, bit_depth = 0;
    bool says_srgb = false;
    std::vector<std::uint8_t> bytes;
    std::size_t row_bytes = 0;
};

Decoded decode(const std::string& path) {
    Decoded out;
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (file == nullptr) return out;
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_read_info(png, info);
    out.width = png_get_image_width(png, info);
    out.height = png_get_image_height(png, info);
    out.color_type = png_get_color_type(png, info);
    out.bit_depth = png_get_bit_depth(png, info);
    out.says_srgb = png_get_valid(png, info, PNG_INFO_sRGB) != 0;
    out.row_bytes = png_get_rowbytes(png, info);
    out.bytes.resize(out.row_bytes * out.height);
    for (std::size_t y = 0; y < out.height; ++y) {
        png_read_row(png, out.bytes.data() + y * out.row_bytes, nullptr);
    }
    png_read_end(png, nullptr);
    png_destroy_read_struct(&png, &info, nullptr);
    std::fclose(file);
    return out;
}

ColorImage noise(std::uint32_t width, std::uint32_t height) {
    ColorImage image(width, height);
    std::mt19937 random(7);
    for (glm::vec4& p : image.pixels) {
        const auto next = [&random] { return static_cast<float>(random() % 1000) / 999.0f; };
        const float alpha = next();
        p = {next() * alpha, next() * alpha, next() * alpha, alpha};
    }
    return image;
}

TEST(Png, ColorIsStraightAlphaInSrgb) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.png");
    const ColorImage image = noise(37, 1'900);  // several blocks of rows
    ASSERT_TRUE(write_color_png(path, image).ok());
    const Decoded file = decode(path);
    EXPECT_EQ(file.width, 37u);
    EXPECT_EQ(file.height, 1'900u);
    EXPECT_EQ(file.color_type, PNG_COLOR_TYPE_RGBA);
    EXPECT_EQ(file.bit_depth, 8);
    EXPECT_TRUE(file.says_srgb);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const glm::vec4 p = image.pixels[i];
        const std::uint8_t* bytes = &file.bytes[4 * i];
        ASSERT_EQ(bytes[3], std::lround(p.a * 255));
        for (int k = 0; k < 3; ++k) {
            const float straight = p.a > 0 ? p[k] * (1.0f / p.a) : 0.0f;
            ASSERT_EQ(bytes[k], to_srgb8(straight)) << i;
        }
    }
}

TEST(Png, SpecialColors) {
    const TemporaryFolder folder;
    ColorImage image(4, 1);
    image.at(0, 0) = {0, 0, 0, 0};
    image.at(1, 0) = {2, 0.5f, -1, 1};
    image.at(2, 0) = {0.25f, 0.25f, 0.25f, 0.25f};
    image.at(3, 0) = {std::numeric_limits<float>::quiet_NaN(), 1, 1, 1};
    ASSERT_TRUE(write_color_png(folder.file("a.png"), image).ok());
    const std::vector<std::uint8_t> expected = {0,   0,   0,   0,  255, 188, 0,   255,
                                                255, 255, 255, 64, 0,   255, 255, 255};
    EXPECT_EQ(decode(folder.file("a.png")).bytes, expected);
}

TEST(Png, DepthSpansNearToFar) {
    const TemporaryFolder folder;
    DepthImage depth(6, 1);
    depth.pixels = {2, 4, 3, std::numeric_limits<float>::infinity(), 1, 9};
    ASSERT_TRUE(write_depth_png(folder.file("d.png"), depth, 2, 4).ok());
    const Decoded file = decode(folder.file("d.png"));
    EXPECT_EQ(file.color_type, PNG_COLOR_TYPE_GRAY);
    EXPECT_EQ(file.bit_depth, 16);
    const std::vector<std::uint8_t> expected = {0,    0,    0xFF, 0xFF, 0x80, 0,
                                                0xFF, 0xFF, 0,    0,    0xFF, 0xFF};
    EXPECT_EQ(file.bytes, expected);
}

TEST(Png, NormalsIdsAndMasks) {
    const TemporaryFolder folder;
    NormalImage normals(2, 1);
    normals.at(0, 0) = {1, -1, 0};
    ASSERT_TRUE(write_normals_png(folder.file("n.png"), normals).ok());
    EXPECT_EQ(decode(folder.file("n.png")).bytes,
              (std::vector<std::uint8_t>{255, 0, 128, 0, 0, 0}));

    IdImage ids(2, 2);
    ids.pixels = {0, 0x04030201u, 0xFFFFFFFFu, 70'000};
    ASSERT_TRUE(write_ids_png(folder.file("i.png"), ids).ok());
    const Decoded file = decode(folder.file("i.png"));
    EXPECT_FALSE(file.says_srgb);
    ASSERT_EQ(file.bytes.size(), 16u);
    EXPECT_EQ(std::memcmp(file.bytes.data(), ids.pixels.data(), 16), 0);

    MaskImage mask(3, 1);
    mask.pixels = {0, 1, 255};
    ASSERT_TRUE(write_mask_png(folder.file("m.png"), mask).ok());
    EXPECT_EQ(decode(folder.file("m.png")).bytes, (std::vector<std::uint8_t>{0, 255, 255}));
}

TEST(Png, BytesDependOnThePixelsOnly) {
    const TemporaryFolder folder;
    const ColorImage image = noise(200, 100);
    ASSERT_TRUE(write_color_png(folder.file("a.png"), image).ok());
    ASSERT_TRUE(write_color_png(folder.file("b.png"), image).ok());
    EXPECT_EQ(read_file(folder.file("a.png")), read_file(folder.file("b.png")));

    const std::vector<std::uint8_t> rows(64 * 50, 77);
    const auto write = [&](const char* name, std::size_t rows_per_call) {
        auto writer =
            PngWriter::create(folder.file(name), 64, 50, PngLayout::grey8, PngContent::data);
        ASSERT_TRUE(writer.ok());
        const std::size_t step = rows_per_call * writer->bytes_per_row();
        for (std::size_t at = 0; at < rows.size(); at += step) {
            ASSERT_TRUE(writer->write_rows({rows.data() + at, step}).ok());
        }
        ASSERT_TRUE(writer->finish().ok());
    };
    write("c.png", 1);
    write("d.png", 25);
    EXPECT_EQ(read_file(folder.file("c.png")), read_file(folder.file("d.png")));
}

TEST(Png, BytesDoNotDependOnCallsOrThreads) {
    const TemporaryFolder folder;
    const std::uint32_t width = 1'000, height = 301;  // several bands, the last one incomplete
    std::vector<std::uint8_t> rows(std::size_t{width} * 4 * height);
    std::mt19937 random(9);
    for (std::uint8_t& byte : rows) byte = static_cast<std::uint8_t>(random() % 5);
    const auto create = [&](const char* name) {
        return PngWriter::create(folder.file(name), width, height, PngLayout::rgba8,
                                 PngContent::data);
    };
    auto by_row = create("0.png");
    ASSERT_TRUE(by_row.ok());
    const std::size_t row_bytes = by_row->bytes_per_row();
    for (std::size_t at = 0; at < rows.size(); at += row_bytes) {
        ASSERT_TRUE(by_row->write_rows({rows.data() + at, row_bytes}).ok());
    }
    ASSERT_TRUE(by_row->finish().ok());
    EXPECT_EQ(decode(folder.file("0.png")).bytes, rows);

    auto at_once = create("1.png");
    ASSERT_TRUE(at_once.ok() && at_once->write_rows(rows).ok() && at_once->finish().ok());
    EXPECT_EQ(read_file(folder.file("0.png")), read_file(folder.file("1.png")));
    for (const int threads : {1, 2, 8}) {
        auto writer = create("2.png");
        ASSERT_TRUE(writer.ok());
        const auto source = [&](std::uint32_t first, std::uint32_t count, std::uint8_t* out) {
            std::memcpy(out, rows.data() + first * row_bytes, count * row_bytes);
        };
        ASSERT_TRUE(writer->write_rows(source, height, threads).ok() && writer->finish().ok());
        EXPECT_EQ(read_file(folder.file("0.png")), read_file(folder.file("2.png")));
        // A band has 65 rows: groups that end inside of one, at its end, and reach over several.
        for (const std::uint32_t group : {1u, 64u, 65u, 66u, 200u}) {
            auto grouped = create("3.png");
            ASSERT_TRUE(grouped.ok());
            for (std::uint32_t y = 0; y < height; y += group) {
                ASSERT_TRUE(grouped->write_rows(source, std::min(group, height - y), threads).ok());
            }
            ASSERT_TRUE(grouped->finish().ok());
            EXPECT_EQ(read_file(folder.file("0.png")), read_file(folder.file("3.png"))) << group;
        }
    }
}

TEST(Png, FailuresAreValuesAndLeaveNothing) {
    const TemporaryFolder folder;
    const Status empty = write_color_png(folder.file("a.png"), ColorImage{});
    ASSERT_FALSE(empty.ok());
    EXPECT_EQ(empty.error().kind, ErrorKind::bad_option);
    EXPECT_NE(empty.error().message.find("a.png"), std::string::npos);
    EXPECT_EQ(folder.count(), 0);
    EXPECT_FALSE(write_color_png(folder.file("no/a.png"), noise(4, 4)).ok());
    const Status full = write_color_png("/dev/full", noise(500, 500));
    ASSERT_FALSE(full.ok());
    EXPECT_EQ(full.error().kind, ErrorKind::io);
    EXPECT_NE(full.error().message.find("No space left"), std::string::npos);
    EXPECT_FALSE(
        PngWriter::create(folder.file("a.png"), 0x2000'0000, 1, PngLayout::rgba8, PngContent::data)
            .ok());
    EXPECT_EQ(folder.count(), 0);
}

TEST(Png, LongestRowsAndColumnsWork) {
    const TemporaryFolder folder;
    MaskImage wide(65'536, 2, 1), tall(1, 65'536, 1);
    ASSERT_TRUE(write_mask_png(folder.file("w.png"), wide).ok());
    ASSERT_TRUE(write_mask_png(folder.file("t.png"), tall).ok());
    EXPECT_EQ(decode(folder.file("w.png")).bytes, std::vector<std::uint8_t>(131'072, 255));
    EXPECT_EQ(decode(folder.file("t.png")).bytes, std::vector<std::uint8_t>(65'536, 255));
}

}  // namespace
