// PLY, ascii and binary of both byte orders (Greg Turk, "The PLY Polygon File Format", 1994).
#pragma once

#include <string_view>

#include "scene/load/reader.hpp"

namespace sightline::load {

/// Reads the elements `vertex` (x y z, nx ny nz, red green blue alpha), `face` (vertex_indices or
/// vertex_index) and `tristrips` (vertex_indices; -1 begins a new strip), in any order and with any
/// other properties and elements between them, which are skipped.
[[nodiscard]] Result<Soup> read_ply(std::string_view bytes, const ReadContext& context);

}  // namespace sightline::load
