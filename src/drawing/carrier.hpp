// Intervals on lines of the page: where is a line inside of convex polygons, exactly?
//
// Notation. A carrier is a PageLine L with a direction, (m, -l), so that its positive side is on
// the right. A place on it is where another line B crosses it. B grows along L when
// B.l L.m - B.m L.l > 0. Of two places A and B the first comes first iff
//
//     det(L, A, B) = (growth of A) * (growth of B),
//
// since B is 0 at its own place, and its sign at A's place is -det * (growth of A).
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <span>

#include "math/page_line.hpp"

namespace sightline {

/// Sign of B.l L.m - B.m L.l: +1 where b grows along the carrier, -1 where it falls, 0 where it is
/// parallel. Exact.
[[nodiscard]] int growth(const PageLine& carrier, const PageLine& b);

/// Whether two lines that have equal directions up to their sign are one and the same.
/// Precondition: growth is 0, `across` crosses the carrier.
[[nodiscard]] int sign_of_parallel(const PageLine& carrier, const PageLine& across,
                                   const PageLine& parallel);

/// A place on a carrier.
struct Place {
    const PageLine* line = nullptr;
    int growth = 0;
    const ScreenPoint* corner = nullptr;  ///< the point itself, where it is one of the page
};

/// Sign of a - b along the carrier.
[[nodiscard]] inline int compare(const PageLine& carrier, const Place& a, const Place& b) {
    if (a.line == b.line || (a.corner != nullptr && a.corner == b.corner)) return 0;
    return -sign_at_crossing(carrier, *a.line, *b.line) * a.growth * b.growth;
}

/// A stretch of a carrier.
struct Stretch {
    Place from, to;
};

/// A convex polygon: a triangle, perhaps cut by one more line. Inside all sides are positive.
struct ConvexSides {
    std::array<PageLine, 4> side;
    std::uint32_t count = 3;

    [[nodiscard]] std::span<const PageLine> all() const { return {side.data(), count}; }
};

/// The sides of a triangle of the page. Precondition: side(p, q, r) > 0.
[[nodiscard]] ConvexSides sides_of(const ScreenPoint& p, const ScreenPoint& q,
                                   const ScreenPoint& r);

enum class CarrierSide { left, right };

/// The part of a stretch whose points have, infinitesimally beside them, the inside of a convex
/// polygon. Nothing when that is empty.
[[nodiscard]] std::optional<Stretch> inside(const PageLine& carrier, CarrierSide beside,
                                            const Stretch& stretch, const ConvexSides& polygon);

/// The stretch of a carrier that lies in a triangle; nothing when it has no length.
[[nodiscard]] std::optional<Stretch> chord(const PageLine& carrier,
                                           std::span<const PageLine, 3> triangle);

/// Where two lines cross, in units of the page: off by less than 2^-16 of a unit. Precondition:
/// they do, within the page.
[[nodiscard]] glm::dvec2 crossing_of(const PageLine& p, const PageLine& q);

/// The same, exactly rounded to the grid; half a step goes up.
[[nodiscard]] glm::ivec2 rounded_crossing_of(const PageLine& p, const PageLine& q);

/// The depth of a plane where two lines cross, exactly rounded in the same way and clamped to the
/// depths of the page. Preconditions: they cross within the page, c > 0.
[[nodiscard]] std::int32_t rounded_depth_at_crossing(const PageLine& p, const PageLine& q,
                                                     const Plane& plane);

}  // namespace sightline
