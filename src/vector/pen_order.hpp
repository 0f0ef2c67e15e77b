// The order in which a plotter draws paths.
#pragma once

#include "sightline/vector.hpp"

namespace sightline {

/// The same paths, those of one visibility and kind in an order (and turned) in which the pen flies
/// short ways: each begins at the end that is nearest to where the last one ended, the first at
/// that nearest to the page's origin. O(n log n) in practice. Precondition: ordered by visibility
/// and kind.
[[nodiscard]] Paths in_pen_order(const Paths& paths);

}  // namespace sightline
