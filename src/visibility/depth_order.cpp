// Depth sort's order.
//
// Source: M. Newell, R. Newell, T. Sancha, "A Solution to the Hidden Surface Problem", 1972: take
// the polygon P with the farthest point. It may be painted when it passes one of five tests against
// every Q that reaches as deep as P's nearest point: (1) x extents and (2) y extents do not
// overlap, (3) P lies wholly behind Q's plane, (4) Q lies wholly in front of P's plane, (5) the
// projections are disjoint. If Q fails them all, see whether Q can go first: (3') and (4') with the
// roles exchanged; then Q is moved behind P and marked. A marked one that would be moved again
// closes a cycle: it is split by the plane of the other.
//
// How this version differs:
// - "Moved behind P" is a visit: Q's own conflicts are looked at, Q is painted, and the tests of P
//   go on. So the exchanges are a depth-first search for a topological order, each polygon meets
//   its neighbours once, and the mark is that Q's visit has not ended.
// - A tree of boxes finds the Q that pass (1) and (2) and the extents in z.
// - Where (3'), (4') fail too, an exact test tells crossing polygons from others. Only they and
// true
//   cycles are split (sort_pieces.hpp).
// - In a cycle some member is cut by another member's plane (otherwise a BSP tree of their planes
//   would order them without a split): the first such pair from the end of the cycle is taken.
// - Pieces are cells of the finite arrangement of all planes, so the search ends. Where it splits
//   many times more often than there are polygons, as where hundreds of them cross one another, the
//   rest is divided by planes instead of pair by pair (depth_partition.cpp).
//
// Time O(n log n + pairs that overlap on the page and in z), memory O(n + pieces).
#include "visibility/depth_order.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <tuple>
#include <utility>

#include "visibility/depth_partition.hpp"
#include "visibility/sort_pieces.hpp"

namespace sightline {

namespace {

using State = SortPieces::State;

/// The search for the order.
class Sorter {
public:
    Sorter(SortPieces& pieces, int threads)
        : pieces_(pieces), tree_(boxes_of(pieces.faces()), threads) {}

    void run() {
        for (const std::uint32_t face : farthest_first()) {
            roots_.push_back(face);
            while (!roots_.empty() && !is_entangled()) take_root();
            if (is_entangled()) break;
        }
        if (is_entangled()) divide_the_rest();
    }

private:
    /// A polygon whose conflicts are looked at.
    struct Visit {
        std::uint32_t node;
        std::size_t next = 0;  ///< of its conflicts
    };

    static std::vector<PageBox> boxes_of(const std::vector<SortFace>& faces) {
        std::vector<PageBox> boxes;
        boxes.reserve(faces.size());
        for (const SortFace& face : faces) boxes.push_back(face.box);
        return boxes;
    }

    [[nodiscard]] std::vector<std::uint32_t> farthest_first() const {
        const std::vector<SortFace>& faces = pieces_.faces();
        std::vector<std::uint32_t> order(faces.size());
        std::iota(order.begin(), order.end(), 0u);
        std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
            return std::tie(faces[a].box.far, faces[a].id, faces[a].number) >
                   std::tie(faces[b].box.far, faces[b].id, faces[b].number);
        });
        return order;
    }

    void take_root() {
        const std::uint32_t root = roots_.back();
        roots_.pop_back();
        const SortPieces::Node& node = pieces_.node(root);
        if (node.state == State::split) {
            roots_.insert(roots_.end(), {node.place, node.place + 1});
        } else if (node.state == State::waiting) {
            open(root);
            while (!stack_.empty() && !is_entangled()) step();
        }
    }

    void step() {
        Visit& visit = stack_.back();
        const std::vector<std::uint32_t>& conflicts = pieces_.node(visit.node).conflicts;
        if (visit.next == conflicts.size()) {
            if (pieces_.paint(visit.node)) tree_.remove(pieces_.node(visit.node).face);
            stack_.pop_back();
            return;
        }
        const std::uint32_t q = conflicts[visit.next++];
        switch (pieces_.node(q).state) {
            case State::painted:
                return;
            case State::split:
                hand_over(pieces_.node(q).place);
                return;
            case State::waiting:
                ++pieces_.counts[SortCount::exchanges];
                pieces_.tell(StepKind::polygons_exchanged, visit.node, q);
                open(q);
                return;
            case State::open:
                cut_cycle(pieces_.node(q).place);
                return;
        }
    }

    // Begins a visit. What p has to wait for does not change when it is given up and begun again:
    // pieces of what it need not wait for are none of its business either.
    void open(std::uint32_t p) {
        SortPieces::Node& node = pieces_.node(p);
        node.state = State::open;
        node.place = static_cast<std::uint32_t>(stack_.size());
        stack_.push_back({p});
        if (node.has_met_all) return;
        node.has_met_all = true;
        tree_.search(node.box, pieces_.face_of(p).near, [&](std::uint32_t face) {
            pieces_.for_each_piece(face, [&](std::uint32_t q) {
                if (node.state == State::open) meet(q, p);
            });
        });
    }

    // Looks whether q goes before p, whose visit is the latest.
    void meet(std::uint32_t q, std::uint32_t p) {
        if (q == p || pieces_.node(q).state == State::painted) return;
        if (pieces_.node(q).state == State::split) {
            hand_over(pieces_.node(q).place);
            return;
        }
        const Precedes precedes = pieces_.precedes(q, p);
        if (precedes == Precedes::yes) {
            pieces_.node(p).conflicts.push_back(q);
        } else if (precedes == Precedes::crossing) {
            if (pieces_.node(q).state == State::open) {
                split_open(p, pieces_.node(q).face);
            } else {
                pieces_.split(q, pieces_.node(p).face);
                hand_over(pieces_.node(q).place);
            }
        }
    }

    // The two children of a split piece take its place among the conflicts of the latest visit.
    void hand_over(std::uint32_t child) {
        if (stack_.empty()) {
            roots_.insert(roots_.end(), {child, child + 1});
            return;
        }
        const std::uint32_t p = stack_.back().node;
        for (const std::uint32_t q : {child, child + 1}) {
            // The first child's turn may have split p.
            if (!stack_.empty() && stack_.back().node == p) meet(q, p);
        }
    }

    // The visits from `first` to the latest wait for one another.
    void cut_cycle(std::uint32_t first) {
        ++pieces_.counts[SortCount::cycles];
        const auto size = static_cast<std::uint32_t>(stack_.size());
        const auto cut_by = [&](std::uint32_t b, std::uint32_t a) {
            const std::uint32_t node = stack_[b].node, cutter = pieces_.node(stack_[a].node).face;
            const PlaneSides sides = pieces_.sides_of_plane(node, cutter);
            if (!sides.behind || !sides.in_front) return false;
            split_open(node, cutter);
            return true;
        };
        for (std::uint32_t b = size; b-- > first;) {
            if (cut_by(b, b == first ? size - 1 : b - 1)) return;
            if (cut_by(b, b + 1 == size ? first : b + 1)) return;
        }
        for (std::uint32_t b = size; b-- > first;)
            for (std::uint32_t a = first; a < size; ++a)
                if (a != b && cut_by(b, a)) return;
        assert(false);  // a cycle has a member that another one cuts
    }

    // Splits a piece whose visit has not ended: that visit and all after it are given up.
    void split_open(std::uint32_t node, std::uint32_t cutter) {
        give_up(pieces_.node(node).place);
        pieces_.split(node, cutter);
        hand_over(pieces_.node(node).place);
    }

    void give_up(std::size_t first) {
        for (std::size_t k = first; k < stack_.size(); ++k)
            pieces_.node(stack_[k].node).state = State::waiting;
        stack_.resize(first);
    }

    [[nodiscard]] bool is_entangled() {
        constexpr std::uint64_t kSplitsPerPolygon = 4, kFew = 100;
        return pieces_.counts[SortCount::splits] >
               kSplitsPerPolygon * pieces_.counts[SortCount::polygons] + kFew;
    }

    void divide_the_rest() {
        give_up(0);
        std::vector<std::uint32_t> waiting;
        for (std::uint32_t face = 0; face < pieces_.faces().size(); ++face)
            pieces_.for_each_piece(face, [&](std::uint32_t n) { waiting.push_back(n); });
        paint_by_partition(pieces_, std::move(waiting));
    }

    SortPieces& pieces_;
    BoxTree tree_;
    std::vector<std::uint32_t> roots_;  // to be visited next, the last one first
    std::vector<Visit> stack_;          // visits that have not ended, each for the one before
};

}  // namespace

SortedPieces sort_by_depth(const ScreenScene& screen, const SampleGrid* grid,
                           const ResolveOptions& options) {
    SortPieces pieces(screen, grid, options.observer);
    Sorter(pieces, options.threads).run();
    pieces.counts.report(options);
    return std::move(pieces.sorted);
}

}  // namespace sightline
