// Deep EXR files, read back through OpenEXR.
#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineInputFile.h>
#include <ImfHeader.h>
#include <ImfThreading.h>
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "image/deep_exr_writer.hpp"
#include "sightline/image.hpp"
#include "support/files.hpp"

namespace {

using namespace sightline;
using sightline::testing::read_file;
using sightline::testing::TemporaryFolder;

constexpr std::uint32_t kWidth = 23, kHeight = 70;

/// Some pixels without samples, some rows without any, else up to six.
DeepImage some_image() {
    DeepImage image{kWidth, kHeight, {0}, {}, {}};
    for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
        const std::uint32_t row = i / kWidth;
        const std::uint32_t count = row % 10 == 3 ? 0 : (i * 7919u) % 7;
        for (std::uint32_t s = 0; s < count; ++s) {
            const float f = static_cast<float>(i) + 0.1f * static_cast<float>(s);
            image.samples.push_back(
                {f, f + 0.05f, {f / 3, 0.25f, -f, 0.5f}, i % 5, i * 1'000'003u + s});
        }
        image.first.push_back(image.samples.size());
    }
    return image;
}

/// One channel of a file in its own type; nothing when it has another.
template <class T>
std::vector<T> channel(const std::string& path, const char* name, Imf::PixelType type,
                       std::vector<std::uint32_t>& counts) {
    Imf::DeepScanLineInputFile file(path.c_str(), 0);
    const Imf::Channel* found = file.header().channels().findChannel(name);
    if (found == nullptr || found->type != type) return {};
    const std::size_t pixels = std::size_t{kWidth} * kHeight;
    counts.assign(pixels, 0);
    std::vector<char*> addresses(pixels);
    Imf::DeepFrameBuffer frame;
    frame.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), 4, 4 * kWidth));
    frame.insert(name, Imf::DeepSlice(type, reinterpret_cast<char*>(addresses.data()),
                                      sizeof(char*), sizeof(char*) * kWidth, sizeof(T)));
    file.setFrameBuffer(frame);
    const int last = static_cast<int>(kHeight) - 1;
    file.readPixelSampleCounts(0, last);
    std::size_t all = 0;
    for (const std::uint32_t count : counts) all += count;
    std::vector<T> values(all);
    char* at = reinterpret_cast<char*>(values.data());
    for (std::size_t i = 0; i < pixels; ++i) {
        addresses[i] = at;
        at += counts[i] * sizeof(T);
    }
    file.readPixels(0, last);
    return values;
}

/// A number of each sample, as the file should have it.
template <class T, class Member>
void expect_channel(const std::string& path, const char* name, Imf::PixelType type,
                    const DeepImage& image, const Member& member) {
    SCOPED_TRACE(name);
    std::vector<std::uint32_t> counts;
    const std::vector<T> values = channel<T>(path, name, type, counts);
    ASSERT_EQ(values.size(), image.samples.size());
    for (std::size_t i = 0; i < counts.size(); ++i) {
        ASSERT_EQ(counts[i], image.pixel(i).size());
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
        ASSERT_EQ(values[i], member(image.samples[i]));
    }
}

TEST(DeepExr, OpenExrReadsEveryChannel) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.exr");
    const DeepImage image = some_image();
    const Status written = write_deep_exr(path, image);
    ASSERT_TRUE(written.ok()) << written.error().message;
    using S = DeepSample;
    expect_channel<float>(path, "Z", Imf::FLOAT, image, [](const S& s) { return s.z; });
    expect_channel<float>(path, "ZBack", Imf::FLOAT, image, [](const S& s) { return s.z_back; });
    expect_channel<float>(path, "R", Imf::FLOAT, image, [](const S& s) { return s.color.r; });
    expect_channel<float>(path, "G", Imf::FLOAT, image, [](const S& s) { return s.color.g; });
    expect_channel<float>(path, "B", Imf::FLOAT, image, [](const S& s) { return s.color.b; });
    expect_channel<float>(path, "A", Imf::FLOAT, image, [](const S& s) { return s.color.a; });
    expect_channel<std::uint32_t>(path, "object", Imf::UINT, image,
                                  [](const S& s) { return s.object; });
    expect_channel<std::uint32_t>(path, "triangle", Imf::UINT, image,
                                  [](const S& s) { return s.triangle; });
}

TEST(DeepExr, BytesDependOnThePixelsOnly) {
    const TemporaryFolder folder;
    const DeepImage image = some_image();
    ASSERT_TRUE(write_deep_exr(folder.file("a.exr"), image).ok());
    Imf::setGlobalThreadCount(4);
    ASSERT_TRUE(write_deep_exr(folder.file("b.exr"), image).ok());
    Imf::setGlobalThreadCount(0);
    auto writer = DeepExrWriter::create(folder.file("c.exr"), kWidth, kHeight);
    ASSERT_TRUE(writer.ok());
    for (std::size_t y = 0; y < kHeight; ++y) {  // row by row
        std::vector<std::uint32_t> counts;
        std::vector<DeepSample> samples;
        for (std::size_t i = y * kWidth; i < (y + 1) * kWidth; ++i) {
            const auto pixel = image.pixel(i);
            counts.push_back(static_cast<std::uint32_t>(pixel.size()));
            samples.insert(samples.end(), pixel.begin(), pixel.end());
        }
        ASSERT_TRUE(writer->write_rows({counts, samples}, 1).ok());
    }
    ASSERT_TRUE(writer->finish().ok());
    EXPECT_TRUE(read_file(folder.file("a.exr")) == read_file(folder.file("b.exr")));
    EXPECT_TRUE(read_file(folder.file("a.exr")) == read_file(folder.file("c.exr")));
}

TEST(DeepExr, APictureKeepsItsPlace) {
    const TemporaryFolder folder;
    DeepImage image = some_image();
    image.placement = {{-5, 17}, Placement::Frame{{0, 0}, {99, 49}}};
    ASSERT_TRUE(write_deep_exr(folder.file("a.exr"), image).ok());
    const Imf::DeepScanLineInputFile file(folder.file("a.exr").c_str(), 0);
    const Imath::Box2i data = file.header().dataWindow(), display = file.header().displayWindow();
    EXPECT_EQ(data.min, Imath::V2i(-5, 17));
    EXPECT_EQ(data.max, Imath::V2i(-5 + 22, 17 + 69));
    EXPECT_EQ(display.max, Imath::V2i(99, 49));
}

TEST(DeepExr, APictureWithoutSamples) {
    const TemporaryFolder folder;
    const DeepImage image{7, 3, std::vector<std::uint64_t>(22), {}, {}};
    ASSERT_TRUE(write_deep_exr(folder.file("a.exr"), image).ok());
    EXPECT_EQ(Imf::DeepScanLineInputFile(folder.file("a.exr").c_str(), 0).header().dataWindow(),
              Imath::Box2i({0, 0}, {6, 2}));
}

TEST(DeepExr, FailuresAreValuesAndLeaveNothing) {
    const TemporaryFolder folder;
    const DeepImage image = some_image();
    EXPECT_FALSE(write_deep_exr(folder.file("a.exr"), {}).ok());
    {
        auto unfinished = DeepExrWriter::create(folder.file("a.exr"), 8, 8);
        ASSERT_TRUE(unfinished.ok());
        const std::vector<std::uint32_t> counts(8);
        ASSERT_TRUE(unfinished->write_rows({counts, {}}, 1).ok());
    }
    EXPECT_EQ(folder.count(), 0);
    const Status full = write_deep_exr("/dev/full", image);
    ASSERT_FALSE(full.ok());
    EXPECT_NE(full.error().message.find("No space left"), std::string::npos);
    EXPECT_EQ(write_deep_exr(folder.file("no/a.exr"), image).error().kind, ErrorKind::io);
}

}  // namespace
