// Which of many things may be there twice? A bitmap over their hash values (B. Bloom, "Space/Time
// Trade-offs in Hash Coding with Allowable Errors", 1970, with one hash function), which answers
// for most of them without a look at the others.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sightline {

/// The finalizer of MurmurHash3 (Austin Appleby, public domain): every bit of the result depends on
/// every bit of the value.
[[nodiscard]] inline std::uint64_t mixed(std::uint64_t value) {
    value = (value ^ value >> 33) * 0xff51afd7ed558ccdull;
    value = (value ^ value >> 33) * 0xc4ceb9fe1a85ec53ull;
    return value ^ value >> 33;
}

/// Answers that are "no" are right; one "yes" in about kBitsPerItem is wrong.
class SeenFilter {
public:
    explicit SeenFilter(std::size_t items)
        : mask_(std::bit_ceil(kBitsPerItem * (items + 8)) - 1), bits_((mask_ + 1) / 64) {}

    /// Whether it was there already.
    bool add(std::uint64_t hash) {
        const bool was_there = has(hash);
        bits_[(hash & mask_) / 64] |= std::uint64_t{1} << (hash & 63);
        return was_there;
    }
    [[nodiscard]] bool has(std::uint64_t hash) const {
        return (bits_[(hash & mask_) / 64] >> (hash & 63) & 1) != 0;
    }
    /// Asks the processor to have its place at hand soon.
    void fetch(std::uint64_t hash) const { __builtin_prefetch(&bits_[(hash & mask_) / 64]); }

private:
    static constexpr std::size_t kBitsPerItem = 8;

    std::uint64_t mask_;
    std::vector<std::uint64_t> bits_;
};

}  // namespace sightline
