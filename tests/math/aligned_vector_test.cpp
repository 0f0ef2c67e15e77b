// Memory of large arrays.
#include "sightline/aligned_vector.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <numeric>

namespace sightline {
namespace {

TEST(AlignedVector, BeginsOnACacheLineAndKeepsWhatItHolds) {
    // Around the size from which on arrays lie in huge pages, and growing across it.
    AlignedVector<std::uint32_t> grown;
    constexpr std::size_t kLarge = std::size_t{1} << 20;
    for (const std::size_t n : {kLarge / 1000, kLarge - 1, kLarge, kLarge + 1, 5 * kLarge}) {
        AlignedVector<std::uint32_t> array(n);
        std::iota(array.begin(), array.end(), 0u);
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array.data()) % 64, 0u) << n;
        while (grown.size() < n) grown.push_back(static_cast<std::uint32_t>(grown.size()));
        EXPECT_EQ(grown, array) << n;
    }
}

}  // namespace
}  // namespace sightline
