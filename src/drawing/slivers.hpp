// Slivers: what of a face only snapping makes visible.
//
// Where a face ends behind another one, along an edge whose corners the two do not share, snapping
// moves the two edges apart by up to a step of the page, and a strip comes out that nobody would
// see. Along a silhouette the planes of its two faces, snapped, cross beside the edge that they
// share, and the back one comes out. Let A be the visible area of a face and P the length of its
// border: 2 A / P is its mean width. A face whose own outline is wider than kSliverWidth, and whose
// visible part is not, counts as hidden, and its area goes to the face beside it, so that sums
// stay. Faces that are tiny themselves stay visible.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "drawing/regions.hpp"

namespace sightline {

/// Mean width of a sliver, in steps of the page, at most. An edge is moved by half a step in x and
/// y, so two of them by at most 1.5 steps apart; four leave room for what adds up at their ends.
inline constexpr double kSliverWidth = 4;

/// What is seen of one source polygon, or of some of its triangles.
class FaceSight {
public:
    void clear();
    /// Takes an occluder of it and the border of what is seen of that; returns how much that is,
    /// the doubled area in steps squared.
    double add(const Occluder& occluder, std::span<const BorderPiece> border);
    [[nodiscard]] bool is_sliver() const;

private:
    double doubled_ = 0, own_doubled_ = 0;
    std::vector<BorderPiece> border_, outline_;
};

/// A source polygon whose visible part is a sliver.
struct Sliver {
    std::uint32_t polygon = 0;
    std::uint32_t heir = kNone;  ///< the polygon beside it that gets its area, if any
    std::vector<BorderPiece> border;
};

/// Finds the heirs of slivers: of each the polygon that borders it longest on its other side, among
/// those that are seen and no slivers themselves; a sliver among slivers inherits their heir. One
/// that has none stays visible. `seen` has a byte for every polygon of the scene, not 0: something
/// of it is seen that is no sliver. In the order of their polygons; it does not matter in what
/// order they come. O(k log n) for k pieces of borders, on all cores.
void find_heirs(const ScreenScene& page, const Occluders& occluders,
                std::span<const std::uint8_t> seen, std::vector<Sliver>& slivers, int threads);

}  // namespace sightline
