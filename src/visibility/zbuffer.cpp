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
// Two stages, both on all cores. Geometry: chunks of consecutive triangles are taken a vector at a
// time; what covers no sample is dropped; triangles of at most 3 x 3 samples are drawn to points at
// once; the rest goes into the bins of its tiles, those that show their back apart. Raster: each
// tile is owned by one worker, which takes its points and triangles, near chunks and front sides
// first, into depth and ids that stay in the core's cache; while it draws, it writes the tile
// before, and tiles that nothing fell into, past the caches. Under an observer triangles are drawn
// one by one.
//
// Time O(triangles + triangle-tile pairs + covered samples), memory O(pairs) beside the picture.
#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "visibility/algorithms.hpp"
#include "visibility/parallel.hpp"
#include "visibility/zbuffer_stages.hpp"
#include "visibility/zbuffer_workspace.hpp"

namespace sightline {

namespace {

using namespace zbuffer;

constexpr float kNotShared = std::numeric_limits<float>::quiet_NaN();

class ZBuffer {
public:
    ZBuffer(const ScreenScene& screen, const ResolveOptions& options, Visibility& out)
        : screen_(screen),
          options_(options),
          out_(out),
          grid_(out.grid, screen.subpixel_bits()),
          counts_(grid_.tile_count()),
          alone_(works_alone(options)),
          workers_(alone_ ? 1 : worker_count(options)) {}

    void run() {
        make_chunks();
        order_chunks();
        Workspace& space = *space_;
        if (space.chunks.size() < chunks_.size()) space.chunks.resize(chunks_.size());
        if (space.workers.size() < workers_) space.workers.resize(workers_);
        const auto stages = [&] {
            make_shared_gradients();
            Shares chunks(chunks_.size(), workers_);
            each_index(workers_, alone_, [&](std::uint32_t w) { take_chunks(w, chunks); });
            find_drawn_tiles();
            Shares tiles(drawn_.size(), workers_);
            each_index(workers_, alone_, [&](std::uint32_t w) { draw_tiles(w, tiles); });
        };
        if (alone_)
            stages();
        else
            in_arena(options_.threads, stages);
        report();
    }

private:
    // Few enough to keep the bins' tables small, many enough to share among cores.
    void make_chunks() {
        const std::span<const Corners> triangles(screen_.scene().triangles);
        const std::size_t size = std::clamp<std::size_t>(triangles.size() / 64, 4096, 16384);
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
        each_index((sheets + kGrain - 1) / kGrain, alone_, [&](std::uint32_t chunk) {
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

    [[nodiscard]] Worker& worker(std::uint32_t w) { return (*space_).workers[w]; }

    // One worker's share of the geometry stage.
    void take_chunks(std::uint32_t w, Shares& chunks) {
        Worker& mine = worker(w);
        const std::size_t tiles = grid_.tile_count();
        mine.points.start(tiles);
        mine.hit.assign(tiles, 0);
        chunks.take(w, [&](std::size_t c) {
            TriangleBins& bins = (*space_).chunks[c];
            take_triangles(input(), chunks_[c], mine.selected, mine.points);
            bins.sort(mine.selected, chunks_[c], 2 * tiles);
            bins.mark(mine.hit);
        });
    }

    [[nodiscard]] bool is_hit(std::uint32_t tile) const {
        const std::span<const Worker> workers((*space_).workers.data(), workers_);
        return std::any_of(workers.begin(), workers.end(), [tile](const Worker& w) {
            return w.hit[tile] != 0 || w.points.any_in(tile);
        });
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
    void find_drawn_tiles() {
        const auto tiles = static_cast<std::uint32_t>(grid_.tile_count());
        for (std::uint32_t t = 0; t < tiles; ++t)
            if (options_.observer != nullptr || is_hit(t))
                drawn_.push_back(t);
            else
                empty_.areas.push_back(area_of(t));
    }

    // One worker's share of the raster stage. While a tile is drawn, the one before it is written.
    void draw_tiles(std::uint32_t w, Shares& tiles) {
        Worker& mine = worker(w);
        TileWriter writer{out_.ids.data(), out_.depth.data(), grid_.columns, empty_, {}, {}};
        bool odd = false;
        tiles.take(w, [&](std::size_t k) {
            Tile& tile = mine.tiles[odd ? 1 : 0];
            odd = !odd;
            draw_tile(drawn_[k], tile, mine, writer);
            write_drawn_tile(writer);
            writer.drawn = PendingRows(&tile, tile.area(), grid_.columns);
        });
        write_rest(writer);
    }

    void draw_tile(std::uint32_t index, Tile& tile, Worker& worker, TileWriter& writer) {
        const Area area = area_of(index);
        tell_entered(area);
        place_tile(area, tile);
        clear_tile(tile);
        TileCounts counts;  // here, for neighbours in counts_ share a cache line among threads
        const RasterInput raster = input();
        for (std::uint32_t w = 0; w < workers_; ++w)
            (*space_).workers[w].points.for_each_block(index, [&](const PointBlock& points) {
                draw_points(raster, points, tile, counts);
            });
        collect_bins(index, worker.bins.front);
        collect_bins(index + grid_.tile_count(), worker.bins.back);
        draw_triangles(raster, worker.bins, tile, counts, writer);
        counts_[index] = counts;
    }

    void collect_bins(std::size_t part, std::vector<std::span<const TriangleItem>>& bins) const {
        bins.clear();
        for (const std::uint32_t c : front_to_back_) {
            const std::span<const TriangleItem> bin = (*space_).chunks[c].of(part);
            if (!bin.empty()) bins.push_back(bin);
        }
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
    std::vector<TileCounts> counts_;
    bool alone_;
    std::uint32_t workers_;
    LentWorkspace space_;
    std::vector<std::uint32_t> drawn_;  ///< tiles that something fell into
    EmptyTiles empty_;
};

}  // namespace

void resolve_zbuffer(const ScreenScene& screen, const ResolveOptions& options, Visibility& out) {
    ZBuffer(screen, options, out).run();
}

}  // namespace sightline
