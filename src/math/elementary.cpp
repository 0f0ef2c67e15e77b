// Elementary functions from Taylor series on short intervals, reached by exact reduction.
//
// The splitting of an argument into a double and its rounding error follows W. J. Cody and
// W. Waite, "Software Manual for the Elementary Functions", 1980, and T. J. Dekker, "A
// floating-point technique for extending the available precision", 1971. We differ from the usual
// libraries in taking plain Taylor coefficients instead of minimax ones: two terms more buy bounds
// that can be checked by hand. Here u = 2^-53, half a unit in the last place relative to the value.
#include "math/elementary.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace sightline::math {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// c[0] + c[1] x + c[2] x^2 + ... by Horner's rule.
template <std::size_t N>
double polynomial(const std::array<double, N>& c, double x) {
    double sum = c[N - 1];
    for (std::size_t i = N - 1; i > 0; --i) sum = sum * x + c[i - 1];
    return sum;
}

/// A number as the unevaluated sum of a double and a much smaller one.
struct Pair {
    double high, low;
};

/// The exact product a * b, unless it over- or underflows (Dekker 1971).
Pair exact_product(double a, double b) {
    constexpr double kSplit = 134217729.0;  // 2^27 + 1 halves a significand of 53 bits
    const double ta = kSplit * a, tb = kSplit * b;
    const double a1 = ta - (ta - a), a2 = a - a1;
    const double b1 = tb - (tb - b), b2 = b - b1;
    const double product = a * b;
    return {product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2};
}

// pi / 180 to 106 bits.
constexpr double kRadiansHigh = 0x1.1df46a2529d39p-6;
constexpr double kRadiansLow = 0x1.5c1d8becdd291p-62;

Pair radians(double degrees) {
    const Pair p = exact_product(degrees, kRadiansHigh);
    return {p.high, p.low + degrees * kRadiansLow};
}

/// sin(x + tail) for |x| <= pi/4, |tail| <= u |x|. The first term left out is x^19/19!, relative to
/// sin x at most (pi/4)^18/19!/0.9 < 1.2e-19 = 0.002 u. The terms behind x are below 0.1 x and
/// carry a few u each, so the last addition dominates: below 0.8 ulp.
double sin_series(Pair x) {
    constexpr std::array<double, 8> kCoefficients = {
        -1.0 / 6,          1.0 / 120,          -1.0 / 5040,         1.0 / 362880,
        -1.0 / 39916800.0, 1.0 / 6227020800.0, -1.0 / 1307674368e3, 1.0 / 355687428096e3};
    const double z = x.high * x.high;
    const double rest = x.high * z * polynomial(kCoefficients, z);
    return x.high + (rest + x.low * (1.0 - 0.5 * z));
}

/// cos(x + tail), same range. The first term left out is x^18/18! < 2.1e-18 < 0.03 u of cos x. The
/// leading 1 - z/2 is taken as an exact sum of two doubles: below 0.8 ulp.
double cos_series(Pair x) {
    constexpr std::array<double, 7> kCoefficients = {
        1.0 / 24,          -1.0 / 720,           1.0 / 40320,        -1.0 / 3628800,
        1.0 / 479001600.0, -1.0 / 87178291200.0, 1.0 / 20922789888e3};
    const double z = x.high * x.high;
    const double half = 0.5 * z;
    const double lead = 1.0 - half;
    const double lost = (1.0 - lead) - half;
    return lead + (lost + (z * z * polynomial(kCoefficients, z) - x.high * x.low));
}

/// An angle as a quarter turn 0..3 and a rest in [-45, 45] degrees.
struct Reduced {
    int quarter = 0;
    double rest = 0;
};

/// Exact: fmod is, 90 q is, and the difference is a multiple of the last place of the angle that is
/// not larger than the angle.
Reduced reduce(double degrees) {
    const double turn = std::fmod(degrees, 360.0);
    const double q = std::floor(turn / 90.0 + 0.5);
    return {static_cast<int>(q) & 3, turn - 90.0 * q};
}

double sin_rest(double rest) {
    if (rest == 30.0) return 0.5;
    if (rest == -30.0) return -0.5;
    // Below this degrees * pi/180 is the sine, and the exact product would underflow.
    if (std::fabs(rest) < 0x1p-500) return rest * kRadiansHigh;
    return sin_series(radians(rest));
}

double cos_rest(double rest) {
    if (std::fabs(rest) < 0x1p-500) return 1.0;
    return cos_series(radians(rest));
}

}  // namespace

double sin_degrees(double degrees) {
    if (!std::isfinite(degrees)) return kNaN;
    const Reduced angle = reduce(degrees);
    const double value = (angle.quarter & 1) != 0 ? cos_rest(angle.rest) : sin_rest(angle.rest);
    return (angle.quarter & 2) != 0 ? 0.0 - value : value;
}

double cos_degrees(double degrees) {
    if (!std::isfinite(degrees)) return kNaN;
    const Reduced angle = reduce(degrees);
    const double value = (angle.quarter & 1) != 0 ? sin_rest(angle.rest) : cos_rest(angle.rest);
    return angle.quarter == 1 || angle.quarter == 2 ? 0.0 - value : value;
}

/// Two errors below 0.8 ulp (at most twice that relative to a quotient) and a division: 3 ulp.
double tan_degrees(double degrees) {
    if (!std::isfinite(degrees)) return kNaN;
    const Reduced angle = reduce(degrees);
    const bool odd = (angle.quarter & 1) != 0;  // tan(90 + r) = -1 / tan r
    if (std::fabs(angle.rest) == 45.0) return (angle.rest > 0) != odd ? 1.0 : -1.0;
    const double sine = sin_rest(angle.rest), cosine = cos_rest(angle.rest);
    if (!odd) return sine / cosine;
    if (angle.rest == 0.0) return angle.quarter == 1 ? kInfinity : -kInfinity;
    return 0.0 - cosine / sine;
}

/// From acos c = 2 atan t with t = sqrt((1 - c) / (1 + c)), which has no cancellation for c >= 0,
/// and atan t = atan(k/8) + atan v, v = (t - k/8) / (1 + t k/8), |v| <= 1/16. The series left out
/// begins with v^15/15, relative to v at most 2^-56/15 < 0.01 u.
double acos_degrees(double cosine) {
    if (!(cosine >= -1.0 && cosine <= 1.0)) return kNaN;
    if (cosine < 0) return 180.0 - acos_degrees(-cosine);
    if (cosine == 0.5) return 60.0;
    constexpr std::array<double, 9> kArctangents = {// of k/8, in degrees
                                                    0.0,
                                                    0x1.c80044927fe83p+2,
                                                    0x1.c128e80fae02ep+3,
                                                    0x1.48e58fac13547p+4,
                                                    0x1.a90a731a61dc4p+4,
                                                    0x1.000b0659f5545p+5,
                                                    0x1.26f58ce59e23cp+5,
                                                    0x1.497cc65551cf8p+5,
                                                    45.0};
    constexpr std::array<double, 7> kCoefficients = {1.0,     -1.0 / 3,  1.0 / 5, -1.0 / 7,
                                                     1.0 / 9, -1.0 / 11, 1.0 / 13};
    constexpr double kDegrees = 0x1.ca5dc1a63c1f8p+5;  // 180 / pi
    const double t = std::sqrt((1.0 - cosine) / (1.0 + cosine));
    const auto k = static_cast<std::size_t>(t * 8.0 + 0.5);
    const double node = static_cast<double>(k) / 8.0;
    const double v = (t - node) / (1.0 + t * node);
    return 2.0 * (kArctangents[k] + kDegrees * (v * polynomial(kCoefficients, v * v)));
}

/// x = 2^e m with m in [sqrt 1/2, sqrt 2), and ln m = 2 s (1 + s^2/3 + s^4/5 + ...) with
/// s = (m - 1)/(m + 1), |s| < 0.1716. The series left out begins with s^22/23 < 6.1e-19 = 0.006 u.
/// Rounding: m + 1, the quotient, the sum and two products, below 2.5 ulp of log2 m; adding e can
/// cancel at most one bit (|e + log2 m| >= 1/2 = |log2 m| at worst).
double log2(double x) {
    if (std::isnan(x) || x < 0) return kNaN;
    if (x == 0) return -kInfinity;
    if (x == kInfinity) return x;
    double e = 0;
    if (x < std::numeric_limits<double>::min()) {
        x *= 0x1p54;
        e = -54;
    }
    constexpr std::uint64_t kSignificand = (std::uint64_t{1} << 52) - 1;
    constexpr std::uint64_t kOne = std::uint64_t{1023} << 52;
    const auto bits = std::bit_cast<std::uint64_t>(x);
    e += static_cast<double>(bits >> 52) - 1023.0;
    double m = std::bit_cast<double>((bits & kSignificand) | kOne);
    if (m >= 0x1.6a09e667f3bcdp+0) {  // sqrt 2
        m *= 0.5;
        e += 1;
    }
    constexpr std::array<double, 11> kCoefficients = {1.0,      1.0 / 3,  1.0 / 5,  1.0 / 7,
                                                      1.0 / 9,  1.0 / 11, 1.0 / 13, 1.0 / 15,
                                                      1.0 / 17, 1.0 / 19, 1.0 / 21};
    constexpr double kTwoOverLn2 = 0x1.71547652b82fep+1;
    const double s = (m - 1.0) / (m + 1.0);
    return e + kTwoOverLn2 * (s * polynomial(kCoefficients, s * s));
}

/// x = n + f with |f| <= 1/2 (exact), 2^f = exp(f ln 2), |f ln 2| < 0.3466. The series left out
/// begins with 0.3466^14/14! < 4.2e-18 < 0.04 u. The argument's rounding costs 0.7 u, the sum
/// behind the leading 1 less than 0.5 u, the last addition 1 u at most: below 2 ulp.
double exp2(double x) {
    if (std::isnan(x)) return x;
    if (x >= 1024) return kInfinity;
    if (x < -1080) return 0.0;  // below half of the smallest double, 2^-1074
    constexpr std::array<double, 13> kCoefficients = {1.0,
                                                      1.0 / 2,
                                                      1.0 / 6,
                                                      1.0 / 24,
                                                      1.0 / 120,
                                                      1.0 / 720,
                                                      1.0 / 5040,
                                                      1.0 / 40320,
                                                      1.0 / 362880,
                                                      1.0 / 3628800,
                                                      1.0 / 39916800.0,
                                                      1.0 / 479001600.0,
                                                      1.0 / 6227020800.0};
    constexpr double kLn2 = 0x1.62e42fefa39efp-1;
    const double n = std::floor(x + 0.5);
    const double t = (x - n) * kLn2;
    const double value = 1.0 + t * polynomial(kCoefficients, t);
    // Two factors, each a normal double, so that only the last product can underflow, once.
    const int first = static_cast<int>(n) / 2, second = static_cast<int>(n) - first;
    const auto power = [](int k) {
        return std::bit_cast<double>(static_cast<std::uint64_t>(k + 1023) << 52);
    };
    return value * power(first) * power(second);
}

/// Whole exponents, the usual ones of highlights, by repeated squaring: n - 1 factors joined by as
/// many roundings at most, so within n 2^-53 <= 2^-43. Others: a float of at least 2^-149 needs
/// |exponent * log2 base| <= 150; with 4 ulp of log2 and the product's rounding the exponent of 2
/// is wrong by at most 150 * 5 * 2^-52 < 2^-42.
float pow_positive(float base, float exponent) {
    if (exponent == 0.0f || base == 1.0f) return 1.0f;
    if (base == 0.0f) return 0.0f;
    constexpr float kMostSquared = 1024.0f;
    if (exponent <= kMostSquared && exponent == std::floor(exponent)) {
        double factor = base, product = 1.0;
        for (auto n = static_cast<unsigned>(exponent); n != 0; n >>= 1) {
            if ((n & 1) != 0) product *= factor;
            factor *= factor;
        }
        return static_cast<float>(product);
    }
    return static_cast<float>(exp2(double{exponent} * log2(double{base})));
}

}  // namespace sightline::math
