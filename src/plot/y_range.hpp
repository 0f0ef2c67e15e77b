// How high a surface reaches.
#pragma once

#include <glm/vec2.hpp>

#include "plot/field.hpp"
#include "sightline/error.hpp"

namespace sightline {

/// The y between which a field is 0 over a part of the x-z plane (x: from, to; z likewise), with a
/// little to spare. Found on a grid of columns: parts thinner than about 1/100 of the extents can
/// be missed. Of a surface without end (a cylinder that stands, waves in all directions) as much as
/// the larger extent of x and z, about y = 0. Error (bad_input): nothing was found.
[[nodiscard]] Result<glm::dvec2> find_y_range(const Field& field, glm::dvec2 x, glm::dvec2 z);

}  // namespace sightline
