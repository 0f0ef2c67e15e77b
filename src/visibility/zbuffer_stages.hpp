// The SIMD stages of the z-buffer, and what they share with its driver.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
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

/// Marks the numbers of triangles that belong to a sheet, for few do, and others need not be asked.
inline constexpr std::uint32_t kInSheet = 1u << 31;

/// A triangle in a bin. With its corners, for whoever takes it out would have to look for them.
struct TriangleItem {
    Corners corners;
    std::uint32_t marked;  ///< its number, and perhaps kInSheet

    [[nodiscard]] std::uint32_t number() const { return marked & ~kInSheet; }
};
static_assert(sizeof(TriangleItem) == 4 * sizeof(std::uint32_t));

/// Triangles that may cover samples and are not tiny, once for each tile that their boxes meet.
struct Selected {
    std::vector<std::uint32_t> marked;  ///< number, and perhaps kInSheet
    /// Row-major; for triangles that show their back, as many more as there are tiles.
    std::vector<std::uint32_t> tile;
    std::size_t count = 0;

    void append(std::uint32_t m, std::uint32_t t) {
        make_room(1);
        marked[count] = m;
        tile[count++] = t;
    }
    void make_room(std::size_t further) {
        if (count + further <= marked.size()) return;
        const std::size_t room = std::max<std::size_t>(2 * marked.size(), count + further);
        marked.resize(room);
        tile.resize(room);
    }
};

/// Samples of one tile that tiny triangles cover: where (Tile::index()), their stored depths there,
/// and whose they are.
struct alignas(64) PointBlock {
    static constexpr std::size_t kRoom = 128;
    std::uint32_t place[kRoom];
    float z[kRoom];
    std::uint32_t id[kRoom];
    std::size_t count;
    PointBlock* before;
};

/// Points by tile, in chains of blocks. What one worker makes of tiny triangles; the blocks are
/// kept from frame to frame, for fresh memory is slow.
class PointBins {
public:
    /// Forgets all points.
    void start(std::size_t tiles) {
        last_.assign(tiles, nullptr);
        used_ = 0;
    }
    /// A block of the tile that has room for a vector of points.
    [[nodiscard]] PointBlock& block_of(std::size_t tile) {
        PointBlock* block = last_[tile];
        if (block != nullptr && block->count + kVector <= PointBlock::kRoom) return *block;
        return grow(tile);
    }
    [[nodiscard]] bool any_in(std::size_t tile) const { return last_[tile] != nullptr; }
    /// visit(block) for all blocks of a tile.
    template <class Visit>
    void for_each_block(std::size_t tile, const Visit& visit) const {
        for (const PointBlock* b = last_[tile]; b != nullptr; b = b->before) {
            if (b->before != nullptr) prefetch(*b->before);
            visit(*b);
        }
    }

private:
    static constexpr std::size_t kVector = 16, kSlab = 64;

    PointBlock& grow(std::size_t tile);
    static void prefetch(const PointBlock& block);

    std::vector<PointBlock*> last_;  // by tile
    std::vector<std::unique_ptr<PointBlock[]>> slabs_;
    std::size_t used_ = 0;  // blocks
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
    /// The column and the row of an index.
    [[nodiscard]] static std::int32_t column_of(std::size_t index) {
        return static_cast<std::int32_t>(index % kCellRow / kCell * kCellSide + index % kCellSide);
    }
    [[nodiscard]] static std::int32_t row_of(std::size_t index) {
        return static_cast<std::int32_t>(index / kCellRow * kCellSide + index % kCell / kCellSide);
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

/// Geometry stage: drops what is skipped or whose box holds no sample, draws the tiny triangles to
/// points and selects the others, many triangles at a time.
void take_triangles(const RasterInput& input, const TriangleRange& range, Selected& selected,
                    PointBins& points);

/// Clears a tile.
void clear_tile(Tile& tile);

/// Offers points to a tile.
void draw_points(const RasterInput& input, const PointBlock& points, Tile& tile,
                 TileCounts& counts);

/// Triangles of a tile, from several chunks.
struct TileBins {
    std::vector<std::span<const TriangleItem>> front, back;  ///< by the side that they show
};

/// Draws triangles into a tile: many small ones at a time, the rest one by one. Rows of other tiles
/// are written meanwhile.
void draw_triangles(const RasterInput& input, const TileBins& bins, Tile& tile, TileCounts& counts,
                    TileWriter& writer);

/// Draws one triangle of any size and steepness; tells the observer of each step.
void draw_large(const RasterInput& input, std::uint32_t triangle, Tile& tile, TileCounts& counts);

/// Writes what is left of the drawn tile.
void write_drawn_tile(TileWriter& writer);

/// Writes all that is left to write.
void write_rest(TileWriter& writer);

}  // namespace sightline::zbuffer
