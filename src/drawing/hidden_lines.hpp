// The hidden parts of a line, exactly.
//
// Source: A. Appel, "The Notion of Quantitative Invisibility and the Machine Rendering of Solids",
// ACM National Conference 1967; intervals against occluders as in L. Roberts, "Machine Perception
// of Three-Dimensional Solids", 1963. How this version differs: the hidden part is the union of
// exact intervals, each from one occluder, and it is taken on both sides of the line: a point is
// hidden iff the points beside it are hidden on the left and on the right. So a line along the rim
// of a surface in front of it is visible, and one along the seam of two such surfaces is not.
//
// Notation. The line runs from p to q; a fraction t of the way is an EdgeParam. For an occluder
// with plane c (z - z0) = a (x - x0) + b (y - y0), the number
//
//     D = c (z - z0) - a (x - x0) - b (y - y0)
//
// of a point is positive when the point lies deeper than the plane. Where |D| <= 2 (c + |a| + |b|)
// the point and the plane are within what snapping (half a step in x, y and z, of the point and of
// the plane's corners) can have moved them: then the line touches the surface and D counts as 0.
// Depth 0 does not hide.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "drawing/edge_param.hpp"
#include "drawing/occluders.hpp"

namespace sightline {

/// A line of the page and the faces it belongs to, which never hide it.
struct PageSegment {
    ScreenPoint p, q;
    std::span<const std::uint32_t> faces;   ///< ids of triangles
    std::span<const std::uint32_t> sheets;  ///< theirs
};

/// Signed distance in depth from a plane, as above. 2b + Z + 2 bits.
[[nodiscard]] inline Int128 depth_behind(const Plane& plane, const ScreenPoint& s) {
    return Int128{plane.c} * (std::int64_t{s.z} - plane.at.z) -
           Int128{plane.a} * (std::int64_t{s.x} - plane.at.x) -
           Int128{plane.b} * (std::int64_t{s.y} - plane.at.y);
}
/// What |D| may be where a point touches the plane, as above. b + Z + 5 bits.
[[nodiscard]] inline Int128 touching_zone(const Plane& plane) {
    const auto magnitude = [](Int128 value) { return value < 0 ? -value : value; };
    return 2 * (Int128{plane.c} + magnitude(plane.a) + magnitude(plane.b));
}
/// Its sign; 0 where the point touches the plane.
[[nodiscard]] int side_of_plane(const Plane& plane, Int128 depth_behind);
/// The same of a point: a filter in double precision, then integers.
[[nodiscard]] int side_of_plane(const Plane& plane, const ScreenPoint& s);

struct EdgeInterval {
    EdgeParam from, to;
};

/// Finds hidden parts of one line after another. Not thread-safe: one a thread.
class HiddenLineFinder {
public:
    explicit HiddenLineFinder(const Occluders& occluders) : occluders_(occluders) {}

    /// The hidden parts, in order and apart; valid until the next call. O(log n + k log k) for k
    /// occluders near the line. Precondition: p and q differ in x or y.
    [[nodiscard]] std::span<const EdgeInterval> find(const PageSegment& segment);

    [[nodiscard]] std::uint64_t tests() const { return tests_; }

    // What PageGrid::walk() asks.
    [[nodiscard]] bool enter(double t0, double t1);
    [[nodiscard]] bool visit(std::uint32_t k);
    [[nodiscard]] bool done() const { return all_hidden(); }

private:
    enum Sides : std::uint8_t { kLeft = 1, kRight = 2, kBoth = 3 };
    /// An interval in which one side of a line is hidden.
    struct HalfCover {
        EdgeInterval interval;
        Sides side = kLeft;
    };
    struct Event {
        EdgeParam at;
        std::uint8_t sides;
        int change;
    };

    [[nodiscard]] bool is_hidden_between(double t0, double t1) const;
    [[nodiscard]] bool all_hidden() const;
    void test(const PageSegment& segment, const Occluder& occluder);
    [[nodiscard]] bool is_covered(const EdgeInterval& interval) const;
    void merge_new();
    void join_halves();

    const Occluders& occluders_;
    VisitMarks marks_;
    const PageSegment* segment_ = nullptr;
    double cell_from_ = 0, cell_to_ = 1;  // the part of the line in the cell that is walked through
    std::vector<EdgeInterval> new_;       // hidden on both sides, not yet merged
    std::vector<EdgeInterval> hidden_, merged_;
    std::vector<HalfCover> halves_;
    std::vector<Event> events_;
    std::uint64_t tests_ = 0;
};

}  // namespace sightline
