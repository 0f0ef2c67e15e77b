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

}  // namespace sightline
