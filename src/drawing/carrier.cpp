#include "drawing/carrier.hpp"

#include <algorithm>
#include <cmath>

#include "math/wide_int.hpp"

namespace sightline {
namespace {

/// Bits behind the point of crossings computed in integers.
constexpr int kFraction = 20;
/// x of a crossing is a quotient of differences of two products.
static_assert(7 * kCoordBits + 2 * kDepthBits + 10 + kFraction < 511);

/// A difference of two products with a bound of its error: each product is off by three units of
/// 2^-53 of itself and the difference by one, so 4 units of both magnitudes; twice that is kept.
struct Difference {
    double value, error;
    Difference(double a, double b, double c, double d)
        : value(a * b - c * d), error(8 * 0x1p-53 * (std::abs(a * b) + std::abs(c * d))) {}
};

struct Approximate {
    double x, y;
    double error;  ///< of both; infinite when nothing is known
};

Approximate approximate_crossing(const PageLine& p, const PageLine& q) {
    const Difference w(p.dl, q.dm, p.dm, q.dl), x(p.dm, q.dn, p.dn, q.dm),
        y(p.dn, q.dl, p.dl, q.dn);
    const double rest = std::abs(w.value) - w.error;
    if (!(rest > 0)) return {0, 0, HUGE_VAL};
    const double at_x = x.value / w.value, at_y = y.value / w.value;
    const auto bound = [&](const Difference& v, double at) {
        return (v.error + std::abs(at) * w.error) / rest + 0x1p-52 * std::abs(at);
    };
    return {at_x, at_y, std::max(bound(x, at_x), bound(y, at_y))};
}

/// Crossing times 2^kFraction, rounded down.
struct ExactCrossing {
    std::int64_t x, y;
};

std::int64_t floor_quotient(const Int512& numerator, const Int512& denominator) {
    Int512 quotient = numerator / denominator;  // towards 0
    if (quotient * denominator != numerator && (numerator < 0) != (denominator < 0)) --quotient;
    return static_cast<std::int64_t>(quotient);
}

ExactCrossing exact_crossing(const PageLine& p, const PageLine& q) {
    const Int512 pl(p.l), pm(p.m), pn(p.n), ql(q.l), qm(q.m), qn(q.n);
    const Int512 w = pl * qm - pm * ql;
    return {floor_quotient((pm * qn - pn * qm) << kFraction, w),
            floor_quotient((pn * ql - pl * qn) << kFraction, w)};
}

/// Of the depth of a plane where two lines cross, the numerator is a product of a crossing's and a
/// factor of the plane, and so is the denominator.
static_assert(8 * kCoordBits + 3 * kDepthBits + 20 < 511);

double exact_depth(const PageLine& p, const PageLine& q, const Plane& plane) {
    const Int512 pl(p.l), pm(p.m), pn(p.n), ql(q.l), qm(q.m), qn(q.n);
    const Int512 w = pl * qm - pm * ql, x = pm * qn - pn * qm, y = pn * ql - pl * qn;
    const Int512 depth = Int512(plane.c) * plane.at.z * w + Int512(plane.a) * (x - w * plane.at.x) +
                         Int512(plane.b) * (y - w * plane.at.y);
    const Int512 unit = Int512(plane.c) * w;
    return static_cast<double>(floor_quotient(2 * depth + unit, 2 * unit));
}

}  // namespace

int growth(const PageLine& carrier, const PageLine& b) {
    const Difference d(b.dl, carrier.dm, b.dm, carrier.dl);
    if (std::abs(d.value) > d.error) return d.value < 0 ? -1 : 1;
    return (Int512(b.l) * Int512(carrier.m) - Int512(b.m) * Int512(carrier.l)).sign();
}

int sign_of_parallel(const PageLine& carrier, const PageLine& across, const PageLine& parallel) {
    // sign_at_crossing() is right where its first two lines turn clockwise, else the opposite is.
    return -sign_at_crossing(carrier, across, parallel) * growth(carrier, across);
}

ConvexSides sides_of(const ScreenPoint& p, const ScreenPoint& q, const ScreenPoint& r) {
    ConvexSides sides;
    sides.side[0] = line_through(p, q);
    sides.side[1] = line_through(q, r);
    sides.side[2] = line_through(r, p);
    return sides;
}

std::optional<Stretch> inside(const PageLine& carrier, CarrierSide beside, const Stretch& stretch,
                              const ConvexSides& polygon) {
    Stretch rest = stretch;
    for (const PageLine& side : polygon.all()) {
        const Place place{&side, growth(carrier, side), nullptr};
        if (place.growth > 0) {
            if (compare(carrier, rest.from, place) < 0) rest.from = place;
        } else if (place.growth < 0) {
            if (compare(carrier, rest.to, place) > 0) rest.to = place;
        } else {
            const int sign = sign_of_parallel(carrier, *stretch.from.line, side);
            if (sign < 0) return std::nullopt;
            // The carrier runs along the side: the inside is where that is positive.
            const bool same_way = carrier.dl * side.dl + carrier.dm * side.dm > 0;
            if (sign == 0 && same_way != (beside == CarrierSide::right)) return std::nullopt;
            continue;
        }
        if (compare(carrier, rest.from, rest.to) >= 0) return std::nullopt;
    }
    return rest;
}

std::optional<Stretch> chord(const PageLine& carrier, std::span<const PageLine, 3> triangle) {
    Stretch stretch;
    for (const PageLine& side : triangle) {
        const Place place{&side, growth(carrier, side), nullptr};
        Place& end = place.growth > 0 ? stretch.from : stretch.to;
        if (place.growth == 0) continue;
        if (end.line == nullptr || compare(carrier, end, place) * place.growth < 0) end = place;
    }
    // A triangle has sides that face both ways along any line.
    for (const PageLine& side : triangle)
        if (growth(carrier, side) == 0 && sign_of_parallel(carrier, *stretch.from.line, side) <= 0)
            return std::nullopt;
    if (compare(carrier, stretch.from, stretch.to) >= 0) return std::nullopt;
    return stretch;
}

glm::dvec2 crossing_of(const PageLine& p, const PageLine& q) {
    const Approximate at = approximate_crossing(p, q);
    if (at.error < 0x1p-16) return {at.x, at.y};
    const ExactCrossing exact = exact_crossing(p, q);
    return {std::ldexp(static_cast<double>(exact.x), -kFraction),
            std::ldexp(static_cast<double>(exact.y), -kFraction)};
}

glm::ivec2 rounded_crossing_of(const PageLine& p, const PageLine& q) {
    const Approximate at = approximate_crossing(p, q);
    const auto is_clear = [&](double v) {
        return std::floor(v + 0.5 - at.error) == std::floor(v + 0.5 + at.error);
    };
    if (at.error < 0.25 && is_clear(at.x) && is_clear(at.y))
        return {static_cast<int>(std::floor(at.x + 0.5)), static_cast<int>(std::floor(at.y + 0.5))};
    const ExactCrossing exact = exact_crossing(p, q);
    const auto round = [](std::int64_t v) {
        return static_cast<int>((v + (std::int64_t{1} << (kFraction - 1))) >> kFraction);
    };
    return {round(exact.x), round(exact.y)};
}

std::int32_t rounded_depth_at_crossing(const PageLine& p, const PageLine& q, const Plane& plane) {
    const Approximate at = approximate_crossing(p, q);
    const double c = static_cast<double>(plane.c), gx = static_cast<double>(plane.a) / c,
                 gy = static_cast<double>(plane.b) / c;
    const double x = gx * (at.x - plane.at.x), y = gy * (at.y - plane.at.y);
    const double z = plane.at.z + (x + y) + 0.5;
    // A gradient is off by 3 * 2^-53 of itself, a term by 2 more, and the sums by 3 of all.
    const double error = (std::abs(gx) + std::abs(gy)) * at.error * 1.0001 +
                         16 * 0x1p-53 * (std::abs(x) + std::abs(y) + plane.at.z + 1);
    double rounded = std::floor(z - error);
    if (!(at.error < 0.25) || rounded != std::floor(z + error)) rounded = exact_depth(p, q, plane);
    return static_cast<std::int32_t>(std::clamp<double>(rounded, 0, kDepthMax));
}

}  // namespace sightline
