// Polygons as depth sort compares them, and its tests in order of cost.
//
// Source: M. Newell, R. Newell, T. Sancha, "A Solution to the Hidden Surface Problem", 1972. The
// tests of the extents stand in the search of BoxTree; here are the tests against the planes and
// for disjoint projections. How this version differs: all are exact, and none is strict: polygons
// that touch, share an edge or lie in one plane are no conflict.
#pragma once

#include <array>
#include <cstdint>

#include "math/box_tree.hpp"
#include "math/convex_region.hpp"
#include "sightline/screen_scene.hpp"

namespace sightline {

/// A screen triangle with an area.
struct SortFace {
    std::array<ScreenPoint, 3> corners;  ///< clockwise on the page
    Plane plane;
    double gx = 0, gy = 0;  ///< slopes of the plane
    PageBox box;
    std::int32_t near = 0;     ///< the least z in it
    bool own_plane = false;    ///< the plane passes through the corners exactly
    std::uint32_t number = 0;  ///< of the screen triangle
    std::uint32_t id = 0;      ///< of the triangle in the scene
    std::uint32_t shared = kNone;

    /// Precondition: the triangle is drawable and has an area on the page.
    SortFace(const ScreenScene& screen, std::uint32_t number);
};

/// What bounds a piece on one of its sides.
struct SideTag {
    std::uint32_t cutter = kNone;  ///< the face whose plane cuts, or kNone: an edge of the triangle
    bool behind = false;           ///< the piece is the part behind the cutter's plane
};

using PieceRegion = ConvexRegion<SideTag>;

/// The whole of a face.
[[nodiscard]] PieceRegion region_of(const SortFace& face);

/// Where one face lies with respect to the plane of another one.
struct PlaneSides {
    bool behind = false, in_front = false;  ///< some of its corners are
};

/// At the corners of `face`; `exact` counts the comparisons that the filter left to integers.
[[nodiscard]] PlaneSides sides_of(const SortFace& face, const SortFace& plane_of,
                                  std::uint64_t& exact);

/// Whether the projections of two faces have no area in common.
[[nodiscard]] bool are_disjoint(const SortFace& a, const SortFace& b);

}  // namespace sightline
