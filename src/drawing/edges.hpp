// The edges of a scene that a drawing shows, and why.
//
// Faces share an edge when it has the same two positions in both, in whatever object; any number of
// faces may share one. Equal faces are one. Degenerate triangles have no part in it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/drawing.hpp"

namespace sightline {

struct SceneEdge {
    /// Positions of its ends, or, from their number on, SceneEdges::cuts. Of a whole edge a < b
    /// after joining.
    std::uint32_t a = 0, b = 0;
    std::uint32_t first_face = 0, face_count = 0;
    EdgeKind kind = EdgeKind::mesh;
    /// All its faces were removed because of the side they show: it is hidden by what they bound.
    bool culled = false;
};

struct SceneEdges {
    std::vector<SceneEdge> edges;      ///< in the order of a, then of b
    std::vector<std::uint32_t> faces;  ///< triangles; those of an edge in ascending order
    /// Where edges end at which the scene has no position: a boundary ends where the sheet of its
    /// face goes on behind it.
    std::vector<glm::dvec3> cuts;

    [[nodiscard]] std::span<const std::uint32_t> faces_of(const SceneEdge& edge) const {
        return std::span(faces).subspan(edge.first_face, edge.face_count);
    }
};

/// Finds the edges of the given kinds; EdgeKind::intersection is none of theirs. Which side of a
/// face is seen is judged in the world. O(n) for meshes, on all cores.
[[nodiscard]] SceneEdges find_edges(const ScreenScene& page, EdgeKinds kinds,
                                    double crease_angle_degrees, int threads);

}  // namespace sightline
