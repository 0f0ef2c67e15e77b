// What pairs of triangles say about where surfaces cross, and how that makes segments of curves.
#pragma once

#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

#include "drawing/intersections.hpp"

namespace sightline {

/// Ends of pieces at most so many steps apart in x and in y become one point.
inline constexpr std::int32_t kJoinedSteps = 4;

/// An edge by its ends, the lexicographically lower one first: faces that share an edge in the
/// world have equal ends there, whatever object they belong to and however they were clipped.
struct PageSide {
    ScreenPoint low{}, high{};

    PageSide() = default;
    PageSide(const ScreenPoint& p, const ScreenPoint& q);
    [[nodiscard]] auto key() const { return std::tie(low.x, low.y, low.z, high.x, high.y, high.z); }
    friend bool operator==(const PageSide&, const PageSide&) = default;
    friend bool operator<(const PageSide& a, const PageSide& b) { return a.key() < b.key(); }
};

/// A stretch in which two faces cross, and where it ends: on an edge of one of them, in the other.
struct CrossingPiece {
    struct End {
        PageSide edge;
        std::uint32_t other = 0;
    };
    Crossing crossing;
    std::array<End, 2> ends;  ///< those at p and at q
};

/// A triangle with an edge in another one's plane: half of a crossing, when a triangle on the other
/// side of that plane has the same edge.
struct HalfCrossing {
    PageSide edge;
    std::uint32_t plane = 0;     ///< the triangle whose plane it is
    std::uint32_t occluder = 0;  ///< number of that triangle, or of a piece of it
    int side = 0;
    Crossing crossing;
};

/// Two edges on one line, each of a triangle that has it in the other one's plane. Around that line
/// the faces at each edge lie like rays around a point: the surfaces cross where those of one
/// separate those of the other.
struct EdgeMeeting {
    struct Ray {
        std::uint32_t occluder = 0;  ///< number of the triangle
        bool right = false;          ///< of the first edge, from its lower to its higher end
    };
    PageSide first, second;  ///< in order
    Ray at_first, at_second;
    bool nearer = false;  ///< the triangle at the first edge, where both are on one side
    Crossing crossing;
};

struct CrossingParts {
    std::vector<CrossingPiece> pieces;
    std::vector<HalfCrossing> halves;
    std::vector<EdgeMeeting> meetings;

    void append(const CrossingParts& more);
};

/// The segments that parts make, in an order that depends on the set of parts alone: pieces, whose
/// ends on a common edge are joined to that of the lower pair of faces; halves that have a
/// counterpart on the other side; meetings of edges where surfaces go on to the other side.
/// O(n log n).
[[nodiscard]] std::vector<Crossing> join(CrossingParts& parts);

}  // namespace sightline
