// Linear light <-> 8-bit sRGB (IEC 61966-2-1:1999) through tables.
//
// The curve is evaluated only while the tables are built, by functions that give the same bits
// everywhere; a lookup compares floats and computes nothing.
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "math/elementary.hpp"
#include "sightline/image.hpp"

namespace sightline {
namespace {

/// Linear light of an sRGB value in 0..1. Good to 2^-40, against 2^-24 of a float.
double linear_of(double srgb) {
    if (srgb <= 0.04045) return srgb / 12.92;
    return math::exp2(2.4 * math::log2((srgb + 0.055) / 1.055));
}

/// Buckets of floats that share their exponent and the first 7 bits of their significand. The curve
/// rises by 255 / 2.4 / 128 < 1 step in a bucket, so a bucket holds at most one threshold, or two
/// at its ends.
constexpr int kBucketShift = 23 - 7;
/// The first threshold, 0.5/255/12.92 = 1.5e-4, lies above 2^-13: smaller values are 0.
constexpr float kFirst = 0x1p-13f;
constexpr std::uint32_t kFirstBits = std::bit_cast<std::uint32_t>(kFirst);
constexpr std::uint32_t kBuckets = 13u << 7;

struct Tables {
    /// threshold[k]: the smallest float whose sRGB value rounds to more than k; the last is never
    /// reached.
    std::array<float, 256> threshold;
    std::array<std::uint8_t, kBuckets> at_bucket;  ///< value of the smallest float of each bucket
    std::array<float, 256> linear;

    Tables() {
        for (int k = 0; k < 256; ++k) {
            const auto i = static_cast<std::size_t>(k);
            linear[i] = static_cast<float>(linear_of(k / 255.0));
            const double boundary = linear_of((k + 0.5) / 255.0);
            float above = static_cast<float>(boundary);
            if (double{above} < boundary) above = std::nextafter(above, 2.0f);
            threshold[i] = above;
        }
        std::size_t value = 0;
        for (std::uint32_t b = 0; b < kBuckets; ++b) {
            const auto least = std::bit_cast<float>(kFirstBits + (b << kBucketShift));
            while (least >= threshold[value]) ++value;
            at_bucket[b] = static_cast<std::uint8_t>(value);
        }
    }
};

const Tables& tables() {
    static const Tables kTables;
    return kTables;
}

}  // namespace

std::uint8_t to_srgb8(float linear) {
    if (!(linear >= kFirst)) return 0;  // NaN too
    if (linear >= 1.0f) return 255;
    const Tables& t = tables();
    std::size_t value =
        t.at_bucket[(std::bit_cast<std::uint32_t>(linear) - kFirstBits) >> kBucketShift];
    while (linear >= t.threshold[value]) ++value;
    return static_cast<std::uint8_t>(value);
}

float from_srgb8(std::uint8_t srgb) { return tables().linear[srgb]; }

}  // namespace sightline
