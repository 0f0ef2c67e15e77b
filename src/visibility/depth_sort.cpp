// Depth sort: the polygons are put into an order, splitting what no order can serve, and painted
// from back to front.
//
// Source: M. Newell, R. Newell, T. Sancha, "A Solution to the Hidden Surface Problem", 1972; the
// order is made in depth_order.cpp. How this version differs: painting keeps the owner of a sample
// where both are exactly equally deep and the owner's id is lower, as two faces are along a fold;
// and a piece is painted as the part of its triangle between planes, decided by the ordinary
// comparison of depths at each sample. So the answer is the canonical one in every sample.
#include <memory>
#include <utility>

#include "math/page_line.hpp"
#include "visibility/algorithms.hpp"
#include "visibility/depth_order.hpp"
#include "visibility/painting.hpp"
#include "visibility/piece_order.hpp"
#include "visibility/plane_cuts.hpp"

namespace sightline {

std::unique_ptr<LayerSource> open_depth_sort_layers(const ScreenScene& screen,
                                                    const SampleGrid& grid,
                                                    const ResolveOptions& options) {
    SortedPieces sorted = sort_by_depth(screen, &grid, options);
    const SampleUnits units(grid, screen.subpixel_bits());
    return std::make_unique<PieceLayers<PlaneCuts>>(
        screen, grid, options, std::move(sorted.pieces),
        PlaneCuts(screen, units, std::move(sorted.cuts)));
}

std::unique_ptr<RowSource> open_depth_sort(const ScreenScene& screen, const SampleGrid& grid,
                                           const ResolveOptions& options) {
    return open_painted_rows(screen, grid, options, open_depth_sort_layers(screen, grid, options),
                             Ties::lower_id_wins);
}

PieceOrder order_by_depth_sort(const ScreenScene& screen, const ResolveOptions& options) {
    SortedPieces sorted = sort_by_depth(screen, nullptr, options);
    PieceOrder order;
    order.lines.resize(sorted.cuts.size());
    for (const Piece& piece : sorted.pieces) {
        const Plane own = screen.plane(screen.id(piece.triangle));
        for (std::uint32_t k = piece.first_cut; k < piece.end_cut; ++k) {
            const PageLine deeper = line_where_deeper(own, screen.plane(sorted.cuts[k].triangle));
            const glm::dvec3 line(deeper.dl, deeper.dm, deeper.dn);
            order.lines[k] = sorted.cuts[k].behind ? line : -line;
        }
    }
    order.pieces = std::move(sorted.pieces);
    return order;
}

}  // namespace sightline
