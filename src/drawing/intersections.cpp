#include "drawing/intersections.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "drawing/carrier.hpp"
#include "drawing/crossing_parts.hpp"
#include "drawing/edge_param.hpp"
#include "drawing/hidden_lines.hpp"
#include "math/arena.hpp"

namespace sightline {
namespace {

constexpr std::size_t kGrain = 256;  // parts of the search that a task takes at a time

/// Which sheets are seen so nearly edge-on that all of them lies within kEdgeOnSteps on the page.
/// Snapping then turns their planes so far that these tell little of what is where along the sheet.
class EdgeOnSheets {
public:
    explicit EdgeOnSheets(const Occluders& occluders) {
        for (const std::uint32_t k : occluders.in_sheets()) add(occluders[k]);
    }
    [[nodiscard]] bool has(const Occluder& o) const {
        if (o.sheet == kNone) return false;
        const Extent& extent = extents_[o.sheet];
        return extent.high - extent.low < kEdgeOnSteps * extent.gradient;
    }

private:
    static constexpr double kEdgeOnSteps = 32;
    /// Of what is seen of a sheet, along the gradient of its depth and times the gradient's length.
    struct Extent {
        double low = HUGE_VAL, high = -HUGE_VAL, gradient = 0;
    };

    void add(const Occluder& o) {
        if (o.sheet >= extents_.size()) extents_.resize(o.sheet + std::size_t{1});
        Extent& extent = extents_[o.sheet];
        const auto a = static_cast<double>(o.plane.a), b = static_cast<double>(o.plane.b);
        extent.gradient = std::sqrt(a * a + b * b);
        for (const ScreenPoint* s : {&o.p, &o.q, &o.r}) {
            extent.low = std::min(extent.low, a * s->x + b * s->y);
            extent.high = std::max(extent.high, a * s->x + b * s->y);
        }
    }

    std::vector<Extent> extents_;
};

/// A face with the plane that it has where it crosses others: the one that decides its depth, but
/// the one through its own corners in a sheet that is seen edge-on.
struct CrossingFace {
    const Occluder& o;
    Plane plane;
    bool has_own_plane;

    CrossingFace(const Occluder& face, const EdgeOnSheets& edge_on)
        : o(face), plane(face.plane), has_own_plane(face.has_own_plane) {
        if (!edge_on.has(face)) return;
        plane = plane_through(face.p, face.q, face.r);
        has_own_plane = true;
    }
};

/// Whether the plane of a face is nearer (-1) or deeper (1) than that of another one at its
/// corners. 0 where a corner touches the other plane, or where the other plane passes between a
/// corner and the face's own plane, which is a shared one then.
struct Sides {
    std::array<int, 3> sign{};

    Sides(const CrossingFace& face, const Plane& other) {
        for (std::size_t k = 0; k < 3; ++k) {
            const ScreenPoint& s = face.o.point(k);
            sign[k] = side_of_plane(other, s);
            if (sign[k] != 0 && !face.has_own_plane &&
                compare_depth(face.plane, other, s.x, s.y).sign != sign[k])
                sign[k] = 0;
        }
    }
    [[nodiscard]] bool some(int side) const {
        return sign[0] == side || sign[1] == side || sign[2] == side;
    }
    [[nodiscard]] bool crossing() const { return some(-1) && some(1); }
    [[nodiscard]] int zeros() const {
        return (sign[0] == 0 ? 1 : 0) + (sign[1] == 0 ? 1 : 0) + (sign[2] == 0 ? 1 : 0);
    }
};

/// The part of an edge that lies over a triangle.
bool clip_edge(ScreenPoint& p, ScreenPoint& q, const Occluder& o) {
    EdgeParam from = EdgeParam::start(), to = EdgeParam::end();
    for (std::size_t k = 0; k < 3; ++k) {
        const ScreenPoint &a = o.point(k), &b = o.point(Occluder::next(k));
        const std::int64_t e_p = side(a.x, a.y, b.x, b.y, p.x, p.y);
        const std::int64_t e_q = side(a.x, a.y, b.x, b.y, q.x, q.y);
        if (e_p < 0 && e_q < 0) return false;
        if ((e_p < 0) == (e_q < 0)) continue;
        const EdgeParam t = EdgeParam::of_zero(e_p, e_q);
        if (e_p < 0 && from < t) from = t;
        if (e_q < 0 && t < to) to = t;
    }
    if (!(from < to)) return false;
    const ScreenPoint start = point_at(p, q, from);
    q = point_at(p, q, to);
    p = start;
    return p.x != q.x || p.y != q.y;
}

/// Whether a point lies within kJoinedSteps of the line through two others.
bool is_on_line(const ScreenPoint& s, const ScreenPoint& p, const ScreenPoint& q) {
    static_assert(2 * (2 * kCoordBits + 1) <= 127);
    const Int128 dx = std::int64_t{q.x} - p.x, dy = std::int64_t{q.y} - p.y;
    const Int128 beside = side(p.x, p.y, q.x, q.y, s.x, s.y);
    return beside * beside <= kJoinedSteps * kJoinedSteps * (dx * dx + dy * dy);
}

/// The common part of two edges, where they lie on one line.
bool overlap(ScreenPoint& p, ScreenPoint& q, const ScreenPoint& r, const ScreenPoint& s) {
    const auto squared = [](const ScreenPoint& a, const ScreenPoint& b) {
        const std::int64_t dx = std::int64_t{b.x} - a.x, dy = std::int64_t{b.y} - a.y;
        return dx * dx + dy * dy;
    };
    const std::int64_t length = squared(p, q), other = squared(r, s);
    if (length == 0 || other == 0) return false;
    // The longer one says where the line is.
    if (other > length ? !is_on_line(p, r, s) || !is_on_line(q, r, s)
                       : !is_on_line(r, p, q) || !is_on_line(s, p, q))
        return false;
    const auto along = [&](const ScreenPoint& at) {
        const std::int64_t t = (std::int64_t{q.x} - p.x) * (std::int64_t{at.x} - p.x) +
                               (std::int64_t{q.y} - p.y) * (std::int64_t{at.y} - p.y);
        return EdgeParam(std::clamp(t, std::int64_t{0}, length), length);
    };
    const EdgeParam a = along(r), b = along(s);
    const ScreenPoint start = point_at(p, q, a < b ? a : b), end = point_at(p, q, a < b ? b : a);
    p = start;
    q = end;
    return p.x != q.x || p.y != q.y;
}

class CrossingFinder {
public:
    explicit CrossingFinder(const Occluders& occluders)
        : occluders_(occluders), edge_on_(occluders) {}

    void find(std::size_t begin, std::size_t end, VisitMarks& marks, CrossingParts& found) const {
        occluders_.pairs(begin, end, marks, [&](std::uint32_t i, std::uint32_t j) {
            const Occluder &o = occluders_[i], &other = occluders_[j];
            if (o.id < other.id) test(o, other, found);
            if (o.id > other.id) test(other, o, found);
        });
    }

private:
    /// Corners that two triangles share, and where one of them stands.
    struct Shared {
        int count = 0;
        std::size_t own = 0, theirs = 0;

        Shared(const Occluder& o, const Occluder& other) {
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t j = 0; j < 3; ++j)
                    if (o.corners[i] == other.corners[j]) ++count, own = i, theirs = j;
        }
    };

    /// Whether one of two triangles lies outside of one of the two sides of the other one that meet
    /// at their common corner, clearly so: they have nothing but that corner in common on the page,
    /// no edges on one line either. In a mesh that is so of most triangles around a vertex.
    static bool are_apart(const Occluder& o, const Occluder& other, const Shared& shared) {
        const Way a(o, shared.own, Occluder::next(shared.own));
        const Way b(o, shared.own, Occluder::next(Occluder::next(shared.own)));
        const Way s(other, shared.theirs, Occluder::next(shared.theirs));
        const Way t(other, shared.theirs, Occluder::next(Occluder::next(shared.theirs)));
        // The inside of a triangle is on the right of its first way and on the left of its second.
        const std::int64_t as = a.turn_to(s), at = a.turn_to(t), bs = b.turn_to(s),
                           bt = b.turn_to(t);
        return (as < -a.slack && at < -a.slack) || (bs > b.slack && bt > b.slack) ||
               (as > s.slack && bs > s.slack) || (at < -t.slack && bt < -t.slack);
    }
    /// The way from a corner to another one.
    struct Way {
        std::int64_t dx, dy, slack;

        Way(const Occluder& o, std::size_t from, std::size_t to)
            : dx(std::int64_t{o.point(to).x} - o.point(from).x),
              dy(std::int64_t{o.point(to).y} - o.point(from).y),
              slack(kJoinedSteps * (std::abs(dx) + std::abs(dy))) {}
        [[nodiscard]] std::int64_t turn_to(const Way& to) const { return dx * to.dy - dy * to.dx; }
    };

    [[gnu::noinline]] void test(const Occluder& o, const Occluder& other,
                                CrossingParts& found) const {
        if (o.sheet != kNone && o.sheet == other.sheet) return;
        const Shared shared(o, other);
        if (shared.count > 1) return;
        if (shared.count == 1 && are_apart(o, other, shared)) return;
        compare(o, other, found);
    }
    // Apart from test(), most calls of which come to an end quickly.
    [[gnu::noinline]] void compare(const Occluder& o, const Occluder& other,
                                   CrossingParts& found) const {
        const CrossingFace f(o, edge_on_), g(other, edge_on_);
        const Sides own(f, g.plane);
        if (!own.crossing() && own.zeros() != 2) return;
        const Sides theirs(g, f.plane);
        if (own.crossing() && theirs.crossing()) add_piece(f, own, g, theirs, found);
        if (own.zeros() == 2 && theirs.crossing()) add_half(o, own, other, found);
        if (theirs.zeros() == 2 && own.crossing()) add_half(other, theirs, o, found);
        if (own.zeros() == 2 && theirs.zeros() == 2) add_meeting(o, own, other, theirs, found);
    }

    /// Where a piece ends that meets side k of a face there: at a corner that touches the other
    /// face, if there is one near.
    static ScreenPoint piece_end(const Occluder& o, const Sides& sides, std::size_t k,
                                 const ScreenPoint& exact) {
        for (const std::size_t i : {k, Occluder::next(k)}) {
            const ScreenPoint& corner = o.point(i);
            if (sides.sign[i] == 0 && std::abs(corner.x - exact.x) <= kJoinedSteps &&
                std::abs(corner.y - exact.y) <= kJoinedSteps)
                return corner;
        }
        return exact;
    }

    /// The stretch in which the planes have one depth and that lies inside of both triangles.
    [[gnu::noinline]] static void add_piece(const CrossingFace& f, const Sides& own,
                                            const CrossingFace& g, const Sides& theirs,
                                            CrossingParts& found) {
        const PageLine line = line_where_deeper(f.plane, g.plane);
        const ConvexSides f_sides = sides_of(f.o.p, f.o.q, f.o.r);
        const ConvexSides g_sides = sides_of(g.o.p, g.o.q, g.o.r);
        std::optional<Stretch> stretch = chord(line, std::span(f_sides.side).first<3>());
        if (stretch) stretch = inside(line, CarrierSide::right, *stretch, g_sides);
        if (!stretch) return;
        // Sides 0, 1, 2 are those of f, the others those of g. The piece runs from the lower one.
        const auto side_at = [&](const Place& place) {
            std::size_t k = 0;
            while (place.line != (k < 3 ? &f_sides.side[k] : &g_sides.side[k - 3])) ++k;
            return k;
        };
        std::array<std::size_t, 2> at = {side_at(stretch->from), side_at(stretch->to)};
        if (at[1] < at[0]) std::swap(at[0], at[1]);
        CrossingPiece piece;
        piece.crossing.faces = {f.o.id, g.o.id};
        for (std::size_t i = 0; i < 2; ++i) {
            const bool on_f = at[i] < 3;
            const std::size_t k = on_f ? at[i] : at[i] - 3;
            const Occluder &o = on_f ? f.o : g.o, &other = on_f ? g.o : f.o;
            const PageLine& across = on_f ? f_sides.side[k] : g_sides.side[k];
            const glm::ivec2 page = rounded_crossing_of(line, across);
            const std::int32_t z = rounded_depth_at_crossing(line, across, f.plane);
            (i == 0 ? piece.crossing.p : piece.crossing.q) =
                piece_end(o, on_f ? own : theirs, k, {page.x, page.y, z});
            piece.ends[i] = {{o.point(k), o.point(Occluder::next(k))}, other.id};
        }
        found.pieces.push_back(piece);
    }

    [[nodiscard]] std::uint32_t number_of(const Occluder& o) const {
        return static_cast<std::uint32_t>(&o - &occluders_[0]);
    }

    /// The corner that is not in the plane, and the edge that is.
    struct ZeroEdge {
        const Occluder* o;
        int off_side;
        PageSide edge;
        bool right;  ///< of the edge, from its lower to its higher end

        ZeroEdge(const Occluder& face, const Sides& sides) : o(&face) {
            const std::size_t off = sides.sign[0] != 0 ? 0 : sides.sign[1] != 0 ? 1 : 2;
            off_side = sides.sign[off];
            const ScreenPoint& from = face.point(Occluder::next(off));
            edge = {from, face.point(Occluder::next(Occluder::next(off)))};
            right = edge.low == from;  // the inside of an occluder is on the right of its sides
        }
    };

    void add_half(const Occluder& o, const Sides& own, const Occluder& other,
                  CrossingParts& found) const {
        const ZeroEdge e(o, own);
        HalfCrossing half{e.edge, other.id, number_of(other), e.off_side, {}};
        half.crossing = {
            e.edge.low, e.edge.high, {std::min(o.id, other.id), std::max(o.id, other.id)}};
        if (clip_edge(half.crossing.p, half.crossing.q, other)) found.halves.push_back(half);
    }

    void add_meeting(const Occluder& o, const Sides& own, const Occluder& other,
                     const Sides& theirs, CrossingParts& found) const {
        ZeroEdge e(o, own), f(other, theirs);
        if (f.edge < e.edge) std::swap(e, f);
        EdgeMeeting meeting;
        meeting.crossing = {
            e.edge.low, e.edge.high, {std::min(o.id, other.id), std::max(o.id, other.id)}};
        if (!overlap(meeting.crossing.p, meeting.crossing.q, f.edge.low, f.edge.high)) return;
        meeting.first = e.edge;
        meeting.second = f.edge;
        meeting.at_first = {number_of(*e.o), e.right};
        meeting.at_second = {number_of(*f.o), f.right == same_way(e.edge, f.edge)};
        meeting.nearer = e.off_side < 0;
        found.meetings.push_back(meeting);
    }
    static bool same_way(const PageSide& e, const PageSide& f) {
        return (std::int64_t{e.high.x} - e.low.x) * (std::int64_t{f.high.x} - f.low.x) +
                   (std::int64_t{e.high.y} - e.low.y) * (std::int64_t{f.high.y} - f.low.y) >
               0;
    }

    const Occluders& occluders_;
    EdgeOnSheets edge_on_;
};

}  // namespace

std::vector<Crossing> find_crossings(const Occluders& occluders, int threads, WorkMeter& meter) {
    const std::size_t parts = occluders.part_count(), count = (parts + kGrain - 1) / kGrain;
    std::vector<CrossingParts> tasks(count);
    const CrossingFinder finder(occluders);
    tbb::enumerable_thread_specific<VisitMarks> thread_marks;
    in_arena(threads, [&] {
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t task) {
            meter.add(0);
            if (meter.stopped()) return;
            finder.find(task * kGrain, std::min(parts, (task + 1) * kGrain), thread_marks.local(),
                        tasks[task]);
        });
    });
    CrossingParts found;
    for (const CrossingParts& task : tasks) found.append(task);
    return join(found);
}

}  // namespace sightline
