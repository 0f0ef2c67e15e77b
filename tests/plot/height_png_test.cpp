// Height maps in PNG files, which libpng writes here.
#include <gtest/gtest.h>
#include <png.h>

#include <random>
#include <string>
#include <vector>

#include "plot/heights.hpp"

namespace sightline {
namespace {

using namespace sightline::testing;

struct Png {
    std::uint32_t width = 3, height = 2;
    int bit_depth = 16, color_type = PNG_COLOR_TYPE_GRAY;
    bool interlaced = false;
    int transparent = -1;               ///< this grey value
    std::vector<std::uint16_t> values;  ///< of all channels
};

std::string encode(const Png& image) {
    std::string out;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(
        png, &out,
        [](png_structp p, png_bytep bytes, std::size_t n) {
            static_cast<std::string*>(png_get_io_ptr(p))
                ->append(reinterpret_cast<const char*>(bytes), n);
        },
        nullptr);
    png_set_IHDR(png, info, image.width, image.height, image.bit_depth, image.color_type,
                 image.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    const std::vector<png_color> palette(2);
    if (image.color_type == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette.data(), 2);
    if (image.transparent >= 0) {
        png_color_16 value{};
        value.gray = static_cast<png_uint_16>(image.transparent);
        png_set_tRNS(png, info, nullptr, 0, &value);
    }
    png_write_info(png, info);
    if (image.bit_depth < 8) png_set_packing(png);
    const int passes = png_set_interlace_handling(png);
    const std::size_t per_row = image.values.size() / image.height;
    for (int pass = 0; pass < passes; ++pass) {
        for (std::size_t y = 0; y < image.height; ++y) {
            std::vector<std::uint8_t> row;
            for (std::size_t i = 0; i < per_row; ++i) {
                const std::uint16_t v = image.values[y * per_row + i];
                if (image.bit_depth == 16) row.push_back(static_cast<std::uint8_t>(v >> 8));
                row.push_back(static_cast<std::uint8_t>(v & 255));
            }
            png_write_row(png, row.data());
        }
    }
    png_write_end(png, nullptr);
    png_destroy_write_struct(&png, &info);
    return out;
}

Png grey(int bit_depth, std::vector<std::uint16_t> values) {
    Png image;
    image.bit_depth = bit_depth;
    image.values = std::move(values);
    return image;
}

/// A picture of noise, large enough to show rows and passes that are mixed up.
Png noise(std::uint32_t width, std::uint32_t height, int bit_depth) {
    Png image = grey(bit_depth, {});
    image.width = width;
    image.height = height;
    std::mt19937 random(5);
    for (std::uint32_t i = 0; i < width * height; ++i) {
        image.values.push_back(static_cast<std::uint16_t>(random() & ((1u << bit_depth) - 1)));
    }
    return image;
}

TEST(HeightMapPng, GreyOf8And16Bits) {
    const TemporaryFolder folder;
    const Result<HeightMap> wide =
        load_height_map(folder.write("a.png", encode(grey(16, {0, 1, 256, 0x1234, 65535, 40000}))));
    expect_heights(wide, {0, 1, 256, 0x1234, 65535, 40000});
    EXPECT_EQ(wide->x, (std::vector<double>{0, 1, 2}));
    EXPECT_EQ(wide->z, (std::vector<double>{0, 1}));
    EXPECT_FALSE(wide->placed);
    // The content decides, not the name.
    expect_heights(load_height_map(folder.write("a.csv", encode(grey(8, {0, 1, 128, 255, 7, 9})))),
                   {0, 1, 128, 255, 7, 9});
}

TEST(HeightMapPng, FewBitsAreStretchedTo8) {
    const TemporaryFolder folder;
    expect_heights(load_height_map(folder.write("1.png", encode(grey(1, {0, 1, 1, 1, 0, 0})))),
                   {0, 255, 255, 255, 0, 0});
    expect_heights(load_height_map(folder.write("4.png", encode(grey(4, {0, 1, 2, 15, 0, 0})))),
                   {0, 17, 34, 255, 0, 0});
}

TEST(HeightMapPng, TransparentIsNoData) {
    const TemporaryFolder folder;
    for (const int bit_depth : {8, 16}) {
        Png image = grey(bit_depth, {1, 9, 2, 0, 3, 1, 4, 255, 5, 0, 6, 3});
        image.color_type = PNG_COLOR_TYPE_GRAY_ALPHA;
        expect_heights(load_height_map(folder.write("alpha.png", encode(image))),
                       {1, kMissing, 3, 4, kMissing, 6});
        image = grey(bit_depth, {1, 2, 3, 2, 5, 6});
        image.transparent = 2;
        expect_heights(load_height_map(folder.write("key.png", encode(image))),
                       {1, kMissing, 3, kMissing, 5, 6});
    }
}

TEST(HeightMapPng, InterlacedAsPlain) {
    const TemporaryFolder folder;
    for (const int bit_depth : {2, 8, 16}) {
        Png image = noise(37, 21, bit_depth);
        const Result<HeightMap> plain = load_height_map(folder.write("plain.png", encode(image)));
        ASSERT_TRUE(plain.ok());
        EXPECT_EQ(plain->y[38], image.values[38] * (bit_depth == 2 ? 85 : 1));
        image.interlaced = true;
        expect_heights(load_height_map(folder.write("interlaced.png", encode(image))), plain->y);
    }
}

TEST(HeightMapPng, ColorsAreRefused) {
    const TemporaryFolder folder;
    Png image = grey(8, std::vector<std::uint16_t>(18, 7));
    image.color_type = PNG_COLOR_TYPE_RGB;
    expect_error(load_height_map(folder.write("rgb.png", encode(image))), "16-bit grey");
    image = grey(1, {0, 1, 0, 1, 0, 1});
    image.color_type = PNG_COLOR_TYPE_PALETTE;
    expect_error(load_height_map(folder.write("palette.png", encode(image))), "16-bit grey");
}

TEST(HeightMapPng, CutAnywhereIsAnError) {
    const TemporaryFolder folder;
    const std::string bytes = encode(noise(9, 9, 16));
    // Whatever stands behind the last row but the end's own checksum is looked at.
    for (std::size_t size = 1; size < bytes.size(); ++size) {
        expect_error(load_height_map(folder.write("cut.png", bytes.substr(0, size))), "again");
    }
}

/// The picture with another size in its header, and the checksum that belongs to it.
std::string with_size(std::string bytes, std::uint32_t width, std::uint32_t height) {
    const auto put = [&](std::size_t at, std::uint32_t v) {
        for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = static_cast<char>(v >> (24 - 8 * k));
    };
    put(16, width);
    put(20, height);
    std::uint32_t crc = 0xffffffff;  // PNG specification, annex D
    for (std::size_t i = 12; i < 29; ++i) {
        crc ^= static_cast<unsigned char>(bytes[i]);
        for (int k = 0; k < 8; ++k) crc = (crc & 1) != 0 ? 0xedb88320 ^ crc >> 1 : crc >> 1;
    }
    put(29, ~crc);
    return bytes;
}

TEST(HeightMapPng, SizesThatCannotBeAreRefusedAtOnce) {
    const TemporaryFolder folder;
    const std::string bytes = encode(noise(9, 9, 16));
    const auto load = [&](std::uint32_t width, std::uint32_t height) {
        return load_height_map(folder.write("size.png", with_size(bytes, width, height)));
    };
    EXPECT_TRUE(load(9, 9).ok());
    expect_error(load(0x7fffffff, 0x7fffffff), "at most 268435456");
    expect_error(load(16'384, 16'385), "at most 268435456");
    expect_error(load(16'384, 16'384), "can't hold 16384 x 16384");
    expect_error(load(0, 9), "not a readable PNG");
    expect_error(load(9, 10), "not a readable PNG");
}

TEST(HeightMapPng, DamagedFiles) {
    Png image = noise(13, 11, 16);
    check_damaged("a.png", encode(image), 800);
    image.interlaced = true;
    check_damaged("b.png", encode(image), 400);
}

TEST(HeightMapPng, DamagedHeaders) {
    // Checksums made right again, so that what lies behind them is reached.
    const TemporaryFolder folder;
    const std::string bytes = encode(noise(13, 11, 16));
    std::mt19937 random(3);
    for (int i = 0; i < 500; ++i) {
        std::string other = bytes;
        other[24 + random() % 5] = static_cast<char>(random() % 20);  // depth, colours, methods
        const auto width = static_cast<std::uint32_t>(random() % 2 == 0 ? 13 : random() % 40);
        const auto height = static_cast<std::uint32_t>(1 + random() % 20);
        expect_map_or_line(folder.write("a.png", with_size(other, width, height)));
    }
}

}  // namespace
}  // namespace sightline
