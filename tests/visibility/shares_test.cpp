// Numbers shared out among workers.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "visibility/parallel.hpp"

namespace sightline {
namespace {

TEST(Shares, EveryNumberIsTakenOnceWhoeverComes) {
    for (const std::size_t n : {0u, 1u, 2u, 7u, 64u}) {
        for (const std::uint32_t workers : {1u, 2u, 3u, 16u}) {
            for (std::uint32_t absent = 0; absent <= workers; ++absent) {
                if (workers == 1 && absent == 0) continue;  // somebody has to come
                Shares shares(n, workers);
                std::vector<int> taken(n, 0);
                for (std::uint32_t w = 0; w < workers; ++w)
                    if (w != absent) shares.take(w, [&](std::size_t i) { ++taken.at(i); });
                EXPECT_EQ(taken, std::vector<int>(n, 1)) << n << ' ' << workers << ' ' << absent;
            }
        }
    }
}

TEST(Shares, BeginWithAPartOfOnesOwn) {
    Shares shares(10, 2);
    std::vector<std::size_t> order;
    shares.take(1, [&](std::size_t i) { order.push_back(i); });
    EXPECT_EQ(order, (std::vector<std::size_t>{5, 6, 7, 8, 9, 0, 1, 2, 3, 4}));
}

}  // namespace
}  // namespace sightline
