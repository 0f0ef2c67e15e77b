// The visible part of a face, exactly.
//
// The object-precision algorithm (I. Sutherland, R. Sproull, R. Schumacker, "A Characterization of
// Ten Hidden-Surface Algorithms", 1974): every polygon against those in front of it, as in K.
// Weiler, P. Atherton, "Hidden Surface Removal Using Polygon Area Sorting", 1977. How this version
// differs: nothing is ever cut into new polygons. What hides a face F is a set of convex polygons:
// triangles of the page, each perhaps cut by the line where its plane meets F's. The border of the
// visible part consists of stretches of F's own sides that nothing covers on the inner side, and of
// stretches of the sides of hiding polygons, inside of F, that nothing covers on the outer side.
// Such stretches are intervals on a line between places where other lines cross it (carrier.hpp),
// so a corner is symbolic until it is rounded, and neighbours round it to the same point.
//
// Who is in front is the canonical answer of docs/exactness.md: the smaller depth, at a tie the
// lower id.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "drawing/carrier.hpp"
#include "drawing/occluders.hpp"

namespace sightline {

/// A piece of the border of a visible part, which lies on its right. In units of the page.
struct BorderPiece {
    glm::ivec2 from, to;              ///< rounded
    glm::dvec2 exact_from, exact_to;  ///< not rounded to the grid
    bool own = false;                 ///< of a side of the face itself, not of what hides it
};

enum class FaceFate { whole, partly, hidden };

/// Finds visible parts of faces one after another. Not thread-safe: one a thread.
class RegionFinder {
public:
    /// With TraceMethod::pairwise every side is tried against every polygon.
    RegionFinder(const Occluders& occluders, TraceMethod method)
        : occluders_(occluders), method_(method) {}

    /// Appends the border of the visible part of a face, that of occluder number `k`; nothing when
    /// it is hidden. For m faces before it about O(m log m)
    /// where they form surfaces, up to O(m^3) where all of them cross.
    FaceFate find(std::uint32_t k, std::vector<BorderPiece>& border);

private:
    /// A face that hides F, or a part of it.
    struct Hider {
        std::uint32_t occluder = 0;
        bool whole = true;  ///< all of it; else where its plane is in front of F's
        ConvexSides sides;
        PageBounds bounds;  ///< of what lies over F
    };
    /// A side of a hider that may border what is visible.
    struct Candidate {
        std::uint32_t low = 0, high = 0;  ///< its ends
        std::uint32_t hider = 0, side = 0;
        bool forward = true;  ///< it runs from the lower to the higher point
    };

    /// Where a hider begins and ends along the longer side of F's box.
    struct HiderPlace {
        std::int32_t begin = 0, end = 0;
        std::uint32_t hider = 0;
    };

    void collect_hiders(const Occluder& face);
    void order_hiders(const PageBounds& face);
    void collect_candidates(const Occluder& face);
    void drop_seams();
    [[nodiscard]] bool try_candidate(const Candidate& candidate, std::vector<BorderPiece>& border);
    void add_own_sides(const Occluder& face, std::vector<BorderPiece>& border);
    /// The ends of a stretch, rounded.
    struct Chord {
        glm::dvec2 from, to;
    };
    [[nodiscard]] static bool misses(const Chord& chord, const ConvexSides& sides);
    void subtract_hiders(const PageLine& carrier, CarrierSide beside, const Stretch& stretch,
                         std::uint32_t skip);
    [[nodiscard]] bool cover(const PageLine& carrier, CarrierSide beside, const Stretch& stretch,
                             std::uint32_t hider, std::uint32_t skip);
    /// Of a side of the face, or reversed of a side of what hides it.
    [[nodiscard]] BorderPiece piece(const PageLine& carrier, const Stretch& stretch,
                                    bool reversed) const;

    const Occluders& occluders_;
    TraceMethod method_;
    VisitMarks marks_;
    const Occluder* face_ = nullptr;
    ConvexSides own_;
    std::vector<std::uint32_t> near_;
    std::vector<Hider> hiders_;
    std::vector<HiderPlace> order_;  // by their beginnings
    std::int32_t longest_ = 0;       // of them
    bool along_y_ = false;           // else along x
    std::vector<Candidate> candidates_;
    std::vector<Stretch> covers_, left_;
};

}  // namespace sightline
