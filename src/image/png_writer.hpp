// PNG files, row by row or band by band.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
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

/// Makes the bytes of rows first .. first + count - 1 of the picture, in `out`. Called by several
/// threads at once.
using PngRowSource =
    std::function<void(std::uint32_t first, std::uint32_t count, std::uint8_t* out)>;

/// Writes one PNG as its rows come, from the top; nothing but a few bands of them (2^18 bytes or
/// one row each) stands in memory. The file appears under its name when finish() succeeds. The
/// bytes depend on the pixels only, neither on how they are cut into calls nor on the threads.
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
    /// Appends whole rows: `rows` has a multiple of bytes_per_row() bytes. On this thread.
    Status write_rows(std::span<const std::uint8_t> rows);
    /// Appends the next `count` rows: their bands are made and compressed in parallel (threads: 0 =
    /// all cores) and written in order. A band that they begin, but do not complete, waits.
    Status write_rows(const PngRowSource& source, std::uint32_t count, int threads);
    /// Precondition: all rows are written.
    Status finish();

private:
    struct State;
    explicit PngWriter(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace sightline
