// Points of tiny triangles: kept by tile, and taken by the tile that they fell into.
#include <hwy/cache_control.h>

#include "visibility/zbuffer_stages.hpp"

namespace sightline::zbuffer {

PointBlock& PointBins::grow(std::size_t tile) {
    const std::size_t slab = used_ / kSlab, at = used_ % kSlab;
    if (slab == slabs_.size())
        slabs_.push_back(std::make_unique_for_overwrite<PointBlock[]>(kSlab));
    PointBlock& block = slabs_[slab][at];
    ++used_;
    block.count = 0;
    block.before = last_[tile];
    last_[tile] = &block;
    return block;
}

void PointBins::prefetch(const PointBlock& block) {
    const auto* bytes = reinterpret_cast<const char*>(&block);
    for (std::size_t i = 0; i < sizeof(PointBlock); i += 64) hwy::Prefetch(bytes + i);
}

void draw_points(const RasterInput& input, const PointBlock& points, Tile& tile,
                 TileCounts& counts) {
    for (std::size_t i = 0; i < points.count; ++i) {
        const std::size_t at = points.place[i];
        const float z = points.z[i], old = tile.depth[at];
        const bool nearer = z < old - kUncertain;
        if (nearer != (z <= old + kUncertain)) {  // too close to call
            if (!comes_before(input, points.id[i], tile.ids[at],
                              input.grid.position(tile.column + Tile::column_of(at)),
                              input.grid.position(tile.row + Tile::row_of(at)), counts))
                continue;
            tile.depth[at] = z;
            tile.ids[at] = points.id[i];
            continue;
        }
        // Without a branch: whether a point is hidden is anybody's guess.
        tile.depth[at] = nearer ? z : old;
        tile.ids[at] = nearer ? points.id[i] : tile.ids[at];
    }
    counts.points += points.count;
    tile.drawn += static_cast<std::uint32_t>(points.count);
}

}  // namespace sightline::zbuffer
