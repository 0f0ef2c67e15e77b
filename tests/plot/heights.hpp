// What the tests of height maps share.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "sightline/height_map.hpp"
#include "support/files.hpp"

namespace sightline::testing {

inline constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

/// The map has these heights, where NaN equals NaN.
inline void expect_heights(const Result<HeightMap>& map, const std::vector<double>& expected) {
    ASSERT_TRUE(map.ok()) << map.error().message;
    ASSERT_EQ(map->y.size(), expected.size());
    ASSERT_EQ(map->y.size(), map->x.size() * map->z.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const bool same =
            map->y[i] == expected[i] || (std::isnan(map->y[i]) && std::isnan(expected[i]));
        EXPECT_TRUE(same) << i << ": " << map->y[i] << " instead of " << expected[i];
    }
}

/// The load failed with one line that holds these words and tells a way out.
inline void expect_error(const Result<HeightMap>& map, const std::string& words,
                         ErrorKind kind = ErrorKind::bad_input) {
    ASSERT_FALSE(map.ok()) << "no error with " << words;
    const std::string& message = map.error().message;
    EXPECT_NE(message.find(words), std::string::npos) << message << "\ninstead of " << words;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_NE(message.find(';'), std::string::npos) << "no way out: " << message;
    EXPECT_EQ(map.error().kind, kind) << message;
}

/// A file of NumPy's, version 1 to 3.
inline std::string npy(const std::string& header, const std::string& data, int version = 1) {
    std::string out("\x93NUMPY", 6);
    out += static_cast<char>(version);
    out += '\0';
    for (int k = 0; k < (version == 1 ? 2 : 4); ++k) {
        out += static_cast<char>(header.size() >> 8 * k & 255);
    }
    return out + header + data;
}

/// The text of its header.
inline std::string npy_header(const std::string& type, const std::string& shape = "(2, 3)",
                              bool column_major = false) {
    return "{'descr': '" + type + "', 'fortran_order': " + (column_major ? "True" : "False") +
           ", 'shape': " + shape + ", }      \n";
}

/// Whatever the file holds, there is a map or an error of one line.
inline void expect_map_or_line(const std::string& path) {
    const Result<HeightMap> map = load_height_map(path);
    if (!map) {
        ASSERT_EQ(map.error().message.find('\n'), std::string::npos) << map.error().message;
        ASSERT_NE(map.error().message.find(';'), std::string::npos) << map.error().message;
        return;
    }
    ASSERT_GE(map->x.size(), 2u);
    ASSERT_GE(map->z.size(), 2u);
    ASSERT_EQ(map->y.size(), map->x.size() * map->z.size());
}

/// A few bytes changed, taken out, doubled or cut off.
inline std::string damaged(std::string bytes, std::mt19937& random) {
    const auto below = [&](std::size_t n) { return random() % std::max<std::size_t>(n, 1); };
    for (std::size_t k = 0; k <= below(3) && !bytes.empty(); ++k) {
        const std::size_t at = below(bytes.size());
        switch (below(6)) {
            case 0:
                bytes[at] = static_cast<char>(random());
                break;
            case 1:
                bytes[at] = static_cast<char>(bytes[at] ^ 1 << below(8));
                break;
            case 2:
                bytes.erase(at, below(8));
                break;
            case 3:
                bytes.insert(at, bytes.substr(below(bytes.size()), below(16)));
                break;
            case 4:
                bytes[at] = "0123456789,;'(){}-.eE#\n\xff"[below(24)];
                break;
            default:
                bytes.resize(at);
                break;
        }
    }
    return bytes;
}

/// Loads so many damaged copies of a file.
inline void check_damaged(const std::string& name, const std::string& bytes, int times) {
    const TemporaryFolder folder;
    std::mt19937 random(11);
    for (int i = 0; i < times; ++i) {
        expect_map_or_line(folder.write(name, damaged(bytes, random)));
        ASSERT_FALSE(::testing::Test::HasFailure()) << name << ", number " << i;
    }
}

}  // namespace sightline::testing
