// Height maps: terrain and other tables of heights, read from pictures, tables and elevation files.
#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sightline/error.hpp"

namespace sightline {

/// Heights at the nodes of a grid. Rows of the file run towards +z, so that a viewer who looks
/// along -z from the front sees the file's first row farthest away, as on a map with north at the
/// top.
struct HeightMap {
    std::vector<double> x;  ///< of the columns, ascending; two or more
    std::vector<double> z;  ///< of the rows, ascending; two or more
    std::vector<double> y;  ///< y[row * x.size() + column]; NaN where there is no data
    /// The file says where it lies: x is its easting, z minus its northing.
    bool placed = false;
};

struct HeightMapOptions {
    /// Distance of columns and of rows; positive. It overrides the place that a file tells: x is
    /// column * cell->x and z is row * cell->y then. Default: what the file says, else 1.
    std::optional<glm::dvec2> cell;
    double height_scale = 1;  ///< heights are multiplied by it; finite
    /// This value means that there is no data: as it stands in the file, before any scaling.
    std::optional<double> no_data;
};

/// Reads a height map: grey PNG of 16 or fewer bits, NPY (two-dimensional), CSV (one row a line),
/// and whatever GDAL reads where GDAL is installed; docs/formats.md tells what is taken from each.
/// What GDAL reads, it reads in a child process (Linux only). Infinite heights become NaN.
///
/// Errors, one line each: bad_option for options out of range and for "-" (standard input); io when
/// the system refused (no such file, no memory, no GDAL); bad_input for what is no height map, is
/// damaged or too large (2^28 nodes, 4 GiB), has fewer than two rows or columns, or no height.
/// Thread-safe.
[[nodiscard]] Result<HeightMap> load_height_map(const std::string& path,
                                                const HeightMapOptions& options = {});

}  // namespace sightline
