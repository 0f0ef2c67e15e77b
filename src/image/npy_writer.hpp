// NumPy .npy files, part by part.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "image/atomic_file.hpp"
#include "sightline/error.hpp"

namespace sightline {

/// Writes one array of version 1.0 in C order as its bytes come. The file appears under its name
/// when finish() succeeds.
class NpyWriter {
public:
    /// `type` is NumPy's name of the element ("<f4"), `channels` the length of a third axis, or 0
    /// for an array of two.
    [[nodiscard]] static Result<NpyWriter> create(const std::string& path, std::uint32_t width,
                                                  std::uint32_t height, std::uint32_t channels,
                                                  std::string_view type);
    /// Appends bytes of the array, little-endian.
    Status write(std::span<const std::byte> bytes);
    /// Precondition: all bytes are written.
    Status finish();

private:
    explicit NpyWriter(AtomicFile file) : file_(std::move(file)) {}
    AtomicFile file_;
};

}  // namespace sightline
