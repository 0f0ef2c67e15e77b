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
    for (const std::size_t n : {1, 1000, (1 << 20) - 1, 1 << 20, (1 << 20) + 1, 5'000'000}) {
        AlignedVector<std::uint32_t> array(n);
        std::iota(array.begin(), array.end(), 0u);
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array.data()) % 64, 0u) << n;
        while (grown.size() < n) grown.push_back(static_cast<std::uint32_t>(grown.size()));
        EXPECT_EQ(grown, array) << n;
    }
}

}  // namespace
}  // namespace sightline
