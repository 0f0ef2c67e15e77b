// The painter's algorithm: the polygons in the order of their farthest points, the farthest first,
// each painted over what is there.
//
// Source: M. Newell, R. Newell, T. Sancha, "A Solution to the Hidden Surface Problem", 1972, its
// first step alone. It is wrong wherever a polygon's farthest point does not tell its place: long
// polygons beside short ones, polygons that cross, cycles. It is kept for what it teaches, and
// `compare` measures how wrong it is.
//
// How this version differs: of equally far polygons the one with the higher id is painted first, as
// is right for coplanar faces, and bands of rows are painted in parallel.
//
// Time O(n log n) for the order, O(rows and samples of all triangles) for painting; memory O(n).
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <memory>
#include <tuple>
#include <vector>

#include "visibility/algorithms.hpp"
#include "visibility/painting.hpp"
#include "visibility/piece_order.hpp"

namespace sightline {

namespace {

struct Entry {
    std::int32_t farthest;
    std::uint32_t id, triangle;
};

// With `units`, only what can cover samples.
std::vector<Piece> sort_by_farthest(const ScreenScene& screen, const SampleUnits* units,
                                    const ResolveOptions& options) {
    std::vector<Entry> entries;
    for (std::uint32_t k = 0; k < screen.triangle_count(); ++k) {
        if (!screen.drawable(k)) continue;
        if (units != nullptr && sample_box(screen, *units, k).empty()) continue;
        const Corners c = screen.corners(k);
        const std::int32_t farthest =
            std::max({screen.point(c.x).z, screen.point(c.y).z, screen.point(c.z).z});
        entries.push_back({farthest, screen.id(k), k});
    }
    in_arena(options.threads, [&] {
        tbb::parallel_sort(entries, [](const Entry& a, const Entry& b) {
            return std::tie(a.farthest, a.id, a.triangle) > std::tie(b.farthest, b.id, b.triangle);
        });
    });
    std::vector<Piece> pieces;
    pieces.reserve(entries.size());
    for (const Entry& entry : entries) {
        pieces.push_back({entry.triangle});
        if (options.observer != nullptr)
            options.observer->step({StepKind::polygon_painted, entry.id});
    }
    count(options, "polygons sorted", pieces.size());
    return pieces;
}

}  // namespace

std::unique_ptr<RowSource> open_painter(const ScreenScene& screen, const SampleGrid& grid,
                                        const ResolveOptions& options) {
    const SampleUnits units(grid, screen.subpixel_bits());
    return open_painted_rows(
        screen, grid, options,
        std::make_unique<PieceLayers<NoCuts>>(screen, grid, options,
                                              sort_by_farthest(screen, &units, options), NoCuts{}),
        Ties::last_wins);
}

PieceOrder order_by_painter(const ScreenScene& screen, const ResolveOptions& options) {
    return {sort_by_farthest(screen, nullptr, options), {}};
}

}  // namespace sightline
