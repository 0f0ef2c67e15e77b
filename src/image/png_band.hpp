// Bands of a PNG's rows, each encoded without the others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "image/deflate.hpp"

namespace sightline {

/// What the rows of a PNG are.
struct PngShape {
    std::uint32_t width = 0, height = 0;
    std::size_t bytes_per_pixel = 1;

    [[nodiscard]] std::size_t bytes_per_row() const { return bytes_per_pixel * width; }
    /// Fixed by the shape, so that the bytes of the file depend on nothing else. About 2^18 bytes a
    /// band: they fit a core's cache, and a code's description is small against them.
    [[nodiscard]] std::uint32_t rows_per_band() const;
    [[nodiscard]] std::uint32_t bands() const { return (height - 1) / rows_per_band() + 1; }
    [[nodiscard]] std::uint32_t rows_of_band(std::uint32_t band) const;
};

/// A band as it stands in the file.
struct PngBand {
    std::vector<std::uint8_t> data;  ///< pieces of the zlib stream, see Deflater
    std::uint32_t adler = 1;         ///< checksum of what they decode to
    std::size_t decoded_size = 0;
};

/// Adler-32 (RFC 1950) of bytes that are mostly 0.
[[nodiscard]] std::uint32_t adler32_of(std::span<const std::uint8_t> bytes);

/// Encodes bands. Holds scratch memory: one for each thread.
class PngBandEncoder {
public:
    /// `rows` are those of a whole band.
    [[nodiscard]] PngBand encode(std::span<const std::uint8_t> rows, const PngShape& shape);

private:
    std::vector<std::uint8_t> filtered_;
    Deflater deflater_;
};

}  // namespace sightline
