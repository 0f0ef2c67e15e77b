// The polygons of depth sort and the pieces that they are split into: which goes before which, and
// what is left of a split.
//
// Source: M. Newell, R. Newell, T. Sancha, "A Solution to the Hidden Surface Problem", 1972. How
// this version differs: a piece is its source triangle with the half-planes of the page that bound
// it, so nothing is rounded and every test is exact; and where the plane tests fail, the sign of
// the difference of depths at the corners of the two projections' intersection decides whether one
// hides the other or they cross.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <unordered_map>
#include <vector>

#include "visibility/counts.hpp"
#include "visibility/depth_order.hpp"
#include "visibility/plane_cuts.hpp"
#include "visibility/sort_face.hpp"

namespace sightline {

enum class SortCount : std::uint8_t {
    polygons,
    pairs,
    plane_tests,
    projection_tests,
    intersections,
    exchanges,
    cycles,
    splits,
    partitions,
    exact
};

inline constexpr std::array kSortCountNames{
    CountName{"polygons sorted"},
    CountName{"pairs with overlapping extents"},
    CountName{"pairs tested against planes"},
    CountName{"pairs tested for disjoint projections"},
    CountName{"pairs intersected"},
    CountName{"exchanges"},
    CountName{"cycles"},
    CountName{"splits"},
    CountName{"entangled sets divided"},
    CountName{"exact plane tests"},
};

using SortCounts = Counts<SortCount, kSortCountNames>;

/// Whether one polygon has to be painted before another one.
enum class Precedes { no, yes, crossing };

/// Pieces by number; the first ones are the whole faces, in their order. Not for several threads.
class SortPieces {
public:
    enum class State : std::uint8_t { waiting, open, painted, split };

    struct Node {
        std::uint32_t face;
        State state = State::waiting;
        std::uint32_t place = 0;  ///< open: the user's. split: its first child, of two
        PieceRegion region = {};  ///< empty: the whole face
        PageBox box = {};
        /// The user's: what has to be painted before it, and whether that is all.
        bool has_met_all = false;
        std::vector<std::uint32_t> conflicts = {};
    };

    /// With `grid`, pieces that cover no sample of it are dropped: they are painted at once.
    SortPieces(const ScreenScene& screen, const SampleGrid* grid, Observer* observer);

    [[nodiscard]] const std::vector<SortFace>& faces() const { return faces_; }
    [[nodiscard]] Node& node(std::uint32_t n) { return nodes_[n]; }
    [[nodiscard]] const SortFace& face_of(std::uint32_t n) const { return faces_[nodes_[n].face]; }

    /// Does q, somewhere, lie behind p where both are seen? In one plane the lower id is in front.
    [[nodiscard]] Precedes precedes(std::uint32_t q, std::uint32_t p);

    /// On which sides of the plane of face `cutter` a piece has an area. Neither: in the plane.
    [[nodiscard]] PlaneSides sides_of_plane(std::uint32_t n, std::uint32_t cutter);

    /// Splits a piece into the part behind the plane of face `cutter` and the part in front of it:
    /// nodes `place` and `place` + 1. Precondition: it has an area on both sides.
    void split(std::uint32_t n, std::uint32_t cutter);

    /// The next piece in the order. True when nothing is left of its face.
    bool paint(std::uint32_t n);

    /// take(piece) for every piece of a face that is not painted. It may split them.
    template <class Take>
    void for_each_piece(std::uint32_t face, const Take& take) {
        if (nodes_[face].state != State::split) {
            if (nodes_[face].state != State::painted) take(face);
            return;
        }
        const std::vector<std::uint32_t> pieces = pieces_of_[face];
        for (const std::uint32_t piece : pieces) take(piece);
    }

    void tell(StepKind kind, std::uint32_t n, std::uint32_t other) const {
        if (observer_ == nullptr) return;
        observer_->step({kind, face_of(n).id, face_of(other).id});
    }

    SortCounts counts;
    SortedPieces sorted;  ///< what is painted

private:
    [[nodiscard]] bool overlap(std::uint32_t q, std::uint32_t p);
    [[nodiscard]] Precedes precedes_in_plane(std::uint32_t q, std::uint32_t p);
    [[nodiscard]] PieceRegion region(std::uint32_t n) const;
    [[nodiscard]] PieceRegion intersection(std::uint32_t q, std::uint32_t p) const;
    [[nodiscard]] bool covers_samples(std::uint32_t n);
    [[nodiscard]] Piece to_piece(std::uint32_t n, std::vector<PlaneCut>& cuts) const;

    const ScreenScene& screen_;
    const SampleGrid* grid_;
    Observer* observer_;
    std::vector<SortFace> faces_;
    std::optional<CutJudge> cut_judge_;
    std::vector<PlaneCut> scratch_;
    std::deque<Node> nodes_;
    std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> pieces_of_;  // of split faces
};

}  // namespace sightline
