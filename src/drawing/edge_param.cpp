#include "drawing/edge_param.hpp"

#include "math/wide_int.hpp"

namespace sightline {
namespace {

static_assert(4 * kCoordBits + 2 * kDepthBits + 5 <= 255);

constexpr Int128 kLineBits = Int128{1} << (2 * kCoordBits + 2);

/// floor(from + num / den * (to - from) + 1/2). 2b + Z + 3 bits and those of a coordinate.
static_assert(2 * kCoordBits + 2 * kDepthBits + 6 <= 127);
std::int32_t rounded(std::int32_t from, std::int32_t to, const EdgeParam& t) {
    const Int128 doubled = 2 * t.num * (std::int64_t{to} - from) + t.den;
    const Int128 unit = 2 * t.den;
    Int128 quotient = doubled / unit;
    if (quotient * unit > doubled) --quotient;
    return from + static_cast<std::int32_t>(quotient);
}

}  // namespace

int compare_exactly(const EdgeParam& s, const EdgeParam& t) {
    if (s.den < kLineBits || t.den < kLineBits) return sign_of(s.num * t.den - t.num * s.den);
    return (Int256(s.num) * Int256(t.den) - Int256(t.num) * Int256(s.den)).sign();
}

ScreenPoint point_at(const ScreenPoint& p, const ScreenPoint& q, const EdgeParam& t) {
    return {rounded(p.x, q.x, t), rounded(p.y, q.y, t), rounded(p.z, q.z, t)};
}

}  // namespace sightline
