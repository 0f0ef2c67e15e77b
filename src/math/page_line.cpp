#include "math/page_line.hpp"

#include <algorithm>
#include <cmath>

#include "math/wide_int.hpp"

namespace sightline {

namespace {

// A product of three factors has 10b + 3Z + 12 bits, and six of them are summed.
static_assert(10 * kCoordBits + 3 * kDepthBits + 15 < 511);
static_assert(4 * kCoordBits + kDepthBits + 4 <= 127);

int sign_exactly(const PageLine& p, const PageLine& q, const PageLine& of) {
    const Int512 pl(p.l), pm(p.m), pn(p.n), ql(q.l), qm(q.m), qn(q.n);
    const Int512 det = Int512(of.l) * (pm * qn - pn * qm) + Int512(of.m) * (pn * ql - pl * qn) +
                       Int512(of.n) * (pl * qm - pm * ql);
    return det.sign();
}

}  // namespace

PageLine line_through(const ScreenPoint& p, const ScreenPoint& q) {
    const std::int64_t dx = std::int64_t{q.x} - p.x, dy = std::int64_t{q.y} - p.y;
    return {-dy, dx, dy * p.x - dx * p.y};
}

PageLine line_where_deeper(const Plane& p, const Plane& q) {
    // c z of a plane is a (x - at.x) + b (y - at.y) + c at.z.
    const auto rest = [](const Plane& plane) {
        return Int128{plane.c} * plane.at.z - Int128{plane.a} * plane.at.x -
               Int128{plane.b} * plane.at.y;
    };
    return {Int128{p.a} * q.c - Int128{q.a} * p.c, Int128{p.b} * q.c - Int128{q.b} * p.c,
            rest(p) * q.c - rest(q) * p.c};
}

int sign_at_crossing(const PageLine& p, const PageLine& q, const PageLine& of) {
    // Each factor is off by 2^-53 of itself, each product of three by five times that, and the
    // sums by five times of the sum of magnitudes: below 16 * 2^-53 in all.
    constexpr double kBound = 16 * 0x1p-53;
    const double a1 = p.dm * q.dn, a2 = p.dn * q.dm, b1 = p.dn * q.dl, b2 = p.dl * q.dn,
                 c1 = p.dl * q.dm, c2 = p.dm * q.dl;
    const double det = of.dl * (a1 - a2) + of.dm * (b1 - b2) + of.dn * (c1 - c2);
    const double magnitude = std::abs(of.dl) * (std::abs(a1) + std::abs(a2)) +
                             std::abs(of.dm) * (std::abs(b1) + std::abs(b2)) +
                             std::abs(of.dn) * (std::abs(c1) + std::abs(c2));
    if (std::abs(det) > kBound * magnitude) return det < 0 ? -1 : 1;
    return sign_exactly(p, q, of);
}

PageBounds bounds_of_crossing(const PageLine& p, const PageLine& q, const PageBounds& known) {
    // Each difference of two products is off by 4 * 2^-53 of their magnitudes; twice that is kept.
    constexpr double kBound = 8 * 0x1p-53;
    const auto difference = [](double a, double b, double c, double d, double& error) {
        error = kBound * (std::abs(a * b) + std::abs(c * d));
        return a * b - c * d;
    };
    double w_error = 0, x_error = 0, y_error = 0;
    const double w = difference(p.dl, q.dm, p.dm, q.dl, w_error);
    const double x = difference(p.dm, q.dn, p.dn, q.dm, x_error);
    const double y = difference(p.dn, q.dl, p.dl, q.dn, y_error);
    if (!(std::abs(w) > 2 * w_error)) return known;
    // |x / w - true| <= (x_error + |x / w| w_error) / (|w| - w_error).
    const double rest = std::abs(w) - w_error;
    const auto low = [&](double v, double error, std::int32_t lo, std::int32_t hi) {
        const double at = std::floor(v / w - (error + std::abs(v / w) * w_error) / rest) - 1;
        return static_cast<std::int32_t>(std::clamp<double>(at, lo, hi));
    };
    const auto high = [&](double v, double error, std::int32_t lo, std::int32_t hi) {
        const double at = std::ceil(v / w + (error + std::abs(v / w) * w_error) / rest) + 1;
        return static_cast<std::int32_t>(std::clamp<double>(at, lo, hi));
    };
    return {low(x, x_error, known.x0, known.x1), high(x, x_error, known.x0, known.x1),
            low(y, y_error, known.y0, known.y1), high(y, y_error, known.y0, known.y1)};
}

}  // namespace sightline
