// Our elementary functions against the C library's in long double, where they must be exact, and
// the sameness of their bits.
#include "math/elementary.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace {

using namespace sightline;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr long double kPi = 3.14159265358979323846264338327950288L;

/// Distance of a double from the true value, in units in the last place of the true value.
double ulps(double got, long double truth) {
    if (truth == 0) return got == 0 ? 0 : kInfinity;
    const int exponent = std::max(std::ilogb(truth), -1022);
    return static_cast<double>(std::fabs(got - truth) / std::ldexp(1.0L, exponent - 52));
}

/// Largest distance over `count` samples spread evenly over lo..hi.
template <class Ours, class Truth>
double worst(double lo, double hi, int count, Ours ours, Truth truth) {
    double most = 0;
    for (int i = 0; i <= count; ++i) {
        const double x = lo + (hi - lo) * i / count;
        most = std::fmax(most, ulps(ours(x), truth(x)));
    }
    return most;
}

// The truth near the zeros needs an angle that is measured from them.
long double true_sine(double degrees) {
    const long double x = degrees;
    if (x > 90) return std::sin((180 - x) * kPi / 180);
    if (x < -90) return std::sin((-180 - x) * kPi / 180);
    return std::sin(x * kPi / 180);
}
long double true_cosine(double degrees) {
    return std::sin((90 - std::fabs(static_cast<long double>(degrees))) * kPi / 180);
}

TEST(Elementary, SineAndCosineAreWithinOneUlp) {
    EXPECT_LE(worst(-180, 180, 200'003, math::sin_degrees, true_sine), 1.0);
    EXPECT_LE(worst(-180, 180, 200'003, math::cos_degrees, true_cosine), 1.0);
    EXPECT_LE(worst(-1e-9, 1e-9, 1'001, math::sin_degrees, true_sine), 1.0);
}

TEST(Elementary, TangentIsWithinThreeUlp) {
    const auto truth = [](double x) { return true_sine(x) / true_cosine(x); };
    EXPECT_LE(worst(-89.9, 89.9, 200'003, math::tan_degrees, truth), 3.0);
}

TEST(Elementary, ArcCosineIsWithinFourUlp) {
    const auto truth = [](double x) {
        const long double c = x;
        return 2 * std::atan2(std::sqrt(1 - c), std::sqrt(1 + c)) * 180 / kPi;
    };
    EXPECT_LE(worst(-1, 1, 200'003, math::acos_degrees, truth), 4.0);
    EXPECT_LE(worst(1 - 1e-9, 1, 1'001, math::acos_degrees, truth), 4.0);
}

TEST(Elementary, LogarithmAndPowerOfTwoAreClose) {
    const auto log_truth = [](double x) { return std::log2(static_cast<long double>(x)); };
    const auto exp_truth = [](double x) { return std::exp2(static_cast<long double>(x)); };
    EXPECT_LE(worst(1e-6, 4, 200'003, math::log2, log_truth), 4.0);
    EXPECT_LE(worst(0.999, 1.001, 20'003, math::log2, log_truth), 4.0);
    EXPECT_LE(worst(1e-310, 2e-308, 2'003, math::log2, log_truth), 4.0);
    EXPECT_LE(worst(-1022, 1023.9, 200'003, math::exp2, exp_truth), 2.0);
    EXPECT_LE(worst(-1, 1, 200'003, math::exp2, exp_truth), 2.0);
    EXPECT_LE(worst(-1074, -1022, 5'003, math::exp2, exp_truth), 2.0);
}

TEST(Elementary, AnglesAreExactWhereTheTrueValueIs) {
    for (int turn = -3; turn <= 3; ++turn) {
        const double t = 360.0 * turn;
        EXPECT_EQ(math::sin_degrees(t), 0);
        EXPECT_EQ(math::sin_degrees(t + 30), 0.5);
        EXPECT_EQ(math::sin_degrees(t + 90), 1);
        EXPECT_EQ(math::sin_degrees(t + 150), 0.5);
        EXPECT_EQ(math::sin_degrees(t + 180), 0);
        EXPECT_EQ(math::sin_degrees(t + 210), -0.5);
        EXPECT_EQ(math::sin_degrees(t + 270), -1);
        EXPECT_EQ(math::sin_degrees(t + 330), -0.5);
        EXPECT_EQ(math::cos_degrees(t), 1);
        EXPECT_EQ(math::cos_degrees(t + 60), 0.5);
        EXPECT_EQ(math::cos_degrees(t + 90), 0);
        EXPECT_EQ(math::cos_degrees(t + 120), -0.5);
        EXPECT_EQ(math::cos_degrees(t + 180), -1);
        EXPECT_EQ(math::cos_degrees(t + 240), -0.5);
        EXPECT_EQ(math::cos_degrees(t + 270), 0);
        EXPECT_EQ(math::cos_degrees(t + 300), 0.5);
        EXPECT_EQ(math::tan_degrees(t), 0);
        EXPECT_EQ(math::tan_degrees(t + 45), 1);
        EXPECT_EQ(math::tan_degrees(t + 90), kInfinity);
        EXPECT_EQ(math::tan_degrees(t + 135), -1);
        EXPECT_EQ(math::tan_degrees(t + 180), 0);
        EXPECT_EQ(math::tan_degrees(t + 225), 1);
        EXPECT_EQ(math::tan_degrees(t + 270), -kInfinity);
        EXPECT_EQ(math::tan_degrees(t + 315), -1);
    }
    EXPECT_EQ(math::acos_degrees(-1), 180);
    EXPECT_EQ(math::acos_degrees(-0.5), 120);
    EXPECT_EQ(math::acos_degrees(0), 90);
    EXPECT_EQ(math::acos_degrees(0.5), 60);
    EXPECT_EQ(math::acos_degrees(1), 0);
}

TEST(Elementary, HugeAndTinyAnglesAreReducedExactly) {
    // 2^200 mod 360 = 256 (2^k mod 45 has period 12, and 2^200 = 8 * 2^197 with 2^197 = 2^5 mod
    // 45).
    EXPECT_EQ(math::sin_degrees(0x1p200), math::sin_degrees(256));
    EXPECT_EQ(math::cos_degrees(-0x1p200), math::cos_degrees(256));
    EXPECT_GT(math::sin_degrees(1e-300), 0);
    EXPECT_EQ(math::sin_degrees(std::numeric_limits<double>::denorm_min()), 0);
    EXPECT_EQ(math::cos_degrees(1e-300), 1);
}

TEST(Elementary, WholePowersOfTwoAreExact) {
    for (int n = -1074; n <= 1023; ++n) {
        EXPECT_EQ(math::exp2(n), std::ldexp(1.0, n)) << n;
        EXPECT_EQ(math::log2(std::ldexp(1.0, n)), n) << n;
    }
}

TEST(Elementary, SpecialArguments) {
    for (const double bad : {kInfinity, -kInfinity, kNaN}) {
        EXPECT_TRUE(std::isnan(math::sin_degrees(bad)));
        EXPECT_TRUE(std::isnan(math::cos_degrees(bad)));
        EXPECT_TRUE(std::isnan(math::tan_degrees(bad)));
        EXPECT_TRUE(std::isnan(math::acos_degrees(bad)));
    }
    EXPECT_TRUE(std::isnan(math::acos_degrees(std::nextafter(1.0, 2.0))));
    EXPECT_EQ(math::log2(0), -kInfinity);
    EXPECT_EQ(math::log2(kInfinity), kInfinity);
    EXPECT_TRUE(std::isnan(math::log2(-1)));
    EXPECT_TRUE(std::isnan(math::log2(kNaN)));
    EXPECT_EQ(math::exp2(1024), kInfinity);
    EXPECT_EQ(math::exp2(-1075.5), 0);
    EXPECT_EQ(math::exp2(-kInfinity), 0);
    EXPECT_TRUE(std::isnan(math::exp2(kNaN)));
}

TEST(Elementary, PowerIsTheNearestFloat) {
    for (int i = 0; i <= 4'000; ++i) {
        for (const float exponent : {0.25f, 1.0f, 2.0f, 7.5f, 32.0f, 99.5f, 1000.0f, 5000.0f}) {
            const float base = static_cast<float>(i) / 4'000.0f;
            const auto truth = static_cast<float>(
                std::pow(static_cast<long double>(base), static_cast<long double>(exponent)));
            const float got = math::pow_positive(base, exponent);
            ASSERT_LE(std::fabs(got - truth), std::nextafter(truth, 2.0f) - truth)
                << base << "^" << exponent;
        }
    }
    EXPECT_EQ(math::pow_positive(0, 0), 1);
    EXPECT_EQ(math::pow_positive(0, 3), 0);
    EXPECT_EQ(math::pow_positive(1, 1e30f), 1);
    EXPECT_EQ(math::pow_positive(0.5f, 1e30f), 0);
}

// The same bits on every machine: one hash of 80,000 results, pinned.
TEST(Elementary, BitsAreTheSameOnEveryMachine) {
    std::uint64_t hash = 14695981039346656037u;  // FNV-1a (Fowler, Noll, Vo)
    const auto add = [&hash](double value) {
        const auto bits = std::bit_cast<std::uint64_t>(value);
        for (int shift = 0; shift < 64; shift += 8) {
            hash = (hash ^ (bits >> shift & 255)) * 1099511628211u;
        }
    };
    for (int i = 0; i < 10'000; ++i) {
        const double x = i * 0.0731 - 365.0;
        add(math::sin_degrees(x));
        add(math::cos_degrees(x));
        add(math::tan_degrees(x));
        add(math::acos_degrees(i / 5'000.0 - 1.0));
        add(math::log2(i * 0.37 + 1e-3));
        add(math::exp2(x * 2.5));
        add(math::pow_positive(static_cast<float>(i) / 10'000.0f, 32.0f));
        add(math::pow_positive(static_cast<float>(i) / 10'000.0f, 12.3f));
    }
    EXPECT_EQ(hash, 3099163115261610831u);
}

}  // namespace
