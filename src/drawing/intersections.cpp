#include "drawing/intersections.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "drawing/hidden_lines.hpp"
#include "math/arena.hpp"

namespace sightline {
namespace {

constexpr std::size_t kGrain = 256;  // parts of the search that a task takes at a time

/// The corners of one triangle against the plane of another one.
struct Sides {
    std::array<int, 3> sign{};

    Sides(const Occluder& of, const Plane& plane) {
        for (std::size_t k = 0; k < 3; ++k) sign[k] = side_of_plane(plane, of.point(k));
    }
    [[nodiscard]] bool some(int side) const {
        return sign[0] == side || sign[1] == side || sign[2] == side;
    }
    [[nodiscard]] bool crossing() const { return some(-1) && some(1); }
    [[nodiscard]] int zeros() const {
        return (sign[0] == 0 ? 1 : 0) + (sign[1] == 0 ? 1 : 0) + (sign[2] == 0 ? 1 : 0);
    }
};

/// Where an edge meets a plane, if it does so inside of the triangle that has the plane.
std::optional<EdgeParam> pierce(const ScreenPoint& p, const ScreenPoint& q, Int128 at_p,
                                Int128 at_q, const Occluder& o) {
    // The side functions of the triangle, linear along the edge, at the zero of the depth: products
    // of 2b + 1 and 2b + Z + 2 bits, the sum of two of them.
    static_assert(4 * kCoordBits + kDepthBits + 4 <= 127);
    const Int128 from_p = at_p < 0 ? -at_p : at_p, from_q = at_q < 0 ? -at_q : at_q;
    if (from_p + from_q == 0) return std::nullopt;
    for (std::size_t k = 0; k < 3; ++k) {
        const ScreenPoint &from = o.point(k), &to = o.point(Occluder::next(k));
        const std::int64_t e_p = side(from.x, from.y, to.x, to.y, p.x, p.y);
        const std::int64_t e_q = side(from.x, from.y, to.x, to.y, q.x, q.y);
        if (e_p * from_q + e_q * from_p < 0) return std::nullopt;
    }
    return EdgeParam(from_p, from_p + from_q);
}

bool inside(const Occluder& o, const ScreenPoint& s) {
    return side(o.p.x, o.p.y, o.q.x, o.q.y, s.x, s.y) >= 0 &&
           side(o.q.x, o.q.y, o.r.x, o.r.y, s.x, s.y) >= 0 &&
           side(o.r.x, o.r.y, o.p.x, o.p.y, s.x, s.y) >= 0;
}

/// At most four points on a line: two where each triangle's border meets the other's plane.
class Ends {
public:
    void add(const ScreenPoint& s) {
        if (count_ < points_.size()) points_[count_++] = s;
    }
    /// The two that lie farthest apart; false when they do not on the page.
    bool extremes(ScreenPoint& p, ScreenPoint& q) const {
        std::int64_t longest = 0;
        for (std::size_t i = 0; i < count_; ++i) {
            for (std::size_t j = i + 1; j < count_; ++j) {
                const std::int64_t dx = std::int64_t{points_[j].x} - points_[i].x;
                const std::int64_t dy = std::int64_t{points_[j].y} - points_[i].y;
                if (dx * dx + dy * dy <= longest) continue;
                longest = dx * dx + dy * dy;
                p = points_[i];
                q = points_[j];
            }
        }
        return longest > 0;
    }

private:
    std::array<ScreenPoint, 6> points_{};
    std::size_t count_ = 0;
};

/// The points where the border of `of` meets the plane of `other`, inside of it.
void add_ends(const Occluder& of, const Sides& sides, const Occluder& other, Ends& ends) {
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = Occluder::next(k);
        if (sides.sign[k] == 0 && inside(other, of.point(k))) ends.add(of.point(k));
        if (sides.sign[k] * sides.sign[next] >= 0) continue;
        const bool swap = of.corners[k] > of.corners[next];
        const std::size_t first = swap ? next : k, last = swap ? k : next;
        const auto at =
            pierce(of.point(first), of.point(last), depth_behind(other.plane, of.point(first)),
                   depth_behind(other.plane, of.point(last)), other);
        if (at) ends.add(point_at(of.point(first), of.point(last), *at));
    }
}

/// A triangle with an edge in another one's plane: half of a crossing, when a triangle on the other
/// side of that plane has the same edge.
struct HalfCrossing {
    std::uint32_t low = 0, high = 0;  ///< points at the ends of the edge
    std::uint32_t plane = 0;          ///< the triangle whose plane it is
    int side = 0;
    Crossing crossing;

    [[nodiscard]] auto key() const { return std::tie(low, high, plane); }
};

/// Two edges on one line, each of a triangle that lies on one side of the other one's plane: a
/// quarter of a crossing, when both surfaces go on to the other side.
struct EdgeMeeting {
    std::array<std::uint32_t, 4> points{};  ///< ends of the edges: lower, higher, lower, higher
    int first_side = 0, second_side = 0;    ///< of the triangles with the first and second edge
    Crossing crossing;
};

struct Found {
    std::vector<Crossing> whole;
    std::vector<HalfCrossing> halves;
    std::vector<EdgeMeeting> meetings;
};

bool before(const Crossing& c, const Crossing& d) {
    return std::tie(c.faces, c.p.x, c.p.y, c.q.x, c.q.y) <
           std::tie(d.faces, d.p.x, d.p.y, d.q.x, d.q.y);
}

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

/// The common part of two edges that lie on one line.
bool overlap(ScreenPoint& p, ScreenPoint& q, const ScreenPoint& r, const ScreenPoint& s) {
    const std::int64_t dx = std::int64_t{q.x} - p.x, dy = std::int64_t{q.y} - p.y;
    const std::int64_t length = dx * dx + dy * dy;
    if (length == 0) return false;
    const auto along = [&](const ScreenPoint& at) {
        const std::int64_t t = dx * (std::int64_t{at.x} - p.x) + dy * (std::int64_t{at.y} - p.y);
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
    explicit CrossingFinder(const Occluders& occluders) : occluders_(occluders) {}

    void find(std::size_t begin, std::size_t end, VisitMarks& marks, Found& found) const {
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

    /// Whether a triangle lies outside of one of the two sides of another one that meet at a corner
    /// of both: they have nothing but that corner in common on the page. In a mesh that is so of
    /// most triangles around a vertex.
    static bool is_outside(const Occluder& o, std::size_t own, const Occluder& other,
                           std::size_t theirs) {
        const ScreenPoint& corner = o.point(own);
        const std::size_t after = Occluder::next(own), before = Occluder::next(after);
        const std::size_t first = Occluder::next(theirs), second = Occluder::next(first);
        const auto beyond = [&](const ScreenPoint& from, const ScreenPoint& to) {
            const ScreenPoint &s = other.point(first), &t = other.point(second);
            return side(from.x, from.y, to.x, to.y, s.x, s.y) < 0 &&
                   side(from.x, from.y, to.x, to.y, t.x, t.y) < 0;
        };
        return beyond(corner, o.point(after)) || beyond(o.point(before), corner);
    }

    static void test(const Occluder& o, const Occluder& other, Found& found) {
        if (o.sheet != kNone && o.sheet == other.sheet) return;
        const Shared shared(o, other);
        if (shared.count > 1) return;
        if (shared.count == 1 && (is_outside(o, shared.own, other, shared.theirs) ||
                                  is_outside(other, shared.theirs, o, shared.own)))
            return;
        const Sides own(o, other.plane);
        if (!own.crossing() && own.zeros() != 2) return;
        const Sides theirs(other, o.plane);
        if (own.crossing() && theirs.crossing()) add_whole(o, own, other, theirs, found);
        if (own.zeros() == 2 && theirs.crossing()) add_half(o, own, other, found);
        if (theirs.zeros() == 2 && own.crossing()) add_half(other, theirs, o, found);
        if (own.zeros() == 2 && theirs.zeros() == 2) add_meeting(o, own, other, theirs, found);
    }

    static void add_whole(const Occluder& o, const Sides& own, const Occluder& other,
                          const Sides& theirs, Found& found) {
        Ends ends;
        add_ends(o, own, other, ends);
        add_ends(other, theirs, o, ends);
        Crossing crossing;
        crossing.faces = {o.id, other.id};
        if (ends.extremes(crossing.p, crossing.q)) found.whole.push_back(crossing);
    }

    /// The corner that is not in the plane, and the two that are, the one with the lower number
    /// first.
    struct ZeroEdge {
        std::size_t off, a, b;
    };
    static ZeroEdge zero_edge(const Occluder& o, const Sides& sides) {
        const std::size_t off = sides.sign[0] != 0 ? 0 : sides.sign[1] != 0 ? 1 : 2;
        ZeroEdge edge{off, (off + 1) % 3, (off + 2) % 3};
        if (o.corners[edge.a] > o.corners[edge.b]) std::swap(edge.a, edge.b);
        return edge;
    }

    static void add_half(const Occluder& o, const Sides& own, const Occluder& other, Found& found) {
        const ZeroEdge e = zero_edge(o, own);
        HalfCrossing half{o.corners[e.a], o.corners[e.b], other.id, own.sign[e.off], {}};
        half.crossing = {
            o.point(e.a), o.point(e.b), {std::min(o.id, other.id), std::max(o.id, other.id)}};
        if (clip_edge(half.crossing.p, half.crossing.q, other)) found.halves.push_back(half);
    }

    static void add_meeting(const Occluder& o, const Sides& own, const Occluder& other,
                            const Sides& theirs, Found& found) {
        const ZeroEdge e = zero_edge(o, own), f = zero_edge(other, theirs);
        EdgeMeeting meeting;
        meeting.points = {o.corners[e.a], o.corners[e.b], other.corners[f.a], other.corners[f.b]};
        meeting.first_side = own.sign[e.off];
        meeting.second_side = theirs.sign[f.off];
        meeting.crossing = {
            o.point(e.a), o.point(e.b), {std::min(o.id, other.id), std::max(o.id, other.id)}};
        if (meeting.points[0] > meeting.points[2]) {
            std::swap(meeting.points[0], meeting.points[2]);
            std::swap(meeting.points[1], meeting.points[3]);
            std::swap(meeting.first_side, meeting.second_side);
        }
        if (overlap(meeting.crossing.p, meeting.crossing.q, other.point(f.a), other.point(f.b)))
            found.meetings.push_back(meeting);
    }

    const Occluders& occluders_;
};

/// Adds the halves that have a counterpart on the other side.
void join_halves(std::vector<HalfCrossing>& halves, std::vector<Crossing>& all) {
    std::ranges::sort(halves, [](const HalfCrossing& e, const HalfCrossing& f) {
        return e.key() != f.key() ? e.key() < f.key() : before(e.crossing, f.crossing);
    });
    for (std::size_t i = 0, end = 0; i < halves.size(); i = end) {
        bool nearer = false, deeper = false;
        for (; end < halves.size() && halves[end].key() == halves[i].key(); ++end) {
            nearer = nearer || halves[end].side < 0;
            deeper = deeper || halves[end].side > 0;
        }
        if (nearer && deeper) all.push_back(halves[i].crossing);
    }
}

/// Adds the meetings of edges whose faces lie on both sides of each other.
void join_meetings(std::vector<EdgeMeeting>& meetings, std::vector<Crossing>& all) {
    std::ranges::sort(meetings, [](const EdgeMeeting& e, const EdgeMeeting& f) {
        return e.points != f.points ? e.points < f.points : before(e.crossing, f.crossing);
    });
    for (std::size_t i = 0, end = 0; i < meetings.size(); i = end) {
        bool first[2] = {}, second[2] = {};
        for (; end < meetings.size() && meetings[end].points == meetings[i].points; ++end) {
            first[meetings[end].first_side > 0 ? 1 : 0] = true;
            second[meetings[end].second_side > 0 ? 1 : 0] = true;
        }
        if (first[0] && first[1] && second[0] && second[1]) all.push_back(meetings[i].crossing);
    }
}

}  // namespace

std::vector<Crossing> find_crossings(const Occluders& occluders, int threads, WorkMeter& meter) {
    const std::size_t parts = occluders.part_count(), count = (parts + kGrain - 1) / kGrain;
    std::vector<Found> tasks(count);
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
    std::vector<Crossing> all;
    std::vector<HalfCrossing> halves;
    std::vector<EdgeMeeting> meetings;
    for (const Found& task : tasks) {
        all.insert(all.end(), task.whole.begin(), task.whole.end());
        halves.insert(halves.end(), task.halves.begin(), task.halves.end());
        meetings.insert(meetings.end(), task.meetings.begin(), task.meetings.end());
    }
    std::ranges::sort(all, before);  // whatever the order of the search
    join_halves(halves, all);
    join_meetings(meetings, all);
    return all;
}

}  // namespace sightline
