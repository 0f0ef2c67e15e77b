#include "drawing/crossing_parts.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <span>
#include <utility>

namespace sightline {
namespace {

bool before(const Crossing& c, const Crossing& d) {
    return std::tie(c.faces, c.p.x, c.p.y, c.q.x, c.q.y) <
           std::tie(d.faces, d.p.x, d.p.y, d.q.x, d.q.y);
}

/// The end of a piece, to be moved.
struct PieceEnd {
    const CrossingPiece::End* at;
    ScreenPoint* point;

    [[nodiscard]] auto key() const { return std::tie(at->other, at->edge); }
};

/// Neighbours have equal ends on their common edge, unless shared planes pass by it.
void join_ends(std::vector<CrossingPiece>& pieces) {
    std::vector<PieceEnd> ends;
    ends.reserve(2 * pieces.size());
    for (CrossingPiece& piece : pieces) {
        ends.push_back({piece.ends.data(), &piece.crossing.p});
        ends.push_back({&piece.ends[1], &piece.crossing.q});
    }
    std::ranges::stable_sort(ends, {}, &PieceEnd::key);
    for (std::size_t i = 0, end = 0; i < ends.size(); i = end) {
        const ScreenPoint& first = *ends[i].point;
        for (++(end = i); end < ends.size() && ends[end].key() == ends[i].key(); ++end) {
            ScreenPoint& point = *ends[end].point;
            if (std::abs(point.x - first.x) <= kJoinedSteps &&
                std::abs(point.y - first.y) <= kJoinedSteps)
                point = first;
        }
    }
}

/// Adds the pieces but for those that rounding left no length.
void join_pieces(std::vector<CrossingPiece>& pieces, std::vector<Crossing>& all) {
    std::ranges::sort(pieces, before, &CrossingPiece::crossing);
    join_ends(pieces);
    for (const CrossingPiece& piece : pieces) {
        const Crossing& c = piece.crossing;
        if (c.p.x != c.q.x || c.p.y != c.q.y) all.push_back(c);
    }
}

void join_halves(std::vector<HalfCrossing>& halves, std::vector<Crossing>& all) {
    const auto key = [](const HalfCrossing& e) { return std::tie(e.edge, e.plane, e.occluder); };
    std::ranges::sort(halves, [&](const HalfCrossing& e, const HalfCrossing& f) {
        return key(e) != key(f) ? key(e) < key(f) : before(e.crossing, f.crossing);
    });
    for (std::size_t i = 0, end = 0; i < halves.size(); i = end) {
        bool nearer = false, deeper = false;
        for (; end < halves.size() && key(halves[end]) == key(halves[i]); ++end) {
            nearer = nearer || halves[end].side < 0;
            deeper = deeper || halves[end].side > 0;
        }
        if (nearer && deeper) all.push_back(halves[i].crossing);
    }
}

/// Whether the faces at one edge separate those at another one on the same line. Around the line
/// lie, on the right from near to deep and then on the left from deep to near, the faces at the
/// first edge; between two that follow each other there is one sector, and those at the second edge
/// must lie in different ones.
bool are_separated(std::span<const EdgeMeeting> meetings) {
    std::map<std::uint32_t, bool> first;  // whether on the right, by number
    struct Seen {
        bool right;
        std::size_t nearer = 0;  ///< faces at the first edge, on the same side
    };
    std::map<std::uint32_t, Seen> second;
    for (const EdgeMeeting& m : meetings) {
        first.try_emplace(m.at_first.occluder, m.at_first.right);
        Seen& seen =
            second.try_emplace(m.at_second.occluder, Seen{m.at_second.right}).first->second;
        if (m.at_first.right == m.at_second.right && m.nearer) ++seen.nearer;
    }
    if (first.size() < 2) return false;
    const auto sector = [&](const Seen& seen) {
        return (seen.right ? seen.nearer : first.size() - seen.nearer) % first.size();
    };
    const std::size_t one = sector(second.begin()->second);
    return std::ranges::any_of(second, [&](const auto& s) { return sector(s.second) != one; });
}

void join_meetings(std::vector<EdgeMeeting>& meetings, std::vector<Crossing>& all) {
    const auto key = [](const EdgeMeeting& e) { return std::tie(e.first, e.second); };
    std::ranges::sort(meetings, [&](const EdgeMeeting& e, const EdgeMeeting& f) {
        return key(e) != key(f) ? key(e) < key(f) : before(e.crossing, f.crossing);
    });
    for (std::size_t i = 0, end = 0; i < meetings.size(); i = end) {
        while (end < meetings.size() && key(meetings[end]) == key(meetings[i])) ++end;
        if (are_separated(std::span(meetings).subspan(i, end - i)))
            all.push_back(meetings[i].crossing);
    }
}

}  // namespace

PageSide::PageSide(const ScreenPoint& p, const ScreenPoint& q) : low(p), high(q) {
    if (std::tie(q.x, q.y, q.z) < std::tie(p.x, p.y, p.z)) std::swap(low, high);
}

void CrossingParts::append(const CrossingParts& more) {
    pieces.insert(pieces.end(), more.pieces.begin(), more.pieces.end());
    halves.insert(halves.end(), more.halves.begin(), more.halves.end());
    meetings.insert(meetings.end(), more.meetings.begin(), more.meetings.end());
}

std::vector<Crossing> join(CrossingParts& parts) {
    std::vector<Crossing> all;
    join_pieces(parts.pieces, all);
    join_halves(parts.halves, all);
    join_meetings(parts.meetings, all);
    return all;
}

}  // namespace sightline
