// Deep EXR files, block of rows by block of rows.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "sightline/error.hpp"
#include "sightline/image.hpp"

namespace sightline {

/// Some whole rows of a deep picture, pixel by pixel.
struct DeepRows {
    std::span<const std::uint32_t> counts;  ///< samples of each pixel
    std::span<const DeepSample> samples;    ///< of all of them, one pixel's after the other's
};

/// Writes one deep scan-line EXR as its rows come, from the top. The file appears under its name
/// when finish() succeeds. The bytes depend on the pixels only.
class DeepExrWriter {
public:
    /// Errors: io for the file; bad_option for a picture without pixels.
    [[nodiscard]] static Result<DeepExrWriter> create(const std::string& path, std::uint32_t width,
                                                      std::uint32_t height,
                                                      const Placement& placement = {});
    DeepExrWriter(DeepExrWriter&&) noexcept;
    DeepExrWriter& operator=(DeepExrWriter&&) noexcept;
    ~DeepExrWriter();

    /// Appends `count` rows. Preconditions: rows.counts has width * count entries, and their sum is
    /// the number of samples.
    Status write_rows(const DeepRows& rows, std::uint32_t count);
    /// Precondition: all rows are written.
    Status finish();

private:
    struct State;
    explicit DeepExrWriter(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace sightline
