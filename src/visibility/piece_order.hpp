// Pieces in their order, with the lines that bound them on the page.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "sightline/visibility.hpp"
#include "visibility/painting.hpp"

namespace sightline {

/// The cuts of a piece are numbers of `lines`: it lies where l x + m y + n >= 0, x and y in units
/// of the screen.
struct PieceOrder {
    std::vector<Piece> pieces;  ///< back to front
    std::vector<glm::dvec3> lines;
};

}  // namespace sightline
