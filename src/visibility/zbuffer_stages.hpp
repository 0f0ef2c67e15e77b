// The two SIMD stages of the z-buffer, and what they share with its driver.
//
// Samples are counted in columns and rows of the grid; sample (i, j) stands at
// (offset + i * step, offset + j * step) in units of the screen, step a power of two.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/visibility.hpp"

namespace sightline::zbuffer {

inline constexpr std::uint32_t kTileBits = 6;
inline constexpr std::uint32_t kTileSize = 1u << kTileBits;  ///< samples a side

/// The grid in the form in which the stages need it.
struct GridUnits {
    std::int32_t columns = 0, rows = 0;
    std::int32_t offset = 0;
    int step_bits = 0;  ///< step = 2^step_bits
    std::int32_t tiles_x = 0, tiles_y = 0;

    [[nodiscard]] std::int32_t position(std::int32_t index) const {
        return offset + (index << step_bits);
    }
};

/// A triangle that may cover samples, and the tiles that its box meets.
struct Selected {
    std::vector<std::uint32_t> triangle;  ///< number of the screen triangle
    std::vector<std::uint32_t> tile;      ///< first tile, row-major
    std::vector<std::uint32_t> more;      ///< further tiles: columns + (rows << 16)
    std::size_t count = 0;                ///< used length of the three
};

/// Screen triangles with consecutive numbers.
struct TriangleRange {
    std::span<const Corners> corners;
    std::span<const std::uint8_t> skip;  ///< empty, or a byte a triangle
    std::uint32_t first = 0;             ///< number of corners[0]
};

/// Geometry stage: drops what is skipped or whose box holds no sample (and boxes of one sample that
/// the triangle does not cover), many triangles at a time.
void select_triangles(const ScreenScene& screen, const GridUnits& grid, const TriangleRange& range,
                      Selected& out);

/// Depth and ids of a tile. A row is longer than the tile is wide, so that a full vector may be
/// stored from any column.
struct Tile {
    static constexpr std::uint32_t kStride = kTileSize + 16;
    alignas(64) float depth[kTileSize * kStride];
    alignas(64) std::uint32_t ids[kTileSize * kStride];
    std::int32_t column = 0, row = 0;  ///< of its first sample in the grid
    std::int32_t width = 0, height = 0;
};

struct TileCounts {
    std::uint64_t triangles = 0;  ///< set up in a tile
    std::uint64_t exact = 0;      ///< comparisons that the float filter could not decide
};

/// Raster stage: clears the tile's part of the picture.
void clear_tile(Tile& tile);

/// Raster stage: draws triangles, by number, into a tile.
void draw_triangles(const ScreenScene& screen, const GridUnits& grid,
                    std::span<const std::uint32_t> triangles, Observer* observer, Tile& tile,
                    TileCounts& counts);

}  // namespace sightline::zbuffer
