// How much of something a test does.
#pragma once

#include <cstdint>
#include <cstdlib>

namespace sightline::testing {

/// In the heavy runs, usually, and under the sanitizers, which take their time.
inline std::uint64_t amount(std::uint64_t full, std::uint64_t usual, std::uint64_t sanitized) {
    if (std::getenv("SIGHTLINE_FULL") != nullptr) return full;
#ifdef SIGHTLINE_SANITIZED
    static_cast<void>(usual);
    return sanitized;
#else
    static_cast<void>(sanitized);
    return usual;
#endif
}

}  // namespace sightline::testing
