// Which algorithms run without being named: `compare` and `bench --table` ask the same.
#pragma once

#include "sightline/visibility.hpp"

namespace sightline::cli {

/// False for an exhaustive algorithm on more than 2^38 samples times triangles (some ten seconds on
/// two cores): it runs there only when it is named.
[[nodiscard]] bool is_affordable(const Algorithm& algorithm, const ScreenScene& screen);

}  // namespace sightline::cli
