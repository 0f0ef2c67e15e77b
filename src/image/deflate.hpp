// Deflate (RFC 1951) for filtered rows of pixels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightline {

/// Filtered rows: each one filter byte and then whole pixels.
struct FilteredRows {
    std::span<const std::uint8_t> bytes;
    std::size_t bytes_per_row = 0;  ///< without the filter byte
    std::size_t bytes_per_pixel = 1;
};

/// How many bytes past the end of FilteredRows::bytes must be readable, whatever stands there.
inline constexpr std::size_t kReadPast = 8;

/// The empty last block that ends a stream.
inline constexpr std::array<std::uint8_t, 2> kLastBlock = {0x03, 0x00};

/// Turns bands of rows into pieces of a deflate stream. Holds scratch memory: one for each thread.
class Deflater {
public:
    /// Appends blocks to `out` that decode to the rows, refer to nothing before them and end on a
    /// whole byte, so that pieces made apart can be joined; the stream's last block is not among
    /// them. The bytes depend on the rows only. Precondition: rows.bytes has less than 2^31 bytes.
    void append(const FilteredRows& rows, std::vector<std::uint8_t>& out);

    /// `length` bytes that stand for themselves, or that stand `distance` bytes before, too.
    struct Token {
        std::uint16_t length, distance;  // distance 0: they stand for themselves
    };

private:
    std::vector<Token> tokens_;
    std::vector<std::uint32_t> last_;  // by hash: where a pixel with it was last seen
};

}  // namespace sightline
