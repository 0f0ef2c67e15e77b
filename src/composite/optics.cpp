#include "composite/optics.hpp"

#include "math/elementary.hpp"

namespace sightline {
namespace {

constexpr double kLn2 = 0.693147180559945309417, kLog2E = 1.442695040888963407360;

}  // namespace

double optical_depth(float alpha) {
    const double a = alpha;
    // 1 - a is exact as long as the last bit of a (24 of them) is no less than 2^-53. Below 2^-29
    // the first term left out, a^3 / 3, is below 2^-58 of the sum.
    constexpr double kSmall = 0x1p-29;
    if (a < kSmall) return a + a * a / 2;
    return -kLn2 * math::log2(1 - a);
}

double opacity(double depth) {
    // Above, 1 - exp(-d) loses at most 6 of 53 bits. Below, the first term left out, d^8 / 8!, is
    // below 2^-57 of the sum.
    constexpr double kSmall = 0x1p-6;
    if (depth >= kSmall) return 1 - math::exp2(-kLog2E * depth);
    double sum = 0;
    for (int n = 7; n >= 1; --n) sum = (1 - sum) * depth / n;  // d - d^2/2! + d^3/3! - ...
    return sum;
}

}  // namespace sightline
