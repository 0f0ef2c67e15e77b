// The order of depth sort: polygons, or pieces of them, from back to front.
#pragma once

#include <cstdint>
#include <vector>

#include "sightline/visibility.hpp"
#include "visibility/painting.hpp"

namespace sightline {

/// A plane that bounds a piece, which lies behind it or in front of it. At a tie it is in front
/// when its id is the lower one.
struct PlaneCut {
    std::uint32_t triangle = kNone;  ///< of the scene: whose plane it is
    bool behind = false;
};

struct SortedPieces {
    std::vector<Piece> pieces;  ///< back to front
    std::vector<PlaneCut> cuts;
};

/// Puts all screen triangles into an order in which each may be painted over those before it,
/// splitting those that no order can serve. With `grid`, only what covers samples of it.
[[nodiscard]] SortedPieces sort_by_depth(const ScreenScene& screen, const SampleGrid* grid,
                                         const ResolveOptions& options);

}  // namespace sightline
