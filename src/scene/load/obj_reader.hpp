// Wavefront OBJ (Advanced Visualizer manual, appendix B1: polygons only) with its MTL files.
#pragma once

#include <string_view>

#include "scene/load/reader.hpp"

namespace sightline::load {

/// Reads polygons, positions (with colours after them), normals, objects, groups and materials.
/// Lines and points are counted as ignored; texture coordinates, curves and everything else are
/// skipped. An MTL file that is missing is no error.
[[nodiscard]] Result<Soup> read_obj(std::string_view text, const ReadContext& context);

}  // namespace sightline::load
