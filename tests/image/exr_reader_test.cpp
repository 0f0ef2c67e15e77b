// EXR files read into memory: whole ones, others' ones and damaged ones.
#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>
#include <half.h>

#include <algorithm>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "sightline/composite.hpp"
#include "sightline/scene.hpp"
#include "support/files.hpp"

namespace {

using namespace sightline;
using sightline::testing::read_file;
using sightline::testing::TemporaryFolder;

constexpr float kInf = std::numeric_limits<float>::infinity();

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

TEST(ExrReader, ADeepFileComesBackAsItWas) {
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

TEST(ExrReader, AFlatFileComesBackAsItWas) {
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

TEST(ExrReader, TilesOtherTypesAndMissingAlpha) {
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

TEST(ExrReader, OfSeveralPartsTheFirstIsRead) {
    const TemporaryFolder folder;
    std::vector<Imf::Header> headers;
    for (const char* name : {"first", "second"}) {
        Imf::Header& header = headers.emplace_back(
            Imath::Box2i({0, 0}, {5, 8}), Imath::Box2i({0, 0}, {5, headers.empty() ? 4 : 8}));
        header.setName(name);
        header.setType(Imf::SCANLINEIMAGE);
        for (const char* channel : {"R", "G", "B", "A", "Z"}) {
            header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
        }
    }
    {
        Imf::MultiPartOutputFile file(folder.file("a.exr").c_str(), headers.data(), 2);
        for (int part = 0; part < 2; ++part) {
            const std::vector<float> values(6 * 9, static_cast<float>(part + 1));
            Imf::FrameBuffer frame;
            for (const char* channel : {"R", "G", "B", "A", "Z"}) {
                frame.insert(channel, Imf::Slice::Make(Imf::FLOAT, values.data(),
                                                       file.header(part).dataWindow()));
            }
            Imf::OutputPart output(file, part);
            output.setFrameBuffer(frame);
            output.writePixels(part == 0 ? 5 : 9);
        }
    }
    const auto read = read_exr(folder.file("a.exr"));
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(std::get<FlatPicture>(*read).color.pixels, std::vector<glm::vec4>(30, glm::vec4(1)));
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

TEST(ExrReader, WhatCanNotBeUsedIsNamed) {
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

TEST(ExrReader, DamagedFilesAreErrors) {
    const TemporaryFolder folder;
    ASSERT_TRUE(write_deep_exr(folder.file("deep.exr"), some_deep_image()).ok());
    damage(folder.file("deep.exr"));
    FlatPicture flat;
    flat.color = ColorImage(50, 3, glm::vec4(0.5f));
    flat.depth = DepthImage(50, 3, 2);
    ASSERT_TRUE(write_exr(folder.file("flat.exr"), layers_of(flat)).ok());
    damage(folder.file("flat.exr"));
    write_tiled(folder.file("tiled.exr"), {"R", "G", "B", "Z"});
    damage(folder.file("tiled.exr"));
}

TEST(ExrReader, AHeaderThatPromisesTooMuchIsRefused) {
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
