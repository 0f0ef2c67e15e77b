// The z-buffer: keeps the nearest depth of every sample, in any order of the triangles.
//
// Source: E. Catmull, "Computer Display of Curved Surfaces", 1975; W. Strasser's thesis of 1974 has
// it too. Tiled and binned like L. Seiler et al., "Larrabee: A Many-Core x86 Architecture for
// Visual Computing", SIGGRAPH 2008.
//
// How this version differs: it gives the canonical answer in every sample. Depths are compared in
// single precision with a derived bound; what lies within it is compared in integers, and exact
// ties go to the lower id. A minimum is associative, so tiles, threads and orders can't change a
// bit.
//
// Two stages, both on all cores. Geometry: chunks of consecutive triangles are gathered a vector at
// a time; what covers no sample is dropped; triangles of at most 3 x 3 samples are drawn to points
// at once; the rest goes, by number, into the bins of its tiles, those that show their back apart.
// Raster: each tile is owned by one worker, which takes its points and triangles, near chunks and
// front sides first, into depth and ids that stay in the core's cache; while it draws, it writes
// the tile before, and tiles that nothing fell into, past the caches. Under an observer triangles
// are drawn one by one.
//
// Time O(triangles + triangle-tile pairs + covered samples), memory O(pairs) beside the picture.
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <memory>
#include <numeric>
#include <vector>

#include "visibility/algorithms.hpp"
#include "visibility/bins.hpp"
#include "visibility/parallel.hpp"
#include "visibility/zbuffer_stages.hpp"

namespace sightline {

namespace {

using namespace zbuffer;

constexpr float kNotShared = std::numeric_limits<float>::quiet_NaN();

// Parts 0 .. tiles - 1 are the tiles' front sides, the rest their back sides.
void sort_triangles(const Selected& selected, const GridUnits& grid, Bins<std::uint32_t>& bins) {
    bins.sort(2 * grid.tile_count(), [&](const auto& visit) {
        for (std::size_t i = 0; i < selected.count; ++i) {
            if (selected.more[i] == 0) {  // most lie in one tile
                visit(selected.tile[i], selected.triangle[i]);
                continue;
            }
            const std::uint32_t columns = selected.more[i] & 0xFFFFu, rows = selected.more[i] >> 16;
            for (std::uint32_t r = 0; r <= rows; ++r)
                for (std::uint32_t c = 0; c <= columns; ++c)
                    visit(selected.tile[i] + r * static_cast<std::uint32_t>(grid.tiles_x) + c,
                          selected.triangle[i]);
        }
    });
}

void sort_points(const Points& points, const GridUnits& grid, Bins<Point>& bins) {
    bins.sort(grid.tile_count(), [&](const auto& visit) {
        for (std::size_t i = 0; i < points.count; ++i)
            visit(points.place[i] >> (2 * kTileBits), {points.place[i], points.z[i], points.id[i]});
    });
}

class ZBuffer {
public:
    ZBuffer(const ScreenScene& screen, const ResolveOptions& options, Visibility& out)
        : screen_(screen),
          options_(options),
          out_(out),
          grid_(out.grid, screen.subpixel_bits()),
          counts_(grid_.tile_count()),
          is_hit_(grid_.tile_count()) {}

    void run() {
        make_chunks();
        order_chunks();
        make_shared_gradients();
        triangle_bins_.resize(chunks_.size());
        point_bins_.resize(chunks_.size());
        for_each_index(static_cast<std::uint32_t>(chunks_.size()), options_,
                       [&](std::uint32_t c) { take_chunk(c); });
        share_tiles();
        const int workers =
            options_.threads > 0 ? options_.threads : tbb::this_task_arena::max_concurrency();
        for_each_index(static_cast<std::uint32_t>(workers), options_,
                       [&](std::uint32_t) { draw_tiles(); });
        report();
    }

private:
    // Few enough to keep the bins' tables small, many enough to share among cores.
    void make_chunks() {
        const std::span<const Corners> triangles(screen_.scene().triangles);
        const std::size_t size = std::clamp<std::size_t>(triangles.size() / 64, 2048, 16384);
        const auto add = [&](std::span<const Corners> corners, std::span<const std::uint8_t> skip,
                             std::uint32_t first) {
            for (std::size_t begin = 0; begin < corners.size(); begin += size) {
                const std::size_t n = std::min(size, corners.size() - begin);
                chunks_.push_back({corners.subspan(begin, n),
                                   skip.empty() ? skip : skip.subspan(begin, n),
                                   first + static_cast<std::uint32_t>(begin)});
            }
        };
        add(triangles, screen_.skip(), 0);
        add(screen_.pieces(), {}, screen_.scene().triangle_count());
    }

    // Chunks whose triangles lie near come first, so that hierarchical depth dismisses the others.
    // A few corners tell well enough; the answer does not depend on the order.
    void order_chunks() {
        constexpr std::size_t kProbes = 16;
        std::vector<std::int64_t> depth(chunks_.size(), 0);
        for (std::size_t c = 0; c < chunks_.size(); ++c) {
            const std::span<const Corners> corners = chunks_[c].corners;
            for (std::size_t k = 0; k < kProbes; ++k)
                depth[c] += screen_.point(corners[k * corners.size() / kProbes].x).z;
        }
        front_to_back_.resize(chunks_.size());
        std::iota(front_to_back_.begin(), front_to_back_.end(), 0u);
        std::stable_sort(front_to_back_.begin(), front_to_back_.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return depth[a] < depth[b]; });
    }

    // Depth of shared planes, by sheet: float arithmetic that the raster stage can gather.
    void make_shared_gradients() {
        const auto sheets = static_cast<std::uint32_t>(screen_.scene().sheets.count());
        shared_.resize(sheets);
        constexpr std::uint32_t kGrain = 1024;
        for_each_index((sheets + kGrain - 1) / kGrain, options_, [&](std::uint32_t chunk) {
            const std::uint32_t end = std::min(sheets, (chunk + 1) * kGrain);
            for (std::uint32_t s = chunk * kGrain; s < end; ++s) {
                const Plane& plane = screen_.sheet_plane(s);
                const DepthGradient g =
                    plane.c == 0 ? DepthGradient{kNotShared, 0, 0} : depth_gradient(plane);
                shared_[s] = {g.gx, g.gy, g.z0, plane.at.x, plane.at.y};
            }
        });
    }

    [[nodiscard]] RasterInput input() const { return {screen_, grid_, shared_, options_.observer}; }

    void take_chunk(std::uint32_t c) {
        thread_local Selected selected;
        thread_local Points points;
        select_triangles(screen_, grid_, chunks_[c], selected);
        draw_tiny(input(), selected, points);
        sort_triangles(selected, grid_, triangle_bins_[c]);
        sort_points(points, grid_, point_bins_[c]);
        mark_hit_tiles(triangle_bins_[c], point_bins_[c]);
    }

    void mark_hit_tiles(const Bins<std::uint32_t>& triangles, const Bins<Point>& points) {
        const auto tiles = static_cast<std::uint32_t>(grid_.tile_count());
        for (std::uint32_t t = 0; t < tiles; ++t)
            if (!triangles.of(t).empty() || !triangles.of(t + tiles).empty() ||
                !points.of(t).empty())
                is_hit_[t].store(true, std::memory_order_relaxed);
    }

    [[nodiscard]] Area area_of(std::uint32_t index) const {
        constexpr auto kSize = static_cast<std::int32_t>(kTileSize);
        Area area;
        area.column = static_cast<std::int32_t>(index) % grid_.tiles_x * kSize;
        area.row = static_cast<std::int32_t>(index) / grid_.tiles_x * kSize;
        area.width = std::min(kSize, grid_.columns - area.column);
        area.height = std::min(kSize, grid_.rows - area.row);
        return area;
    }

    void place_tile(const Area& area, Tile& tile) const {
        tile.column = area.column;
        tile.row = area.row;
        tile.width = area.width;
        tile.height = area.height;
    }

    void tell_entered(const Area& area) const {
        if (options_.observer != nullptr)
            options_.observer->step({StepKind::tile_entered, kNone, kNone,
                                     static_cast<std::uint32_t>(area.column),
                                     static_cast<std::uint32_t>(area.row),
                                     static_cast<std::uint32_t>(area.column + area.width),
                                     static_cast<std::uint32_t>(area.row + area.height)});
    }

    // Tiles that something fell into are drawn; the others can be written at any time. A watcher
    // sees them all, in order.
    void share_tiles() {
        const auto tiles = static_cast<std::uint32_t>(grid_.tile_count());
        for (std::uint32_t t = 0; t < tiles; ++t)
            if (options_.observer != nullptr || is_hit_[t].load(std::memory_order_relaxed))
                drawn_.push_back(t);
            else
                empty_.areas.push_back(area_of(t));
    }

    // One worker's share of the raster stage. While a tile is drawn, the one before it is written.
    void draw_tiles() {
        thread_local const auto tiles = std::make_unique<Tile[]>(2);
        TileWriter writer{out_.ids.data(), out_.depth.data(), grid_.columns, empty_, {}, {}};
        bool odd = false;
        for (;;) {
            const std::size_t k = next_.fetch_add(1, std::memory_order_relaxed);
            if (k >= drawn_.size()) break;
            Tile& tile = tiles[odd ? 1 : 0];
            odd = !odd;
            draw_tile(drawn_[k], tile, writer);
            write_drawn_tile(writer);
            writer.drawn = PendingRows(&tile, tile.area(), grid_.columns);
        }
        write_rest(writer);
    }

    void draw_tile(std::uint32_t index, Tile& tile, TileWriter& writer) {
        const Area area = area_of(index);
        tell_entered(area);
        place_tile(area, tile);
        clear_tile(tile);
        TileCounts counts;  // here, for neighbours in counts_ share a cache line among threads
        const RasterInput raster = input();
        // One list, so that vectors are full across the chunks.
        thread_local std::vector<std::uint32_t> triangles;
        triangles.clear();
        const auto append = [&](std::uint32_t chunk, std::uint32_t part) {
            const std::span<const std::uint32_t> bin = triangle_bins_[chunk].of(part);
            triangles.insert(triangles.end(), bin.begin(), bin.end());
        };
        for (const std::uint32_t c : front_to_back_) {
            draw_points(raster, point_bins_[c].of(index), tile, counts);
            append(c, index);
        }
        for (const std::uint32_t c : front_to_back_)
            append(c, index + static_cast<std::uint32_t>(grid_.tile_count()));
        draw_triangles(raster, triangles, tile, counts, writer);
        counts_[index] = counts;
    }

    void report() {
        TileCounts sum;
        for (const TileCounts& c : counts_) {
            sum.points += c.points;
            sum.triangles += c.triangles;
            sum.hidden += c.hidden;
            sum.exact += c.exact;
        }
        count(options_, "tiles", counts_.size());
        count(options_, "samples of tiny triangles", sum.points);
        count(options_, "triangles set up in tiles", sum.triangles);
        count(options_, "triangles found hidden by blocks", sum.hidden);
        count(options_, "exact comparisons", sum.exact);
    }

    const ScreenScene& screen_;
    const ResolveOptions& options_;
    Visibility& out_;
    GridUnits grid_;
    std::vector<TriangleRange> chunks_;
    std::vector<std::uint32_t> front_to_back_;
    std::vector<SharedGradient> shared_;
    std::vector<Bins<std::uint32_t>> triangle_bins_;
    std::vector<Bins<Point>> point_bins_;
    std::vector<TileCounts> counts_;
    std::vector<std::atomic<bool>> is_hit_;  ///< tiles that something fell into
    std::vector<std::uint32_t> drawn_;
    std::atomic<std::size_t> next_{0};
    EmptyTiles empty_;
};

}  // namespace

void resolve_zbuffer(const ScreenScene& screen, const ResolveOptions& options, Visibility& out) {
    ZBuffer(screen, options, out).run();
}

}  // namespace sightline
