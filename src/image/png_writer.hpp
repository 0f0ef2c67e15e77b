// PNG files, row by row.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "sightline/error.hpp"

namespace sightline {

enum class PngLayout {
    grey8,   ///< 1 byte a pixel
    grey16,  ///< 2 bytes a pixel, the higher one first
    rgb8,    ///< 3 bytes a pixel
    rgba8,   ///< 4 bytes a pixel, straight alpha
};

enum class PngContent {
    color,  ///< a picture in sRGB: says so in the file
    data,   ///< numbers: no statement on colour
};

/// Writes one PNG as its rows come, from the top; nothing but a buffer stands in memory. The file
/// appears under its name when finish() succeeds. The bytes depend on the pixels only, not on how
/// they are cut into calls.
class PngWriter {
public:
    /// Errors: io for the file; bad_option for a picture without pixels or beyond PNG's limits.
    [[nodiscard]] static Result<PngWriter> create(const std::string& path, std::uint32_t width,
                                                  std::uint32_t height, PngLayout layout,
                                                  PngContent content);
    PngWriter(PngWriter&&) noexcept;
    PngWriter& operator=(PngWriter&&) noexcept;
    ~PngWriter();

    [[nodiscard]] std::size_t bytes_per_row() const;
    /// Appends whole rows: `rows` has a multiple of bytes_per_row() bytes.
    Status write_rows(std::span<const std::uint8_t> rows);
    /// Precondition: all rows are written.
    Status finish();

private:
    struct State;
    explicit PngWriter(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace sightline
