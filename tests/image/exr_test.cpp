// EXR files read back through OpenEXR.
#include <ImathBox.h>
#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfThreading.h>
#include <gtest/gtest.h>
#include <half.h>

#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "image/exr_writer.hpp"
#include "sightline/image.hpp"
#include "sightline/scene.hpp"
#include "support/files.hpp"

namespace {

using namespace sightline;
using sightline::testing::read_file;
using sightline::testing::TemporaryFolder;

constexpr std::uint32_t kWidth = 23, kHeight = 150;  // neither a multiple of any block

struct Layers {
    ColorImage color{kWidth, kHeight};
    DepthImage depth{kWidth, kHeight};
    NormalImage normals{kWidth, kHeight};
    IdImage objects{kWidth, kHeight}, triangles{kWidth, kHeight};

    Layers() {
        for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
            const float f = static_cast<float>(i);
            color.pixels[i] = {f / 7, 0.1f, 1 - f / 5'000, 0.5f};
            depth.pixels[i] = i % 5 == 0 ? std::numeric_limits<float>::infinity() : f * 0.1f;
            normals.pixels[i] = {f, -f, 1 / (f + 1)};
            objects.pixels[i] = i % 7 == 0 ? kNone : i % 3;
            triangles.pixels[i] = i * 1'000'003u;
        }
    }
    [[nodiscard]] ExrLayers all() const { return {&color, &depth, &normals, &objects, &triangles}; }
};

/// One channel of a file in its own type.
template <class T>
std::vector<T> channel(const std::string& path, const char* name, Imf::PixelType type) {
    Imf::InputFile file(path.c_str(), 0);
    const Imf::Channel* found = file.header().channels().findChannel(name);
    if (found == nullptr || found->type != type) return {};
    const Imath::Box2i window = file.header().dataWindow();
    const auto width = static_cast<std::size_t>(window.max.x + 1);
    std::vector<T> values(width * static_cast<std::size_t>(window.max.y + 1));
    Imf::FrameBuffer frame;
    frame.insert(name, Imf::Slice(type, reinterpret_cast<char*>(values.data()), sizeof(T),
                                  sizeof(T) * width));
    file.setFrameBuffer(frame);
    file.readPixels(0, window.max.y);
    return values;
}

TEST(Exr, EveryChannelReadsBack) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.exr");
    const Layers layers;
    const Status written = write_exr(path, layers.all());
    ASSERT_TRUE(written.ok()) << written.error().message;
    EXPECT_EQ(channel<float>(path, "Z", Imf::FLOAT), layers.depth.pixels);
    EXPECT_EQ(channel<std::uint32_t>(path, "object", Imf::UINT), layers.objects.pixels);
    EXPECT_EQ(channel<std::uint32_t>(path, "triangle", Imf::UINT), layers.triangles.pixels);
    constexpr const char* kColors[] = {"R", "G", "B", "A"};
    for (int k = 0; k < 4; ++k) {
        const auto values = channel<half>(path, kColors[k], Imf::HALF);
        ASSERT_EQ(values.size(), layers.color.pixels.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            ASSERT_EQ(values[i], half(layers.color.pixels[i][k]));
        }
    }
    constexpr const char* kNormals[] = {"N.X", "N.Y", "N.Z"};
    for (int k = 0; k < 3; ++k) {
        const auto values = channel<float>(path, kNormals[k], Imf::FLOAT);
        ASSERT_EQ(values.size(), layers.normals.pixels.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            ASSERT_EQ(values[i], layers.normals.pixels[i][k]);
        }
    }
}

TEST(Exr, AbsentLayersLeaveTheirChannelsOut) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.exr");
    const Layers layers;
    ASSERT_TRUE(write_exr(path, {.depth = &layers.depth}).ok());
    Imf::InputFile file(path.c_str(), 0);
    EXPECT_NE(file.header().channels().findChannel("Z"), nullptr);
    EXPECT_EQ(file.header().channels().findChannel("R"), nullptr);
    EXPECT_EQ(file.header().channels().findChannel("object"), nullptr);
}

TEST(Exr, BytesDependOnThePixelsOnly) {
    const TemporaryFolder folder;
    const Layers layers;
    ASSERT_TRUE(write_exr(folder.file("a.exr"), layers.all()).ok());
    Imf::setGlobalThreadCount(4);
    ASSERT_TRUE(write_exr(folder.file("b.exr"), layers.all()).ok());
    Imf::setGlobalThreadCount(0);
    auto writer =
        ExrWriter::create(folder.file("c.exr"), kWidth, kHeight, {true, true, true, true, true});
    ASSERT_TRUE(writer.ok());
    for (std::uint32_t y = 0; y < kHeight; ++y) {  // row by row
        const ExrRows row{&layers.color.at(0, y), &layers.depth.at(0, y), &layers.normals.at(0, y),
                          &layers.objects.at(0, y), &layers.triangles.at(0, y)};
        ASSERT_TRUE(writer->write_rows(row, 1).ok());
    }
    ASSERT_TRUE(writer->finish().ok());
    EXPECT_EQ(read_file(folder.file("a.exr")), read_file(folder.file("b.exr")));
    EXPECT_EQ(read_file(folder.file("a.exr")), read_file(folder.file("c.exr")));
}

TEST(Exr, FailuresAreValuesAndLeaveNothing) {
    const TemporaryFolder folder;
    const Layers layers;
    const DepthImage other(3, 3);
    EXPECT_FALSE(write_exr(folder.file("a.exr"), {}).ok());
    EXPECT_FALSE(write_exr(folder.file("a.exr"), {.color = &layers.color, .depth = &other}).ok());
    const DepthImage empty;
    EXPECT_FALSE(write_exr(folder.file("a.exr"), {.depth = &empty}).ok());
    {
        auto unfinished = ExrWriter::create(folder.file("a.exr"), 8, 8, {.depth = true});
        ASSERT_TRUE(unfinished.ok());
        ASSERT_TRUE(unfinished->write_rows({.depth = layers.depth.pixels.data()}, 3).ok());
    }
    EXPECT_EQ(folder.count(), 0);
    const Status full = write_exr("/dev/full", layers.all());
    ASSERT_FALSE(full.ok());
    EXPECT_NE(full.error().message.find("No space left"), std::string::npos);
    EXPECT_EQ(write_exr(folder.file("no/a.exr"), layers.all()).error().kind, ErrorKind::io);
}

}  // namespace
