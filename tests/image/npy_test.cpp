// The bytes of .npy files.
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "sightline/image.hpp"
#include "support/files.hpp"

namespace {

using namespace sightline;
using sightline::testing::read_file;
using sightline::testing::TemporaryFolder;

/// Checks magic, version, alignment and the header's text; what follows are the elements.
std::string data_of(const std::string& bytes, const std::string& header) {
    EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes.at(i)); };
    const std::size_t length = byte(8) + 256u * byte(9);
    EXPECT_EQ((10 + length) % 64, 0u);
    EXPECT_EQ(bytes.substr(10, header.size()), header);
    EXPECT_EQ(bytes.at(10 + length - 1), '\n');
    EXPECT_EQ(bytes.substr(10 + header.size(), length - header.size() - 1).find_first_not_of(' '),
              std::string::npos);
    return bytes.substr(10 + length);
}

template <class T>
void expect_data(const std::string& data, const Image<T>& image) {
    ASSERT_EQ(data.size(), image.pixels.size() * sizeof(T));
    EXPECT_EQ(std::memcmp(data.data(), image.pixels.data(), data.size()), 0);
}

TEST(Npy, EveryKindOfMap) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.npy");
    const auto header = [](const char* type, const char* shape) {
        return std::string("{'descr': '") + type + "', 'fortran_order': False, 'shape': " + shape +
               ", }";
    };
    DepthImage depth(3, 2);
    depth.pixels = {1, 2, 3, 4, 5, 6};
    ASSERT_TRUE(write_npy(path, depth).ok());
    expect_data(data_of(read_file(path), header("<f4", "(2, 3)")), depth);

    IdImage ids(3, 2);
    ids.pixels = {1, 2, 3, 4, 5, 0xFFFFFFFF};
    ASSERT_TRUE(write_npy(path, ids).ok());
    expect_data(data_of(read_file(path), header("<u4", "(2, 3)")), ids);

    const NormalImage normals(3, 2, glm::vec3(1, 2, 3));
    ASSERT_TRUE(write_npy(path, normals).ok());
    expect_data(data_of(read_file(path), header("<f4", "(2, 3, 3)")), normals);

    const MaskImage mask(3, 2, 1);
    ASSERT_TRUE(write_npy(path, mask).ok());
    expect_data(data_of(read_file(path), header("|u1", "(2, 3)")), mask);

    const ColorImage color(3, 2, glm::vec4(1, 2, 3, 4));
    ASSERT_TRUE(write_npy(path, color).ok());
    expect_data(data_of(read_file(path), header("<f4", "(2, 3, 4)")), color);
    EXPECT_EQ(folder.count(), 1);
}

TEST(Npy, FailuresAreValues) {
    const TemporaryFolder folder;
    const DepthImage depth(1'000, 1'000);
    EXPECT_FALSE(write_npy(folder.file("no/a.npy"), depth).ok());
    const Status full = write_npy("/dev/full", depth);
    ASSERT_FALSE(full.ok());
    EXPECT_NE(full.error().message.find("No space left"), std::string::npos);
}

}  // namespace
