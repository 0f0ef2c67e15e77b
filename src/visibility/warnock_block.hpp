// Quadrants that are not divided: the nearest surface at each sample of a small block.
#pragma once

#include <cstddef>
#include <cstdint>

namespace sightline::warnock {

inline constexpr int kBlockBits = 4;
inline constexpr std::int32_t kBlockSide = 1 << kBlockBits;  ///< samples

/// Who is nearest so far, row by row; kBlockSide samples a row.
struct Block {
    static constexpr std::size_t kSamples = std::size_t{kBlockSide} * kBlockSide;
    static constexpr std::int64_t kNobody = -1;

    alignas(64) double depth[kSamples];
    alignas(64) std::int64_t owner[kSamples];

    void clear();
};

/// A triangle that wants samples of a block. Columns and rows are the block's, inclusive.
struct Newcomer {
    std::int64_t owner = Block::kNobody;
    std::int32_t column0 = 0, column1 = 0, row0 = 0, row1 = 0;
    /// Edge functions at (column0, row0): not negative where a sample is inside. Below 2^29.
    std::int32_t edge[3]{}, per_column[3]{}, per_row[3]{};
    /// Depth at (column c, row r) is (z0 + gy * (j + r)) + gx * (i + c).
    double z0 = 0, gx = 0, gy = 0;
    std::int32_t i = 0, j = 0;  ///< the block's first sample in the picture
    double slack = 0;           ///< depths further apart than this are in the true order
};

/// Samples that depth alone does not decide.
struct Doubts {
    std::size_t count = 0;
    std::uint8_t at[Block::kSamples];
};
static_assert(Block::kSamples <= 256);

/// Gives the newcomer what it covers and is clearly nearer at; returns how many samples it covers.
/// Those whose depths are nearer than the slack stay with their owner and are left in `doubts`.
std::uint32_t offer(const Newcomer& newcomer, Block& block, Doubts& doubts);

}  // namespace sightline::warnock
