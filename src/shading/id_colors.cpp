// Fibonacci hashing (D. E. Knuth, "The Art of Computer Programming" 3, section 6.4): multiplying by
// 2^24 / golden ratio spreads consecutive numbers as evenly as can be, and an odd factor is a
// bijection of 24 bits.
#include "shading/id_colors.hpp"

namespace sightline {

std::array<std::uint8_t, 3> id_color(std::uint32_t id) {
    constexpr std::uint32_t kGolden = 0x9E3779;
    static_assert(kGolden % 2 == 1);
    const std::uint32_t hash = (id + 1) * kGolden;
    const auto byte = [hash](int shift) { return static_cast<std::uint8_t>(hash >> shift & 255); };
    return {byte(16), byte(8), byte(0)};
}

}  // namespace sightline
