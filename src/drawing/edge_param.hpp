// Where along an edge: exact fractions of its length, compared without rounding.
#pragma once

#include <cstdint>

#include "math/int128.hpp"
#include "math/predicates.hpp"

namespace sightline {

/// A fraction num / den of the way from one end of an edge to the other; 0 <= num <= den, den > 0.
/// Of a crossing with a line of the page both have up to 2b + 1 bits, with a plane 2b + Z + 2.
struct EdgeParam {
    Int128 num = 0, den = 1;
    double value = 0;  ///< num / den, off by at most 4 * 2^-53

    EdgeParam() = default;
    EdgeParam(Int128 num_, Int128 den_)
        : num(num_), den(den_), value(static_cast<double>(num_) / static_cast<double>(den_)) {}
    EdgeParam(std::int64_t num_, std::int64_t den_)  // the conversion to double is one instruction
        : num(num_), den(den_), value(static_cast<double>(num_) / static_cast<double>(den_)) {}
    static EdgeParam start() { return {std::int64_t{0}, std::int64_t{1}}; }
    static EdgeParam end() { return {std::int64_t{1}, std::int64_t{1}}; }

    /// Where a linear function that is `at_start` and `at_end`, of opposite signs, has its zero.
    template <class T>
    static EdgeParam of_zero(T at_start, T at_end) {
        if (at_start < 0) return {-at_start, at_end - at_start};
        return {at_start, at_start - at_end};
    }
};

/// Two fractions that both come from lines have a product of 4b + 3 bits, one of each kind
/// 4b + Z + 5: they fit. Two of planes need 256 bits.
static_assert(4 * kCoordBits + kDepthBits + 5 <= 127);

[[nodiscard]] int compare_exactly(const EdgeParam& s, const EdgeParam& t);

/// Sign of s - t: a filter in double precision, then integers.
[[nodiscard]] inline int compare(const EdgeParam& s, const EdgeParam& t) {
    // Values lie in 0..1 and are each off by at most 4 * 2^-53.
    constexpr double kBound = 10 * 0x1p-53;
    const double difference = s.value - t.value;
    if (difference > kBound) return 1;
    if (difference < -kBound) return -1;
    if (s.num == t.num && s.den == t.den) return 0;
    return compare_exactly(s, t);
}
[[nodiscard]] inline bool operator<(const EdgeParam& s, const EdgeParam& t) {
    return compare(s, t) < 0;
}
[[nodiscard]] inline bool operator==(const EdgeParam& s, const EdgeParam& t) {
    return compare(s, t) == 0;
}

/// The point of the edge p -> q at a fraction of its length, rounded to the grid. Half a step
/// goes up, so that the direction of the edge and what crosses it do not matter.
[[nodiscard]] ScreenPoint point_at(const ScreenPoint& p, const ScreenPoint& q, const EdgeParam& t);

}  // namespace sightline
