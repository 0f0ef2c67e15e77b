// The order of surfaces in a view, for those who draw with means of their own: a canvas, a vector
// file, a plotter. What list-priority algorithms paint, handed out piece by piece.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <span>

#include "sightline/visibility.hpp"

namespace sightline {

/// A part of a triangle: all of it, unless the algorithm had to split it.
struct OrderedPiece {
    std::uint32_t triangle = kNone;  ///< of the scene
    bool whole = true;
    /// Corners in pixels, clockwise on the page: a convex polygon of three corners or more. Those
    /// of whole triangles are snapped to the screen's grid; where a triangle is split they are
    /// rounded, and the same for neighbouring pieces up to rounding.
    std::span<const glm::dvec2> outline;
};

/// What to do with a piece, which is valid during the call only. False ends the visit.
using PieceVisitor = std::function<bool(const OrderedPiece&)>;

/// Hands over all that is in the view, each piece before those that it could hide (painting over
/// is right), on the calling thread. Pieces without area on the page are left out; what reaches
/// beyond the picture is not cut off.
/// Algorithms: those whose space is Space::list_priority. Time as for resolve(), without painting.
/// Error (bad_option): another algorithm; the scene has quadrics.
[[nodiscard]] Status for_each_back_to_front(const Algorithm& algorithm, const ScreenScene& screen,
                                            const ResolveOptions& options,
                                            const PieceVisitor& visit);

/// The same from front to back: for those who stop when enough is covered.
[[nodiscard]] Status for_each_front_to_back(const Algorithm& algorithm, const ScreenScene& screen,
                                            const ResolveOptions& options,
                                            const PieceVisitor& visit);

}  // namespace sightline
