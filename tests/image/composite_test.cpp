// Pictures joined by depth: the flat ones, the deep ones against the formulas, and the reader.
#include "sightline/composite.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>
#include <half.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "composite/optics.hpp"
#include "sightline/scene.hpp"
#include "support/files.hpp"

namespace sightline {

bool operator==(const DeepSample& a, const DeepSample& b) {
    return a.z == b.z && a.z_back == b.z_back && a.color == b.color && a.object == b.object &&
           a.triangle == b.triangle;
}

}  // namespace sightline

namespace {

using namespace sightline;
using sightline::testing::read_file;
using sightline::testing::TemporaryFolder;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// -- flat pictures -----------------------------------------------------------------------------

FlatPicture row_of(const std::vector<float>& depths, float shade) {
    FlatPicture picture;
    const auto width = static_cast<std::uint32_t>(depths.size());
    picture.color = ColorImage(width, 1, glm::vec4(shade, 0, 0, 1));
    picture.depth = DepthImage(width, 1);
    picture.depth.pixels = depths;
    picture.objects = IdImage(width, 1, static_cast<std::uint32_t>(shade));
    return picture;
}

TEST(CompositeFlat, TheNearestPixelWinsAndTiesGoToTheFirst) {
    std::vector<std::uint64_t> taken;
    CompositeOptions options;
    options.taken = &taken;
    const auto joined =
        composite({row_of({1, 5, 3, kInf, kInf, kNan, kNan}, 1),
                   row_of({2, 4, 3, kInf, 9, 7, kInf}, 2), row_of({3, 3, 3, kInf, 8, 8, kNan}, 3)},
                  options);
    ASSERT_TRUE(joined.ok());
    const auto& flat = std::get<FlatPicture>(*joined);
    const std::vector<std::uint32_t> owners = {1, 3, 1, 1, 3, 2, 1};
    EXPECT_EQ(flat.objects->pixels, owners);
    for (std::size_t i = 0; i < owners.size(); ++i) {
        EXPECT_EQ(flat.color.pixels[i].r, static_cast<float>(owners[i]));
    }
    EXPECT_EQ(flat.depth.pixels[1], 3);
    EXPECT_EQ(taken, (std::vector<std::uint64_t>{2, 1, 2}));
}

TEST(CompositeFlat, LayersThatNotAllHaveAreDropped) {
    auto without = row_of({1, 5}, 2);
    without.objects.reset();
    const auto joined = composite({row_of({2, 2}, 1), without});
    ASSERT_TRUE(joined.ok());
    EXPECT_FALSE(std::get<FlatPicture>(*joined).objects);
    const auto turned = composite({without, row_of({2, 2}, 1)});
    EXPECT_FALSE(std::get<FlatPicture>(*turned).objects);
}

TEST(CompositeFlat, MisfitsNameBothFiles) {
    const std::vector<std::string> names = {"a.exr", "b.exr"};
    CompositeOptions options;
    options.names = names;
    const auto expect = [&](std::vector<ExrPicture> pictures,
                            std::initializer_list<const char*> needles) {
        const auto joined = composite(std::move(pictures), options);
        ASSERT_FALSE(joined.ok());
        EXPECT_EQ(joined.error().kind, ErrorKind::bad_input);
        for (const char* needle : needles) {
            EXPECT_NE(joined.error().message.find(needle), std::string::npos)
                << joined.error().message;
        }
    };
    expect({row_of({1, 2}, 1), row_of({1, 2, 3}, 1)}, {"'a.exr' has 2x1", "'b.exr' has 3x1"});
    auto moved = row_of({1, 2}, 1);
    moved.placement.origin = {4, -2};
    expect({row_of({1, 2}, 1), moved}, {"a.exr", "(0, 0)", "b.exr", "(4, -2)"});
    const DeepImage deep{2, 1, {0, 0, 0}, {}, {}};
    expect({row_of({1, 2}, 1), deep}, {"'b.exr' is deep but 'a.exr' is flat"});
    expect({deep, row_of({1, 2}, 1)}, {"'a.exr' is deep but 'b.exr' is flat"});
}

// -- one deep pixel ----------------------------------------------------------------------------

using Samples = std::vector<DeepSample>;

DeepImage pixel_of(const Samples& samples) { return {1, 1, {0, samples.size()}, samples, {}}; }

Samples joined(const std::vector<Samples>& pixels) {
    std::vector<ExrPicture> pictures;
    for (const Samples& pixel : pixels) pictures.emplace_back(pixel_of(pixel));
    const auto result = composite(std::move(pictures));
    return std::get<DeepImage>(*result).samples;
}

/// The formulas of the text for a part and for two samples that coincide, with the C library.
glm::dvec4 part_of(const glm::dvec4& c, double t) {
    if (c.a >= 1) return c;
    if (c.a <= 0) return c * t;
    const double alpha = -std::expm1(t * std::log1p(-c.a));
    return {glm::dvec3(c) * (alpha / c.a), alpha};
}

glm::dvec4 merge(const glm::dvec4& c1, const glm::dvec4& c2) {
    if (c1.a >= 1 && c2.a >= 1) return (c1 + c2) * 0.5;
    if (c1.a >= 1) return c1;
    if (c2.a >= 1) return c2;
    const double alpha = c1.a + c2.a - c1.a * c2.a;
    const double u1 = -std::log1p(-c1.a), u2 = -std::log1p(-c2.a), u = u1 + u2;
    const double v1 = c1.a > 0 ? u1 / c1.a : 1, v2 = c2.a > 0 ? u2 / c2.a : 1;
    const double w = u > 0 ? alpha / u : 1;
    return {(glm::dvec3(c1) * v1 + glm::dvec3(c2) * v2) * w, alpha};
}

void expect_near(const DeepSample& sample, float z, float z_back, const glm::dvec4& color) {
    EXPECT_EQ(sample.z, z);
    EXPECT_EQ(sample.z_back, z_back);
    for (int k = 0; k < 4; ++k) {
        EXPECT_NEAR(sample.color[k], color[k], 1e-6 * std::abs(color[k])) << "component " << k;
    }
}

void expect_tidy(std::span<const DeepSample> samples) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
        ASSERT_LE(samples[i].z, samples[i].z_back);
        if (i == 0) continue;
        const DeepSample &a = samples[i - 1], &b = samples[i];
        ASSERT_LE(a.z_back, b.z);
        ASSERT_FALSE(a.z == a.z_back && b.z == b.z_back && a.z == b.z);
    }
}

TEST(CompositeOptics, FollowTheCLibrary) {
    EXPECT_EQ(optical_depth(0), 0);
    EXPECT_EQ(optical_depth(1), std::numeric_limits<double>::infinity());
    EXPECT_EQ(opacity(0), 0);
    EXPECT_EQ(opacity(std::numeric_limits<double>::infinity()), 1);
    for (float alpha = 0x1p-126f; alpha < 1; alpha *= 1.37f) {
        const double depth = -std::log1p(-double{alpha});
        ASSERT_NEAR(optical_depth(alpha), depth, 1e-14 * depth) << alpha;
        ASSERT_NEAR(opacity(depth), alpha, 1e-13 * alpha) << alpha;
        ASSERT_EQ(static_cast<float>(opacity(optical_depth(alpha))), alpha);
    }
    EXPECT_EQ(static_cast<float>(opacity(optical_depth(0x1p-149f))), 0x1p-149f);
    EXPECT_NEAR(optical_depth(1 - 0x1p-24f), 24 * std::log(2.0), 1e-12);
}

TEST(CompositeDeep, OverlappingVolumesAreSplitAndMerged) {
    const DeepSample a{1, 4, {0.3f, 0.1f, 0, 0.5f}, 10, 100};
    const DeepSample b{2, 8, {0, 0.4f, 0.2f, 0.8f}, 20, 200};
    const Samples out = joined({{a}, {b}});
    ASSERT_EQ(out.size(), 3U);
    expect_tidy(out);
    const glm::dvec4 ca = a.color, cb = b.color;
    expect_near(out[0], 1, 2, part_of(ca, 1.0 / 3));
    expect_near(out[1], 2, 4, merge(part_of(ca, 2.0 / 3), part_of(cb, 2.0 / 6)));
    expect_near(out[2], 4, 8, part_of(cb, 4.0 / 6));
    EXPECT_EQ(out[0].object, 10U);
    // In the middle b absorbs more: ln 5 / 3 > 2 ln 2 / 3.
    EXPECT_EQ(out[1].object, 20U);
    EXPECT_EQ(out[1].triangle, 200U);
    EXPECT_EQ(out[2].object, 20U);
}

TEST(CompositeDeep, ASurfaceInAVolumeSplitsIt) {
    const DeepSample fog{0, 4, {0.2f, 0.2f, 0.2f, 0.4f}, 1, 1}, wall{1, 1, {1, 0, 0, 1}, 2, 2};
    const Samples out = joined({{fog}, {wall}});
    ASSERT_EQ(out.size(), 3U);
    expect_near(out[0], 0, 1, part_of(fog.color, 0.25));
    EXPECT_EQ(out[1], wall);
    expect_near(out[2], 1, 4, part_of(fog.color, 0.75));
}

TEST(CompositeDeep, NeighboursAreNoOverlap) {
    const DeepSample front{1, 2, {0.1f, 0, 0, 0.2f}, 1, 1}, back{2, 3, {0, 0.1f, 0, 0.2f}, 2, 2},
        wall{3, 3, {0, 0, 1, 1}, 3, 3}, film{1, 1, {0, 0, 0.1f, 0.1f}, 4, 4};
    EXPECT_EQ(joined({{wall, back}, {front, film}}), (Samples{film, front, back, wall}));
}

TEST(CompositeDeep, SamplesThatCoincideAreMerged) {
    const auto merged = [](const glm::vec4& a, const glm::vec4& b) {
        const Samples out = joined({{{2, 3, a, 1, 1}}, {{2, 3, b, 2, 2}}});
        EXPECT_EQ(out.size(), 1U);
        expect_near(out[0], 2, 3, merge(a, b));
        return out[0];
    };
    EXPECT_EQ(merged({0.1f, 0.2f, 0.3f, 0.5f}, {0.4f, 0.2f, 0, 0.5f}).object, 1U);  // a tie
    EXPECT_EQ(merged({0.1f, 0.2f, 0.3f, 0.5f}, {0.4f, 0.2f, 0, 0.6f}).object, 2U);
    EXPECT_EQ(merged({1, 0, 0, 1}, {0, 1, 0, 1}).object, 1U);        // two opaque ones
    EXPECT_EQ(merged({0.4f, 0, 0, 0.9f}, {0, 1, 0, 1}).object, 2U);  // one
    merged({0.5f, 0, 0, 0}, {0, 0.25f, 0, 0});                       // fire: light without alpha
    merged({0.5f, 0, 0, 0}, {0, 0.25f, 0, 0.25f});
    merged({0, 0, 0, 0}, {0, 0, 0, 0});
    merged({1e-20f, 0, 0, 1e-20f}, {0, 1e-9f, 0, 1e-9f});
    const Samples surfaces =
        joined({{{2, 2, {0.5f, 0, 0, 0.5f}, 1, 1}}, {{2, 2, {0, 0.25f, 0, 0.25f}, 2, 2}}});
    ASSERT_EQ(surfaces.size(), 1U);
    expect_near(surfaces[0], 2, 2, merge({0.5, 0, 0, 0.5}, {0, 0.25, 0, 0.25}));
}

TEST(CompositeDeep, OddSamplesAreMadeReasonable) {
    const Samples out = joined({{{kNan, 1, glm::vec4(1), 1, 1},
                                 {5, 3, {0, 0, 0, 2}, 2, 2},
                                 {4, kNan, {1, 0, 0, -1}, 3, 3},
                                 {kInf, kInf, {0, 0, 1, 1}, 4, 4}}});
    EXPECT_EQ(out, (Samples{{4, 4, {1, 0, 0, 0}, 3, 3},
                            {5, 5, {0, 0, 0, 1}, 2, 2},
                            {kInf, kInf, {0, 0, 1, 1}, 4, 4}}));
    // A volume without an end has a finite one, so that its parts can be told.
    const Samples endless =
        joined({{{1, kInf, {0.5f, 0, 0, 0.5f}, 1, 1}}, {{2, 2, {0, 0, 1, 1}, 2, 2}}});
    ASSERT_EQ(endless.size(), 3U);
    expect_tidy(endless);
    for (const DeepSample& sample : endless) EXPECT_TRUE(std::isfinite(sample.color.r));
}

TEST(CompositeDeep, TheOrderOfFilesAndSamplesDoesNotMatterForTheLook) {
    std::mt19937 random(7);
    const auto number = [&](std::uint32_t n) { return static_cast<float>(random() % n); };
    for (int round = 0; round < 300; ++round) {
        std::vector<Samples> pixels(1 + random() % 4);
        for (Samples& pixel : pixels) {
            pixel.resize(random() % 6);
            for (DeepSample& sample : pixel) {
                sample.z = number(10);
                sample.z_back = sample.z + number(4);
                const float alpha = number(9) / 8;
                sample.color = {alpha * number(5) / 4, 0, alpha, alpha};
            }
        }
        const Samples out = joined(pixels);
        expect_tidy(out);
        const FlatPicture look = flatten(pixel_of(out));
        // A tidy list stays as it is, and one untidy list looks like many.
        ASSERT_EQ(joined({out}), out);
        Samples all;
        for (const Samples& pixel : pixels) all.insert(all.end(), pixel.rbegin(), pixel.rend());
        const FlatPicture other = flatten(pixel_of(all));
        EXPECT_EQ(look.depth.pixels[0], other.depth.pixels[0]);
        for (int k = 0; k < 4; ++k) {
            EXPECT_NEAR(look.color.pixels[0][k], other.color.pixels[0][k], 2e-6f);
        }
    }
}

TEST(CompositeDeep, TwoFilesFlattenAsTheirSamplesOverOneAnother) {
    const DeepSample near{1, 1, {0.2f, 0.1f, 0, 0.4f}, 1, 1},
        middle{2, 3, {0, 0.3f, 0, 0.5f}, 2, 2}, far{4, 4, {0, 0, 1, 1}, 3, 3},
        hidden{5, 5, {1, 1, 1, 1}, 4, 4};
    const DeepImage image = pixel_of(joined({{hidden, near, far}, {middle}}));
    const FlatPicture flat = flatten(image);
    const auto over = [](const glm::vec4& a, const glm::vec4& b) { return a + (1 - a.a) * b; };
    const glm::vec4 wanted = over(near.color, over(middle.color, far.color));
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(flat.color.pixels[0][k], wanted[k], 1e-6f);
    EXPECT_EQ(flat.depth.pixels[0], 1);
    const FlatPicture nothing = flatten(pixel_of({}));
    EXPECT_EQ(nothing.color.pixels[0], glm::vec4(0));
    EXPECT_EQ(nothing.depth.pixels[0], kInf);
    const FlatPicture clear = flatten(pixel_of({{1, 1, {0, 0, 0, 0}, 1, 1}, far}));
    EXPECT_EQ(clear.depth.pixels[0], 4);
}

// -- the reader --------------------------------------------------------------------------------

DeepImage some_deep_image() {
    DeepImage image{19, 40, {0}, {}, {{-3, 5}, Placement::Frame{{0, 0}, {63, 47}}}};
    for (std::uint32_t i = 0; i < 19 * 40; ++i) {
        for (std::uint32_t s = 0; s < i * 31 % 4; ++s) {
            const auto z = static_cast<float>(i + 10 * s);
            image.samples.push_back({z, z + 0.5f, {0.1f, z, 0.3f, 0.5f}, i % 5, i * 7 + s});
        }
        image.first.push_back(image.samples.size());
    }
    return image;
}

TEST(CompositeReader, ADeepFileComesBackAsItWas) {
    const TemporaryFolder folder;
    const DeepImage image = some_deep_image();
    ASSERT_TRUE(write_deep_exr(folder.file("a.exr"), image).ok());
    const auto read = read_exr(folder.file("a.exr"));
    ASSERT_TRUE(read.ok()) << read.error().message;
    ASSERT_TRUE(std::holds_alternative<DeepImage>(*read));
    const auto& deep = std::get<DeepImage>(*read);
    EXPECT_EQ(deep.width, 19U);
    EXPECT_EQ(deep.height, 40U);
    EXPECT_EQ(deep.first, image.first);
    EXPECT_EQ(deep.samples, image.samples);
    // Joined with nothing, it is written with the same bytes.
    const auto again = composite({*read});
    ASSERT_TRUE(write_deep_exr(folder.file("b.exr"), std::get<DeepImage>(*again)).ok());
    EXPECT_TRUE(read_file(folder.file("a.exr")) == read_file(folder.file("b.exr")));
}

TEST(CompositeReader, AFlatFileComesBackAsItWas) {
    const TemporaryFolder folder;
    FlatPicture flat;
    flat.color = ColorImage(37, 300);
    flat.depth = DepthImage(37, 300);
    flat.normals = NormalImage(37, 300);
    flat.objects = IdImage(37, 300);
    flat.triangles = IdImage(37, 300);
    for (std::uint32_t i = 0; i < 37 * 300; ++i) {
        const auto f = static_cast<float>(i);
        flat.color.pixels[i] = {f / 7, 1e-7f * f, -f, 1};
        flat.depth.pixels[i] = i % 3 == 0 ? kInf : 1 / f;
        flat.normals->pixels[i] = {f, 0.1f, -f};
        flat.objects->pixels[i] = i % 3 == 0 ? kNone : i;
        flat.triangles->pixels[i] = i * 1'000'003u;
    }
    flat.placement = {{4, -9}, Placement::Frame{{0, 0}, {50, 50}}};
    ASSERT_TRUE(write_exr(folder.file("a.exr"), layers_of(flat)).ok());
    const auto read = read_exr(folder.file("a.exr"));
    ASSERT_TRUE(read.ok()) << read.error().message;
    const auto& back = std::get<FlatPicture>(*read);
    EXPECT_EQ(back.depth.pixels, flat.depth.pixels);
    EXPECT_EQ(back.triangles->pixels, flat.triangles->pixels);
    EXPECT_EQ(back.placement.origin, glm::ivec2(4, -9));
    ASSERT_TRUE(write_exr(folder.file("b.exr"), layers_of(back)).ok());
    EXPECT_TRUE(read_file(folder.file("a.exr")) == read_file(folder.file("b.exr")));
}

/// A tiled file of 50x20 pixels with float colours, half depth and no alpha, beginning at (-7, 3).
void write_tiled(const std::string& path, std::initializer_list<const char*> names) {
    Imf::Header header(Imath::Box2i({0, 0}, {99, 99}), Imath::Box2i({-7, 3}, {42, 22}));
    header.setTileDescription(Imf::TileDescription(16, 16, Imf::ONE_LEVEL));
    std::vector<std::vector<float>> values;
    Imf::FrameBuffer frame;
    for (const char* name : names) {
        const bool depth = name == std::string("Z");
        header.channels().insert(name, Imf::Channel(depth ? Imf::HALF : Imf::FLOAT));
    }
    std::vector<half> depth(50 * 20);
    for (std::size_t i = 0; i < depth.size(); ++i) {
        depth[i] = i % 2 == 0 ? half::posInf() : half(static_cast<float>(i));
    }
    values.reserve(names.size());
    for (const char* name : names) {
        if (name == std::string("Z")) {
            frame.insert(name, Imf::Slice::Make(Imf::HALF, depth.data(), header.dataWindow()));
            continue;
        }
        values.emplace_back(50 * 20, 0.1f * static_cast<float>(values.size() + 1));
        frame.insert(name, Imf::Slice::Make(Imf::FLOAT, values.back().data(), header.dataWindow()));
    }
    Imf::TiledOutputFile file(path.c_str(), header);
    file.setFrameBuffer(frame);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
}

TEST(CompositeReader, TilesOtherTypesAndMissingAlpha) {
    const TemporaryFolder folder;
    write_tiled(folder.file("a.exr"), {"R", "G", "B", "Z"});
    const auto read = read_exr(folder.file("a.exr"));
    ASSERT_TRUE(read.ok()) << read.error().message;
    const auto& flat = std::get<FlatPicture>(*read);
    EXPECT_EQ(flat.placement.origin, glm::ivec2(-7, 3));
    EXPECT_FALSE(flat.normals || flat.objects || flat.triangles);
    for (std::size_t i = 0; i < flat.color.pixels.size(); ++i) {
        ASSERT_EQ(flat.color.pixels[i], glm::vec4(0.1f, 0.2f, 0.1f * 3, i % 2 == 0 ? 0 : 1));
        ASSERT_EQ(flat.depth.pixels[i], i % 2 == 0 ? kInf : static_cast<float>(i));
    }
}

void expect_unreadable(const std::string& path, std::initializer_list<const char*> needles) {
    SCOPED_TRACE(path);
    const auto read = read_exr(path);
    ASSERT_FALSE(read.ok());
    EXPECT_EQ(exit_status(read.error().kind), 1);
    EXPECT_EQ(read.error().message.find('\n'), std::string::npos);
    EXPECT_NE(read.error().message.find(path), std::string::npos) << read.error().message;
    for (const char* needle : needles) {
        EXPECT_NE(read.error().message.find(needle), std::string::npos) << read.error().message;
    }
}

TEST(CompositeReader, WhatCanNotBeUsedIsNamed) {
    const TemporaryFolder folder;
    expect_unreadable(folder.file("none.exr"), {"No such file"});
    expect_unreadable(folder.path(), {"no ordinary file"});
    expect_unreadable(folder.write("text.exr", "v 0 0 0\n"), {"no EXR file"});
    expect_unreadable(folder.write("empty.exr", ""), {"no EXR file"});
    write_tiled(folder.file("flat.exr"), {"R", "G", "B", "A"});
    expect_unreadable(folder.file("flat.exr"), {"'Z'"});
    write_tiled(folder.file("depth.exr"), {"Z"});
    expect_unreadable(folder.file("depth.exr"), {"'R'"});
}

/// Every file that is cut off is an error; one with changed bytes is read or an error.
void damage(const std::string& path) {
    const std::string whole = read_file(path);
    for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 97) {
        sightline::testing::write_file(path, whole.substr(0, size));
        const auto read = read_exr(path);
        ASSERT_FALSE(read.ok()) << "cut off after " << size << " of " << whole.size();
        ASSERT_EQ(exit_status(read.error().kind), 1);
    }
    std::mt19937 random(3);
    for (int round = 0; round < 500; ++round) {
        std::string bytes = whole;
        // The header more often than the pixels.
        const std::size_t range =
            round % 2 == 0 ? std::min<std::size_t>(700, whole.size()) : whole.size();
        for (int i = 0; i <= round % 3; ++i) bytes[random() % range] = static_cast<char>(random());
        sightline::testing::write_file(path, bytes);
        const auto read = read_exr(path);
        if (read.ok()) continue;
        ASSERT_EQ(read.error().message.find('\n'), std::string::npos);
    }
}

TEST(CompositeReader, DamagedFilesAreErrors) {
    const TemporaryFolder folder;
    ASSERT_TRUE(write_deep_exr(folder.file("deep.exr"), some_deep_image()).ok());
    damage(folder.file("deep.exr"));
    FlatPicture flat = row_of(std::vector<float>(50, 2), 1);
    ASSERT_TRUE(write_exr(folder.file("flat.exr"), layers_of(flat)).ok());
    damage(folder.file("flat.exr"));
    write_tiled(folder.file("tiled.exr"), {"R", "G", "B", "Z"});
    damage(folder.file("tiled.exr"));
}

TEST(CompositeReader, AHeaderThatPromisesTooMuchIsRefused) {
    const TemporaryFolder folder;
    for (const int side : {65'536, 70'000}) {
        Imf::Header header(side, side == 70'000 ? 1 : 4'097);
        for (const char* name : {"R", "G", "B", "Z"}) {
            header.channels().insert(name, Imf::Channel(Imf::HALF));
        }
        const std::string path = folder.file(std::to_string(side) + ".exr");
        { const Imf::OutputFile unwritten(path.c_str(), header); }
        expect_unreadable(path, {"pixels", "2^28"});
    }
}

}  // namespace
