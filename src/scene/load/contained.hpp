// Work on untrusted input in a child process, with limits on time and memory.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "sightline/error.hpp"

namespace sightline::load {

/// Whether a sanitizer watches this build: then memory is its own, in size and content.
#if defined(SIGHTLINE_SANITIZED) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kIsSanitized = true;
#else
inline constexpr bool kIsSanitized = false;
#endif

struct ChildLimits {
    double seconds = 120;                             ///< of wall-clock and of processor time
    std::size_t memory_bytes = std::size_t{8} << 30;  ///< beyond what the caller has mapped already
};

/// Memory mapped from a file that nobody else can change any more. Movable.
class MappedBytes {
public:
    MappedBytes() = default;
    MappedBytes(void* data, std::size_t size) : data_(data), size_(size) {}
    MappedBytes(MappedBytes&& other) noexcept;
    MappedBytes& operator=(MappedBytes&& other) noexcept;
    ~MappedBytes();

    [[nodiscard]] std::span<const std::byte> bytes() const {
        return {static_cast<const std::byte*>(data_), size_};
    }

private:
    void* data_ = nullptr;
    std::size_t size_ = 0;
};

/// Runs `work` in a forked child and returns the bytes that it returns there. The child dies with
/// its parent's thread, prints nothing, and changes nothing in the caller. `name` is the file in
/// messages. Errors, one line each: bad_input when the child crashed or went beyond a limit,
/// cancelled when it was interrupted, io when the system gave no process. Linux only. Signals of
/// the caller are not touched.
[[nodiscard]] Result<MappedBytes> run_contained(const std::function<std::vector<std::byte>()>& work,
                                                const ChildLimits& limits, const std::string& name);

}  // namespace sightline::load
