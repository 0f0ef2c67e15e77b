// The SIMD stages of the z-buffer, and what they share with its driver.
#pragma once

#include <atomic>
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
    /// The others: number, first tile (row-major, and for those that show their back as many tiles
    /// more as there are), further tiles (columns + (rows << 16)).
    std::vector<std::uint32_t> triangle, tile, more;
    std::size_t count = 0;
};

/// A sample that a triangle covers, with its stored depth there.
struct Point {
    std::uint32_t place;  ///< tile << 12 | sample in the tile, cell by cell (Tile)
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

/// Depth and ids of a tile, in cells of 4 x 4 samples: a small triangle meets fewer cells than
/// rows. There is a column and a row of cells more than the tile has, so that two by two cells may
/// be drawn to from any.
struct Tile {
    static constexpr std::int32_t kCellBits = 2, kCellSide = 1 << kCellBits;
    static constexpr std::size_t kCell = std::size_t{kCellSide} * kCellSide;  ///< samples
    static constexpr std::uint32_t kLastCell = (kTileSize >> kCellBits) - 1;  ///< of a row
    static constexpr std::size_t kAcross = kLastCell + 2;                     ///< cells a row
    static constexpr std::size_t kCellRow = kAcross * kCell;  ///< samples in a row of cells
    static constexpr std::uint32_t kBlockBits = 3;            ///< a block is 8 x 8 samples
    static constexpr std::uint32_t kBlocks = kTileSize >> kBlockBits;

    alignas(64) float depth[kAcross * kCellRow];
    alignas(64) std::uint32_t ids[kAcross * kCellRow];
    /// Hierarchical depth: no stored depth of the block is greater.
    alignas(64) float block_max[kBlocks * kBlocks];
    float tile_max = 0;
    bool knows_depth = false;  ///< block_max holds more than infinities
    std::uint32_t drawn = 0;   ///< triangles since block_max was brought up to date

    std::int32_t column = 0, row = 0;  ///< of its first sample in the grid
    std::int32_t width = 0, height = 0;

    [[nodiscard]] Area area() const { return {column, row, width, height}; }
    /// Of a sample: its cell (row, column), then the sample in it (row, column).
    [[nodiscard]] static std::size_t index(std::int32_t column, std::int32_t row) {
        constexpr std::uint32_t kIn = kCellSide - 1;
        const auto c = static_cast<std::uint32_t>(column), r = static_cast<std::uint32_t>(row);
        return (r >> kCellBits) * kCellRow + (c >> kCellBits) * kCell + (r & kIn) * kCellSide +
               (c & kIn);
    }
    /// Of a point.
    [[nodiscard]] static std::size_t index(const Point& point) {
        const std::uint32_t sample = point.place & (kTileSize * kTileSize - 1);
        constexpr std::uint32_t kRowBits =
            kTileBits + kCellBits;  // of the samples in a row of cells
        return sample + (sample >> kRowBits) * (kCellRow - (std::size_t{1} << kRowBits));
    }
    [[nodiscard]] static std::int32_t column_of(const Point& point) {
        const std::uint32_t cell = point.place >> (2 * kCellBits) & kLastCell;
        return static_cast<std::int32_t>(cell << kCellBits | (point.place & (kCellSide - 1)));
    }
    [[nodiscard]] static std::int32_t row_of(const Point& point) {
        const std::uint32_t cell = point.place >> (kTileBits + kCellBits) & kLastCell;
        return static_cast<std::int32_t>(cell << kCellBits |
                                         (point.place >> kCellBits & (kCellSide - 1)));
    }
};

/// Half-rows (the ids of a row, then its depths) of a tile that are still to be written.
struct PendingRows {
    const Tile* tile = nullptr;  ///< null: nothing fell into it
    std::size_t at = 0;          ///< where its first row begins in the picture
    std::size_t width = 0;
    std::int32_t next = 0, end = 0;  ///< half-rows

    PendingRows() = default;
    PendingRows(const Tile* samples, const Area& area, std::int32_t columns)
        : tile(samples),
          at(static_cast<std::size_t>(area.row) * static_cast<std::size_t>(columns) +
             static_cast<std::size_t>(area.column)),
          width(static_cast<std::size_t>(area.width)),
          end(2 * area.height) {}
};

/// The tiles that nothing fell into, for whoever has time to write them.
struct EmptyTiles {
    std::vector<Area> areas;
    std::atomic<std::size_t> next{0};
};

/// What a thread has to write to the picture. Its caches are passed by, and memory is slower than a
/// core: so a little is written at a time, between triangles.
struct TileWriter {
    std::uint32_t* ids;
    float* depth;
    std::int32_t columns;  ///< of the picture
    EmptyTiles& empty;
    PendingRows drawn, cleared;

    /// Half-rows to write now, or null when there are none left.
    [[nodiscard]] PendingRows* pending() {
        if (drawn.next != drawn.end) return &drawn;
        if (cleared.next == cleared.end) {
            if (empty.next.load(std::memory_order_relaxed) >= empty.areas.size()) return nullptr;
            const std::size_t k = empty.next.fetch_add(1, std::memory_order_relaxed);
            if (k >= empty.areas.size()) return nullptr;
            cleared = PendingRows(nullptr, empty.areas[k], columns);
        }
        return &cleared;
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

/// Draws triangles, by number, into a tile: many small ones at a time, the rest one by one. Rows of
/// other tiles are written meanwhile.
void draw_triangles(const RasterInput& input, std::span<const std::uint32_t> triangles, Tile& tile,
                    TileCounts& counts, TileWriter& writer);

/// Draws one triangle of any size and steepness; tells the observer of each step.
void draw_large(const RasterInput& input, std::uint32_t triangle, Tile& tile, TileCounts& counts);

/// Writes what is left of the drawn tile.
void write_drawn_tile(TileWriter& writer);

/// Writes all that is left to write.
void write_rest(TileWriter& writer);

}  // namespace sightline::zbuffer
