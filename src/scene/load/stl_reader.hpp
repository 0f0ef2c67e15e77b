// STL, ascii and binary (Stereolithography Interface Specification, 3D Systems, 1988).
#pragma once

#include <string_view>

#include "scene/load/reader.hpp"

namespace sightline::load {

/// Reads facets with their normals; each solid of an ascii file is an object. The 16 bits after
/// each binary facet, which some programs use for colours in ways that contradict each other, are
/// not looked at. Files that begin with "solid" may still be binary.
[[nodiscard]] Result<Soup> read_stl(std::string_view bytes, const ReadContext& context);

}  // namespace sightline::load
