// 128-bit integers: a compiler extension of every compiler that we support.
#pragma once

#include <cstdint>

namespace sightline {

__extension__ using Int128 = __int128;

/// -1, 0 or 1.
[[nodiscard]] constexpr int sign_of(Int128 value) {
    return static_cast<int>(value > 0) - static_cast<int>(value < 0);
}

}  // namespace sightline
