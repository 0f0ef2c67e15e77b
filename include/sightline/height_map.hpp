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
    /// Distance of columns and of rows. Default: what the file says, else 1.
    std::optional<glm::dvec2> cell;
    double height_scale = 1;        ///< heights are multiplied by it
    std::optional<double> no_data;  ///< this value (before scaling) means that there is no data
};

/// Reads a height map: 16-bit or 8-bit grey PNG, CSV (one row a line), NPY (two-dimensional), and
/// whatever GDAL reads where GDAL is installed. Errors (bad_input, io): no such file, no height
/// map, fewer than two rows or columns, no height at all.
[[nodiscard]] Result<HeightMap> load_height_map(const std::string& path,
                                                const HeightMapOptions& options = {});

}  // namespace sightline
