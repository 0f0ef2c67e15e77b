// The order of polygons that are entangled beyond what splitting one pair at a time can serve.
#pragma once

#include <cstdint>
#include <vector>

#include "visibility/sort_pieces.hpp"

namespace sightline {

/// Paints the given pieces, all of them waiting, in a right order among themselves. O(m log m) for
/// m resulting pieces where the planes divide well.
void paint_by_partition(SortPieces& pieces, std::vector<std::uint32_t> waiting);

}  // namespace sightline
