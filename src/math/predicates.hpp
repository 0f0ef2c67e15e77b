// The exact decisions of the screen, stated as laws.
//
// Notation. b = kCoordBits bits of x and y (extent 2^b, guard band included), Z = kDepthBits bits
// of z. y grows downwards. All inputs are points and planes of one ScreenScene.
//
//   side(p, q, s)   = (q - p) x (s - p): > 0 when s lies to the right of p -> q on the page
//                     (clockwise on a screen whose y grows down). 2b + 1 bits.
//   covers(t, s)    : s lies inside the triangle, or on an edge of it that is a top or left edge.
//   For
//                     any set of triangles that tile a region, each sample has one owner.
//   compare_depth   : sign of z_P(s) - z_Q(s) as rational numbers. Antisymmetric, transitive; 0
//                     exactly when the depths are equal.
//
// compare_depth is two stages: a filter in double precision that may answer "uncertain", and
// integers. Which stage answered is reported, so that tests and --stats can count.
#pragma once

#include <cstdint>
#include <utility>

#include "math/int128.hpp"
#include "sightline/screen_scene.hpp"

namespace sightline {

// An edge function is the difference of two products of coordinate differences.
static_assert(2 * kCoordBits + 1 <= 63);
// |a|, |b| of a plane: area of a projection onto a box of 2^b by 2^Z.
static_assert(kCoordBits + kDepthBits + 1 <= 63);
// The comparison of two planes, extrapolated over the whole page: |n| <= 3 * 2^(2b+Z), c <= 2^2b,
// and a difference of two such products.
static_assert(4 * kCoordBits + kDepthBits + 3 <= 127);

[[nodiscard]] constexpr std::int64_t side(std::int32_t px, std::int32_t py, std::int32_t qx,
                                          std::int32_t qy, std::int32_t sx, std::int32_t sy) {
    return (std::int64_t{qx} - px) * (std::int64_t{sy} - py) -
           (std::int64_t{qy} - py) * (std::int64_t{sx} - px);
}

/// An edge that runs this way, in a triangle whose inside has side > 0, owns its points when it is
/// a left edge (it runs up) or a top edge (level, and it runs to the right).
[[nodiscard]] constexpr bool is_top_left(std::int64_t dx, std::int64_t dy) {
    return dy < 0 || (dy == 0 && dx > 0);
}

/// A triangle on the screen, ordered so that its inside has side > 0. Doubled area 0: covers
/// nothing.
struct OrientedTriangle {
    ScreenPoint p, q, r;
    std::int64_t area2 = 0;

    OrientedTriangle(ScreenPoint a, ScreenPoint b, ScreenPoint c)
        : p(a), q(b), r(c), area2(side(a.x, a.y, b.x, b.y, c.x, c.y)) {
        if (area2 < 0) {
            std::swap(q, r);
            area2 = -area2;
        }
    }
};

[[nodiscard]] constexpr bool edge_admits(const ScreenPoint& p, const ScreenPoint& q,
                                         std::int32_t sx, std::int32_t sy) {
    const std::int64_t e = side(p.x, p.y, q.x, q.y, sx, sy);
    return e > 0 || (e == 0 && is_top_left(std::int64_t{q.x} - p.x, std::int64_t{q.y} - p.y));
}

[[nodiscard]] inline bool covers(const OrientedTriangle& t, std::int32_t sx, std::int32_t sy) {
    return t.area2 > 0 && edge_admits(t.p, t.q, sx, sy) && edge_admits(t.q, t.r, sx, sy) &&
           edge_admits(t.r, t.p, sx, sy);
}

/// The plane through three snapped points, with c >= 0. c = 0 when they are collinear on the page.
[[nodiscard]] Plane plane_through(const ScreenPoint& p, const ScreenPoint& q, const ScreenPoint& r);

/// c * z of a plane at a point: the numerator of its depth. 2b + Z bits inside the triangle.
[[nodiscard]] inline Int128 depth_numerator(const Plane& plane, std::int32_t x, std::int32_t y) {
    return Int128{plane.c} * plane.at.z + Int128{plane.a} * (std::int64_t{x} - plane.at.x) +
           Int128{plane.b} * (std::int64_t{y} - plane.at.y);
}

/// Which stage decided.
enum class Stage { filter, exact };

struct DepthOrder {
    int sign = 0;  ///< -1: the first is nearer; 0: equal; 1: the second is nearer
    Stage stage = Stage::exact;
};

/// Integers only. Preconditions: both c > 0.
[[nodiscard]] int compare_depth_exactly(const Plane& p, const Plane& q, std::int32_t x,
                                        std::int32_t y);

/// Filter, then integers. Preconditions: both c > 0.
[[nodiscard]] DepthOrder compare_depth(const Plane& p, const Plane& q, std::int32_t x,
                                       std::int32_t y);

}  // namespace sightline
