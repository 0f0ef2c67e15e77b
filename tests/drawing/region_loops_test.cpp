// From pieces of borders to loops.
#include "drawing/region_loops.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/scenes.hpp"

namespace sightline {
namespace {

using testing::Random;
using Loop = std::vector<glm::ivec2>;

BorderPiece piece(glm::ivec2 from, glm::ivec2 to) {
    return {from, to, glm::dvec2(from), glm::dvec2(to)};
}

void add_loop(std::vector<BorderPiece>& pieces, const Loop& loop) {
    for (std::size_t i = 0; i < loop.size(); ++i)
        pieces.push_back(piece(loop[i], loop[(i + 1) % loop.size()]));
}

/// Clockwise on the page, whose y grows down.
Loop rectangle(int x0, int y0, int x1, int y1) { return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }
Loop hole(int x0, int y0, int x1, int y1) { return {{x0, y0}, {x0, y1}, {x1, y1}, {x1, y0}}; }

std::int64_t doubled_area(const Loop& loop) {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const glm::ivec2 p = loop[i], q = loop[(i + 1) % loop.size()];
        sum += std::int64_t{p.x} * q.y - std::int64_t{p.y} * q.x;
    }
    return sum;
}

/// The loops, whatever order the pieces have.
std::vector<Loop> joined(std::vector<BorderPiece> pieces) {
    Random random(pieces.size());
    for (std::size_t i = pieces.size(); i > 1; --i)
        std::swap(pieces[i - 1], pieces[random.below(static_cast<std::uint32_t>(i))]);
    RegionLoops loops;
    join_loops(pieces, loops);
    EXPECT_TRUE(pieces.empty());
    std::vector<Loop> all;
    for (std::size_t i = 1; i < loops.first.size(); ++i)
        all.emplace_back(loops.points.begin() + loops.first[i - 1],
                         loops.points.begin() + loops.first[i]);
    std::ranges::sort(all, {}, [](const Loop& l) { return doubled_area(l); });
    return all;
}

bool same_loop(Loop a, Loop b) {
    const auto key = [](const glm::ivec2& p) { return std::pair(p.x, p.y); };
    std::rotate(a.begin(), std::ranges::min_element(a, {}, key), a.end());
    std::rotate(b.begin(), std::ranges::min_element(b, {}, key), b.end());
    return a == b;
}

TEST(JoinLoops, NothingGivesNothing) { EXPECT_TRUE(joined({}).empty()); }

TEST(JoinLoops, ARectangleIsOneLoop) {
    std::vector<BorderPiece> pieces;
    add_loop(pieces, rectangle(0, 0, 10, 5));
    const auto loops = joined(pieces);
    ASSERT_EQ(loops.size(), 1u);
    EXPECT_TRUE(same_loop(loops[0], rectangle(0, 0, 10, 5)));
}

TEST(JoinLoops, PointsOnTheWayGoWhereverTheLoopBegins) {
    std::vector<BorderPiece> pieces;
    add_loop(pieces, {{0, 0}, {3, 0}, {7, 0}, {10, 0}, {10, 5}, {0, 5}, {0, 2}});
    // The first piece, that of the least point, begins in the middle of a side here.
    std::vector<BorderPiece> slanted;
    add_loop(slanted, {{0, 4}, {2, 2}, {4, 0}, {9, 9}});
    add_loop(slanted, {{-8, 20}, {-8, 30}, {-8, 40}, {-20, 40}, {-20, 20}});
    auto loops = joined(pieces);
    ASSERT_EQ(loops.size(), 1u);
    EXPECT_TRUE(same_loop(loops[0], rectangle(0, 0, 10, 5)));
    loops = joined(slanted);
    ASSERT_EQ(loops.size(), 2u);
    EXPECT_EQ(loops[0].size() + loops[1].size(), 7u);
}

TEST(JoinLoops, TheSeamOfTwoTrianglesGoes) {
    std::vector<BorderPiece> pieces;
    add_loop(pieces, {{0, 0}, {10, 0}, {10, 10}});
    add_loop(pieces, {{0, 0}, {10, 10}, {0, 10}});
    const auto loops = joined(pieces);
    ASSERT_EQ(loops.size(), 1u);
    EXPECT_TRUE(same_loop(loops[0], rectangle(0, 0, 10, 10)));
}

TEST(JoinLoops, ASeamInPiecesGoes) {
    std::vector<BorderPiece> pieces;
    add_loop(pieces, {{0, 0}, {10, 0}, {10, 10}, {6, 6}, {3, 3}});
    add_loop(pieces, {{0, 0}, {3, 3}, {6, 6}, {10, 10}, {0, 10}});
    const auto loops = joined(pieces);
    ASSERT_EQ(loops.size(), 1u);
    EXPECT_TRUE(same_loop(loops[0], rectangle(0, 0, 10, 10)));
}

TEST(JoinLoops, HolesRunTheOtherWay) {
    std::vector<BorderPiece> pieces;
    add_loop(pieces, rectangle(0, 0, 10, 10));
    add_loop(pieces, hole(2, 2, 8, 8));
    add_loop(pieces, rectangle(4, 4, 6, 6));
    const auto loops = joined(pieces);
    ASSERT_EQ(loops.size(), 3u);
    EXPECT_TRUE(same_loop(loops[0], hole(2, 2, 8, 8)));
    EXPECT_TRUE(same_loop(loops[1], rectangle(4, 4, 6, 6)));
    EXPECT_TRUE(same_loop(loops[2], rectangle(0, 0, 10, 10)));
}

TEST(JoinLoops, CornersThatTouchStayApart) {
    std::vector<BorderPiece> pieces;
    add_loop(pieces, rectangle(0, 0, 5, 5));
    add_loop(pieces, rectangle(5, 5, 10, 11));
    const auto loops = joined(pieces);
    ASSERT_EQ(loops.size(), 2u);
    EXPECT_TRUE(same_loop(loops[0], rectangle(0, 0, 5, 5)));
    EXPECT_TRUE(same_loop(loops[1], rectangle(5, 5, 10, 11)));
}

TEST(JoinLoops, PiecesWithoutLengthOrAreaGo) {
    std::vector<BorderPiece> pieces{piece({1, 1}, {1, 1})};
    add_loop(pieces, {{0, 0}, {5, 0}});
    add_loop(pieces, {{20, 0}, {25, 0}, {22, 0}});
    EXPECT_TRUE(joined(pieces).empty());
}

/// How often a loop runs clockwise around the middle of a unit square.
int winding(const Loop& loop, int x, int y) {
    int turns = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const glm::ivec2 p = loop[i], q = loop[(i + 1) % loop.size()];
        if (p.x > x && p.y <= y && q.y > y) ++turns;
        if (p.x > x && q.y <= y && p.y > y) --turns;
    }
    return turns;
}

bool has_point_on_the_way(const Loop& loop) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const glm::ivec2 u = loop[(i + 1) % loop.size()] - loop[i];
        const glm::ivec2 v = loop[(i + 2) % loop.size()] - loop[(i + 1) % loop.size()];
        if (u.x * v.y - u.y * v.x == 0) return true;
    }
    return false;
}

// A mesh of unit squares, some of them taken: whatever they are, both rules fill them and no
// others, and no point is in the middle of a straight line.
TEST(JoinLoops, FillAnyPattern) {
    constexpr int kSide = 6;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        Random random(seed);
        std::vector<BorderPiece> pieces;
        int taken[kSide][kSide] = {};
        for (int x = 0; x < kSide; ++x)
            for (int y = 0; y < kSide; ++y)
                if ((taken[x][y] = random.chance(0.6) ? 1 : 0) != 0)
                    add_loop(pieces, rectangle(x, y, x + 1, y + 1));
        const std::vector<Loop> loops = joined(pieces);
        EXPECT_TRUE(std::ranges::none_of(loops, has_point_on_the_way)) << seed;
        for (int x = 0; x < kSide; ++x)
            for (int y = 0; y < kSide; ++y) {
                int turns = 0;
                for (const Loop& loop : loops) turns += winding(loop, x, y);
                ASSERT_EQ(turns, taken[x][y]) << "seed " << seed << " at " << x << ", " << y;
            }
    }
}

}  // namespace
}  // namespace sightline
