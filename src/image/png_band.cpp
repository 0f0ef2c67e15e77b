// Filters and compresses the rows of a band (PNG specification, second edition, 2003).
//
// Every row holds its difference from the row above ("Up"): rendered pictures change little from
// row to row, and of all filters this one gave the smallest files. The first row of a band holds
// the differences of its pixels ("Sub") instead, so that no band needs another.
#include "image/png_band.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace sightline {
namespace {

constexpr std::size_t kBandBytes = std::size_t{1} << 18;
constexpr std::uint8_t kSub = 1, kUp = 2;

/// out[i] = row[i] - other[i]
void subtract(const std::uint8_t* row, const std::uint8_t* other, std::size_t n,
              std::uint8_t* out) {
    for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<std::uint8_t>(row[i] - other[i]);
}

}  // namespace

std::uint32_t PngShape::rows_per_band() const {
    return static_cast<std::uint32_t>(
        std::clamp<std::size_t>(kBandBytes / bytes_per_row(), 1, height));
}

std::uint32_t PngShape::rows_of_band(std::uint32_t band) const {
    return std::min(rows_per_band(), height - band * rows_per_band());
}

std::uint32_t adler32_of(std::span<const std::uint8_t> bytes) {
    constexpr std::uint64_t kModulus = 65'521;
    // In 2^16 bytes the first sum stays below 2^25 and the second below 2^41.
    constexpr std::size_t kBlock = std::size_t{1} << 16;
    std::uint64_t first = 1, second = 0;
    while (!bytes.empty()) {
        const std::size_t n = std::min(bytes.size(), kBlock);
        std::size_t i = 0;
        for (; i + 8 <= n; i += 8) {
            std::uint64_t eight;
            std::memcpy(&eight, bytes.data() + i, sizeof eight);
            if (eight == 0) {
                second += 8 * first;
                continue;
            }
            for (std::size_t k = 0; k < 8; ++k) second += first += bytes[i + k];
        }
        for (; i < n; ++i) second += first += bytes[i];
        first %= kModulus;
        second %= kModulus;
        bytes = bytes.subspan(n);
    }
    return static_cast<std::uint32_t>(second << 16 | first);
}

PngBand PngBandEncoder::encode(std::span<const std::uint8_t> rows, const PngShape& shape) {
    const std::size_t row_bytes = shape.bytes_per_row(), pixel = shape.bytes_per_pixel;
    const std::size_t count = rows.size() / row_bytes;
    assert(count > 0 && rows.size() == count * row_bytes);
    PngBand band;
    band.decoded_size = count * (row_bytes + 1);
    filtered_.resize(band.decoded_size + kReadPast);
    for (std::size_t y = 0; y < count; ++y) {
        const std::uint8_t* row = rows.data() + y * row_bytes;
        std::uint8_t* out = filtered_.data() + y * (row_bytes + 1);
        if (y > 0) {
            *out = kUp;
            subtract(row, row - row_bytes, row_bytes, out + 1);
        } else {
            *out = kSub;
            std::copy_n(row, pixel, out + 1);
            subtract(row + pixel, row, row_bytes - pixel, out + 1 + pixel);
        }
    }
    const std::span<const std::uint8_t> decoded(filtered_.data(), band.decoded_size);
    band.adler = adler32_of(decoded);
    deflater_.append({decoded, row_bytes, pixel}, band.data);
    return band;
}

}  // namespace sightline
