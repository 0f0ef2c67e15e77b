// Open edges behind which their own surface goes on: those of coplanar faces that do not share
// their vertices (T-junctions).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "drawing/edges.hpp"

namespace sightline {

/// Cuts the edges with these indices (ascending), each of one face in a sheet, into stretches:
/// EdgeKind::mesh where another face of the same sheet and object lies on the other side, else as
/// they were. Ends are vertices where a face has one there. An edge that lies within 2^-20 of the
/// scene's radius of a face's side lies on it, and shorter stretches go to the one before. The
/// order of the edges stays, with the stretches of an edge in its place. O((n + m) log n) for n
/// edges and the m faces of their sheets, on all cores.
void cut_covered_edges(const Scene& scene, std::span<const std::uint32_t> open, SceneEdges& edges);

}  // namespace sightline
