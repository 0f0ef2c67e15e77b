// The sRGB tables against the formula in long double.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sightline/image.hpp"

namespace {

using namespace sightline;

long double true_srgb(long double linear) {
    return linear <= 0.0031308L ? 12.92L * linear : 1.055L * std::pow(linear, 1 / 2.4L) - 0.055L;
}

long double true_linear(long double srgb) {
    return srgb <= 0.04045L ? srgb / 12.92L : std::pow((srgb + 0.055L) / 1.055L, 2.4L);
}

TEST(Srgb, RoundsToTheNearestByte) {
    for (int i = 0; i <= 200'000; ++i) {
        const float linear = static_cast<float>(i) / 200'000.0f;
        const long double scaled = 255 * true_srgb(linear);
        ASSERT_LE(std::fabs(scaled - to_srgb8(linear)), 0.500001L) << linear;
    }
}

// Whatever table finds them, the steps stand where the formula has them, to the last bit.
TEST(Srgb, EveryBoundaryIsTheFirstFloatPastTheTrueOne) {
    for (int k = 0; k < 255; ++k) {
        float boundary = static_cast<float>(true_linear((k + 0.5L) / 255));
        if (boundary < true_linear((k + 0.5L) / 255)) boundary = std::nextafter(boundary, 2.0f);
        EXPECT_EQ(to_srgb8(boundary), k + 1);
        EXPECT_EQ(to_srgb8(std::nextafter(boundary, 0.0f)), k);
    }
}

TEST(Srgb, ClampsAndSurvivesAnything) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    EXPECT_EQ(to_srgb8(0.0f), 0);
    EXPECT_EQ(to_srgb8(-1.0f), 0);
    EXPECT_EQ(to_srgb8(-kInfinity), 0);
    EXPECT_EQ(to_srgb8(std::numeric_limits<float>::quiet_NaN()), 0);
    EXPECT_EQ(to_srgb8(std::numeric_limits<float>::denorm_min()), 0);
    EXPECT_EQ(to_srgb8(1.0f), 255);
    EXPECT_EQ(to_srgb8(1.5f), 255);
    EXPECT_EQ(to_srgb8(kInfinity), 255);
}

TEST(Srgb, BytesSurviveTheRoundTrip) {
    for (int k = 0; k < 256; ++k) {
        const auto byte = static_cast<std::uint8_t>(k);
        EXPECT_EQ(to_srgb8(from_srgb8(byte)), k);
        EXPECT_EQ(from_srgb8(byte), static_cast<float>(true_linear(k / 255.0L))) << k;
    }
}

TEST(ImageFormat, IsFoundByNameAndExtension) {
    EXPECT_EQ(image_format_of("a/b.png"), ImageFormat::png);
    EXPECT_EQ(image_format_of("B.EXR"), ImageFormat::exr);
    EXPECT_EQ(image_format_of(".x.Npy"), ImageFormat::npy);
    EXPECT_EQ(image_format_of("png"), std::nullopt);
    EXPECT_EQ(image_format_of("dir.png/file"), std::nullopt);
    EXPECT_EQ(image_format_of("a.jpg"), std::nullopt);
    EXPECT_EQ(image_format_of(""), std::nullopt);
    EXPECT_EQ(parse_image_format("exr"), ImageFormat::exr);
    EXPECT_EQ(parse_image_format("EXR"), std::nullopt);
}

}  // namespace
