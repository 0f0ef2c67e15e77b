// All lines of a drawing: edges of the scene and curves of intersection, cut into visible and
// hidden parts.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "drawing/hidden_lines.hpp"
#include "drawing/work_meter.hpp"

namespace sightline {

/// A line of the page before it is cut.
struct PageEdge {
    ScreenPoint p, q;
    EdgeKind kind = EdgeKind::mesh;
    bool culled = false;  ///< wholly hidden: its faces are the removed back of something closed
    std::uint32_t first_face = 0, face_count = 0;  ///< in PageEdges::faces; none of a FreeLine
    std::uint32_t object = kNone;                  ///< of a FreeLine
};

struct PageEdges {
    std::vector<PageEdge> edges;
    std::vector<std::uint32_t> faces;
    std::uint64_t crossings = 0;  ///< edges on which surfaces cross

    [[nodiscard]] std::span<const std::uint32_t> faces_of(const PageEdge& edge) const {
        return std::span(faces).subspan(edge.first_face, edge.face_count);
    }
};

/// The edges of the scene that the options ask for, then the free lines, without those seen end-on
/// or outside of the page.
[[nodiscard]] PageEdges collect_edges(const ScreenScene& page, const TraceOptions& options);

/// Appends the curves in which occluders cross.
void append_crossings(const Occluders& occluders, int threads, WorkMeter& meter, PageEdges& all);

/// The hidden parts of every edge, exactly: of edge i hidden[first[i]] .. hidden[first[i + 1] - 1],
/// in order and apart.
struct HiddenParts {
    std::vector<std::uint64_t> first;
    std::vector<EdgeInterval> hidden;
    std::uint64_t tests = 0;
};
[[nodiscard]] HiddenParts find_hidden_parts(const ScreenScene& page, const Occluders& occluders,
                                            const PageEdges& edges, int threads, WorkMeter& meter);

/// Rounds the parts to the grid and appends them to a drawing, hidden ones if the options say so.
void append_lines(const ScreenScene& page, const PageEdges& edges, const HiddenParts& parts,
                  bool hidden, Drawing& drawing);

}  // namespace sightline
