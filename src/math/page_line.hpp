// Lines of the page with integer factors, and the one question that is asked of them: on which side
// of a line lies the point where two others cross? Everything that is decided about split polygons
// comes down to it, and no crossing is ever rounded.
#pragma once

#include "math/int128.hpp"
#include "math/predicates.hpp"

namespace sightline {

/// The half-plane l x + m y + n >= 0, x and y in units of the screen.
/// |l|, |m| < 2^(3b+Z+4), |n| < 2^(4b+Z+4): those of a line in which two planes cross.
struct PageLine {
    Int128 l = 0, m = 0, n = 0;
    double dl = 0, dm = 0, dn = 0;  ///< the same, rounded

    PageLine() = default;
    PageLine(Int128 l_, Int128 m_, Int128 n_)
        : l(l_),
          m(m_),
          n(n_),
          dl(static_cast<double>(l_)),
          dm(static_cast<double>(m_)),
          dn(static_cast<double>(n_)) {}

    [[nodiscard]] PageLine reversed() const { return {-l, -m, -n}; }
};

/// Through p and q; the positive side is to the right of p -> q on the page, as in side().
[[nodiscard]] PageLine line_through(const ScreenPoint& p, const ScreenPoint& q);

/// Positive where plane p is deeper than plane q. Preconditions: both c > 0.
[[nodiscard]] PageLine line_where_deeper(const Plane& p, const Plane& q);

/// Sign of the determinant of three lines. Where p and q cross at a point with p.l * q.m > q.l *
/// p.m, as neighbouring sides of a convex region do, it says on which side of `of` that point is.
/// A filter in double precision, then 512-bit integers: exact.
[[nodiscard]] int sign_at_crossing(const PageLine& p, const PageLine& q, const PageLine& of);

/// Extents on the page, in units of the screen.
struct PageBounds {
    std::int32_t x0 = 0, x1 = 0, y0 = 0, y1 = 0;
};

/// A box around the point where two lines cross, which is known to lie in a box: that one where
/// the lines are too close to parallel to tell more.
[[nodiscard]] PageBounds bounds_of_crossing(const PageLine& p, const PageLine& q,
                                            const PageBounds& known);

}  // namespace sightline
