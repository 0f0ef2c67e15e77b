// The SIMD stages of the z-buffer, and what they share with its driver.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/visibility.hpp"
#include "visibility/sample_units.hpp"
#include "visibility/stored_depth.hpp"

namespace sightline::zbuffer {

inline constexpr std::uint32_t kTileBits = 6;
inline constexpr std::uint32_t kTileSize = 1u << kTileBits;  ///< samples a side

/// The samples, and the tiles that they are shared into.
struct GridUnits : SampleUnits {
    std::int32_t tiles_x = 0, tiles_y = 0;

    GridUnits(const SampleGrid& grid, int subpixel_bits)
        : SampleUnits(grid, subpixel_bits), tiles_x(tiles(columns)), tiles_y(tiles(rows)) {}

    [[nodiscard]] std::size_t tile_count() const {
        return static_cast<std::size_t>(tiles_x) * static_cast<std::size_t>(tiles_y);
    }

private:
    static std::int32_t tiles(std::int32_t samples) {
        return static_cast<std::int32_t>((static_cast<std::uint32_t>(samples) + kTileSize - 1) >>
                                         kTileBits);
    }
};

/// A triangle is tiny when its box has at most this many samples a side.
inline constexpr std::int32_t kTinySide = 3;

/// Triangles that may cover samples.
struct Selected {
    /// The tiny ones: their numbers.
    std::vector<std::uint32_t> tiny;
    std::size_t tiny_count = 0;
    /// The others: number, first tile (row-major), further tiles (columns + (rows << 16)).
    std::vector<std::uint32_t> triangle, tile, more;
    std::size_t count = 0;
};

/// A sample that a triangle covers, with its stored depth there.
struct Point {
    std::uint32_t place;  ///< tile << 12 | row in the tile << 6 | column in the tile
    float z;
    std::uint32_t id;
};
static_assert(2 * kTileBits == 12);

/// The samples of tiny triangles, before they are sorted by tile.
struct Points {
    std::vector<std::uint32_t> place, id;
    std::vector<float> z;
    std::size_t count = 0;
};

/// Screen triangles with consecutive numbers.
struct TriangleRange {
    std::span<const Corners> corners;
    std::span<const std::uint8_t> skip;  ///< empty, or a byte a triangle
    std::uint32_t first = 0;             ///< number of corners[0]
};

/// A rectangle of samples.
struct Area {
    std::int32_t column = 0, row = 0, width = 0, height = 0;
};

/// Depth and ids of a tile. A row is longer than the tile is wide, so that a full vector may be
/// stored from any column.
struct Tile {
    static constexpr std::uint32_t kStride = kTileSize + 16;
    static constexpr std::uint32_t kBlockBits = 3;  ///< a block is 8 x 8 samples
    static constexpr std::uint32_t kBlocks = kTileSize >> kBlockBits;

    alignas(64) float depth[kTileSize * kStride];
    alignas(64) std::uint32_t ids[kTileSize * kStride];
    /// Hierarchical depth: no stored depth of the block is greater.
    alignas(64) float block_max[kBlocks * kBlocks];
    float tile_max = 0;
    bool knows_depth = false;  ///< block_max holds more than infinities
    std::uint32_t drawn = 0;   ///< triangles since block_max was brought up to date

    std::int32_t column = 0, row = 0;  ///< of its first sample in the grid
    std::int32_t width = 0, height = 0;

    [[nodiscard]] Area area() const { return {column, row, width, height}; }
    [[nodiscard]] static std::size_t index(std::int32_t column, std::int32_t row) {
        return static_cast<std::size_t>(row) * kStride + static_cast<std::size_t>(column);
    }
};

struct TileCounts {
    std::uint64_t points = 0;     ///< samples of tiny triangles
    std::uint64_t triangles = 0;  ///< that passed the tests of their box in a tile
    std::uint64_t hidden = 0;     ///< dismissed by hierarchical depth
    std::uint64_t exact = 0;      ///< comparisons that the float filter could not decide
};

/// Depth of a sheet's shared plane, as depth_gradient() gives it. gx is NaN when the plane is not
/// in force.
struct SharedGradient {
    float gx, gy, z0;
    std::int32_t x, y;
};

/// What the raster stage needs to know.
struct RasterInput {
    const ScreenScene& screen;
    const GridUnits& grid;
    std::span<const SharedGradient> shared;  ///< by sheet
    Observer* observer = nullptr;
};

/// Beyond this distance two stored depths are in the order of the true ones. The sum or difference
/// of a depth and this is a float below 2^31, so it is off by at most 64.
inline constexpr float kUncertain = 1024.0f;
static_assert(kUncertain - 64 > 2 * kStoredDepthError);

/// The canonical order at a sample that two triangles cover: exact depth, then id.
[[nodiscard]] bool comes_before(const RasterInput& input, std::uint32_t id, std::uint32_t owner,
                                std::int32_t x, std::int32_t y, TileCounts& counts);

/// Geometry stage: drops what is skipped or whose box holds no sample (and boxes of one sample that
/// the triangle does not cover), many triangles at a time.
void select_triangles(const ScreenScene& screen, const GridUnits& grid, const TriangleRange& range,
                      Selected& out);

/// Geometry stage: draws the tiny triangles of a selection to points. What can't be (steep ones) is
/// appended to the others of the selection.
void draw_tiny(const RasterInput& input, Selected& selected, Points& out);

/// Clears a tile.
void clear_tile(Tile& tile);

/// Offers points to a tile.
void draw_points(const RasterInput& input, std::span<const Point> points, Tile& tile,
                 TileCounts& counts);

/// Draws triangles, by number, into a tile: many small ones at a time, the rest one by one.
void draw_triangles(const RasterInput& input, std::span<const std::uint32_t> triangles, Tile& tile,
                    TileCounts& counts);

/// Draws one triangle of any size and steepness; tells the observer of each step.
void draw_large(const RasterInput& input, std::uint32_t triangle, Tile& tile, TileCounts& counts);

/// Writes a tile that nothing fell into, whose samples need not be cleared.
void write_empty_tile(const Tile& tile, const GridUnits& grid, std::uint32_t* ids, float* depth);

/// Writes the tile's samples to the picture, past the caches where that is possible.
void write_tile(const Tile& tile, const GridUnits& grid, std::uint32_t* ids, float* depth);

}  // namespace sightline::zbuffer
