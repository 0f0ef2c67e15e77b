// The order of a BSP tree for those who draw with means of their own.
#include <utility>

#include "visibility/algorithms.hpp"
#include "visibility/bsp.hpp"
#include "visibility/bsp_build.hpp"
#include "visibility/piece_order.hpp"

namespace sightline {

PieceOrder order_by_bsp(const ScreenScene& screen, const ResolveOptions& options) {
    const int threads = options.observer != nullptr ? 1 : options.threads;
    const BspTree tree = bsp::tree_for(screen, options);
    bsp::OrderedPieces ordered =
        bsp::order_pieces(screen, tree, bsp::Order::back_to_front, threads, options.observer);
    PieceOrder order;
    order.lines.reserve(ordered.cuts.size());
    for (const bsp::PageCut& cut : ordered.cuts) order.lines.push_back(cut.line);
    order.pieces = std::move(ordered.pieces);
    return order;
}

}  // namespace sightline
