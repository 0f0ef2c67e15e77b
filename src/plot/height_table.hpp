// What the readers of height maps hand over: the numbers as they stand in the file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sightline/error.hpp"

namespace sightline::heights {

/// 2 GiB of doubles: a square of 16,384 nodes. What states more is refused before anything is
/// allocated for it.
constexpr std::uint64_t kMostNodes = std::uint64_t{1} << 28;

struct HeightTable {
    std::size_t columns = 0, rows = 0;
    std::vector<double> values;     ///< [row * columns + column]; NaN where there is no data
    bool single_precision = false;  ///< the file holds 32-bit floats
    double scale = 1, offset = 0;   ///< a height is value * scale + offset
    /// Easting of (column, row) is [0] + column [1] + row [2], northing [3] + column [4] + row [5],
    /// where the first node's cell begins at (0, 0).
    std::optional<std::array<double, 6>> geotransform;
};

/// `name` is the file in messages. Errors are bad_input, but for what the system refused.
[[nodiscard]] Result<HeightTable> read_png_heights(std::span<const std::byte> bytes,
                                                   const std::string& name);
[[nodiscard]] Result<HeightTable> read_npy_heights(std::span<const std::byte> bytes,
                                                   const std::string& name);
[[nodiscard]] Result<HeightTable> read_csv_heights(std::span<const std::byte> bytes,
                                                   const std::string& name);

/// Names under which GDAL's library is looked for, in this order.
[[nodiscard]] std::vector<std::string> gdal_libraries();
/// Reads the first band of a raster through GDAL, in a child process that loads it there.
[[nodiscard]] Result<HeightTable> read_gdal_heights(
    const std::string& path, const std::vector<std::string>& libraries = gdal_libraries());

/// The error of a file with too many nodes, if it has.
[[nodiscard]] std::optional<Error> too_many_nodes(const std::string& name, std::uint64_t columns,
                                                  std::uint64_t rows);

}  // namespace sightline::heights
