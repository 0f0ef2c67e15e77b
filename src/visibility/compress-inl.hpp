// Brings chosen 32-bit lanes of a vector together. Included once for every vector width (Google
// Highway), within HWY_NAMESPACE.
//
// Where the processor has no instruction for it (AVX-512 and SVE do), the places of the lanes come
// from a table. Highway has one, too, but version 1.0.3 declares it inside of its function, where
// GCC 12 copies all of it onto the stack at each call: that took most of the geometry stage's time.
// Here the tables are static. scripts/check-hot-loops.sh sees to it that no such copy comes back.
#ifndef SIGHTLINE_COMPRESS_TABLES
#define SIGHTLINE_COMPRESS_TABLES

#include <array>
#include <cstddef>
#include <cstdint>

namespace sightline::zbuffer {

/// The numbers of the lanes that a mask chooses, in order, and then those of the others.
template <std::size_t kLanes>
constexpr std::array<std::uint32_t, kLanes> compressed_lanes(std::size_t mask) {
    std::array<std::uint32_t, kLanes> order{};
    std::size_t n = 0;
    for (const std::size_t chosen : {1, 0})
        for (std::uint32_t lane = 0; lane < kLanes; ++lane)
            if ((mask >> lane & 1) == chosen) order[n++] = lane;
    return order;
}

/// By mask: the bytes of four lanes. 256 bytes.
alignas(64) inline constexpr auto kCompressedBytes = [] {
    std::array<std::uint8_t, 16 * 16> bytes{};
    for (std::size_t mask = 0; mask < 16; ++mask)
        for (std::size_t i = 0; i < 16; ++i)
            bytes[16 * mask + i] =
                static_cast<std::uint8_t>(4 * compressed_lanes<4>(mask)[i / 4] + i % 4);
    return bytes;
}();

/// By mask: the numbers of eight lanes, four bits each. As whole numbers they would be 8 KiB, a
/// quarter of a core's nearest cache; so they are 1 KiB.
alignas(64) inline constexpr auto kCompressedNibbles = [] {
    std::array<std::uint32_t, 256> nibbles{};
    for (std::size_t mask = 0; mask < 256; ++mask)
        for (std::size_t i = 0; i < 8; ++i) nibbles[mask] |= compressed_lanes<8>(mask)[i] << 4 * i;
    return nibbles;
}();

}  // namespace sightline::zbuffer
#endif  // SIGHTLINE_COMPRESS_TABLES

#if defined(SIGHTLINE_COMPRESS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_COMPRESS_INL
#undef SIGHTLINE_COMPRESS_INL
#else
#define SIGHTLINE_COMPRESS_INL
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::zbuffer::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// The chosen lanes come first, in order. What is in the lanes behind them differs from target to
/// target.
template <class V, class Mask>
HWY_INLINE V compress(V v, Mask mask) {
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_SSSE3 || \
    HWY_TARGET == HWY_NEON
    const hn::DFromV<V> d;
    static_assert(sizeof(hn::TFromD<decltype(d)>) == 4);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, mask, bits);
#if HWY_TARGET == HWY_AVX2
    const hn::RebindToUnsigned<decltype(d)> lanes;
    const auto places =
        hn::Shr(hn::Set(lanes, kCompressedNibbles[bits[0]]), hn::ShiftLeft<2>(hn::Iota(lanes, 0)));
    // The lookup asks for numbers below 8; of what is above it takes the lowest bits.
    const auto numbers = hn::And(places, hn::Set(lanes, 7));
    return hn::TableLookupLanes(v, hn::IndicesFromVec(d, numbers));
#else
    const hn::Repartition<std::uint8_t, decltype(d)> bytes;
    const auto places = hn::Load(bytes, kCompressedBytes.data() + std::size_t{16} * bits[0]);
    return hn::BitCast(d, hn::TableLookupBytes(hn::BitCast(bytes, v), places));
#endif
#else
    return hn::Compress(v, mask);
#endif
}

/// Appends the lanes of a mask to an array that has room for a whole vector.
template <class V, class Mask, class T>
HWY_INLINE void append_lanes(V v, Mask mask, T* to) {
    const hn::DFromV<V> d;
    hn::StoreU(compress(v, mask), d, to);
}

}  // namespace
}  // namespace sightline::zbuffer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
