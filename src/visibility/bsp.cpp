// Binary space partition trees: a tree of planes, built once, gives the surfaces from back to front
// for every viewer; painting them in this order leaves what is seen.
//
// Source: H. Fuchs, Z. Kedem, B. Naylor, "On Visible Surface Generation by A Priori Tree
// Structures", SIGGRAPH 1980.
//
// How this version differs: parts of split polygons have no vertices of their own. A part is its
// triangle and the sides of the cuts that bound it, and a cut becomes a line of the page for each
// view (bsp_page.cpp), so there are no cracks. The tree is walked with a stack of our own, however
// deep it is. What moves gets a tree on top of the static one (bsp_build.cpp), and both are walked
// at once.
//
// The tree is of the world and the picture of its snapped image, so this algorithm may differ from
// the others where two surfaces are closer at a sample than snapping can move them.
//
// The walk only notes which parts it meets; their lines on the page are found on all cores.
//
// Time O(nodes) for the order, O(rows and samples of all pieces) for painting; memory O(tree).
#include "visibility/bsp.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "math/arena.hpp"
#include "visibility/algorithms.hpp"
#include "visibility/bsp_build.hpp"
#include "visibility/bsp_page.hpp"

namespace sightline {

namespace bsp {

namespace {

/// The screen triangles first .. end-1.
struct ScreenRange {
    std::uint32_t first, end;
    [[nodiscard]] bool empty() const { return first == end; }
};

/// All that is drawn of a triangle: itself, or what clipping made of it, or nothing.
ScreenRange screen_triangles(const ScreenScene& screen, std::uint32_t id) {
    if (screen.drawable(id)) return {id, id + 1};
    // The pieces are in the order of their triangles.
    const auto first_from = [&](std::uint64_t least) {
        std::uint32_t first = screen.scene().triangle_count(), end = screen.triangle_count();
        while (first < end) {
            const std::uint32_t middle = first + (end - first) / 2;
            if (screen.id(middle) < least)
                first = middle + 1;
            else
                end = middle;
        }
        return first;
    };
    return {first_from(id), first_from(std::uint64_t{id} + 1)};
}

/// A node of the tree and the node on top of it that has the same plane; one of them may be kNone.
struct NodePair {
    std::uint32_t below = kNone, top = kNone;
    [[nodiscard]] bool empty() const { return below == kNone && top == kNone; }
};

/// Calls visit(tree, node, part) for the parts of a pair, the lowest triangle last, or first.
template <class Visit>
void for_each_part(const Tree& below, const Tree& top, const NodePair& pair, Order order,
                   const Visit& visit) {
    std::span<const Part> a, b;
    if (pair.below != kNone) a = below.parts_of(pair.below);
    if (pair.top != kNone) b = top.parts_of(pair.top);
    const bool backwards = order == Order::front_to_back;
    const auto take = [&](std::span<const Part>& from) -> const Part& {
        const Part& part = backwards ? from.back() : from.front();
        from = backwards ? from.first(from.size() - 1) : from.subspan(1);
        return part;
    };
    while (!a.empty() || !b.empty()) {
        const auto key = [&](std::span<const Part> of) {
            return backwards ? of.back().triangle : of.front().triangle;
        };
        const bool from_below = b.empty() || (!a.empty() && (key(a) > key(b)) != backwards);
        if (from_below)
            visit(below, pair.below, take(a));
        else
            visit(top, pair.top, take(b));
    }
}

/// A part that the walk has met.
struct Met {
    const Tree* tree;
    const Part* part;
    std::uint32_t node;
};

/// Makes pieces of parts. For one thread.
class PieceMaker {
public:
    PieceMaker(const ScreenScene& screen, const Tree& below, Order order)
        : screen_(screen),
          below_(below),
          surfaces_(screen.scene(), below.grid),
          rays_(screen, below.grid),
          order_(order) {}

    /// All that the page has of a triangle: itself, or what clipping made of it. False when there
    /// is nothing of it.
    bool add(const Met& met) {
        const std::size_t before = pieces_.size();
        const ScreenRange range = screen_triangles(screen_, met.part->triangle);
        for (std::uint32_t k = range.first; k < range.end; ++k) add_piece(met, k);
        // They lie beside one another, but an order and its reverse shall be just that.
        if (order_ == Order::front_to_back)
            std::reverse(pieces_.begin() + static_cast<std::ptrdiff_t>(before), pieces_.end());
        return pieces_.size() > before;
    }

    /// Hands over what was made, behind what is there.
    void move_to(OrderedPieces& out) {
        const auto shift = static_cast<std::uint32_t>(out.cuts.size());
        for (Piece& piece : pieces_) {
            piece.first_cut += shift;
            piece.end_cut += shift;
            out.pieces.push_back(piece);
        }
        out.cuts.insert(out.cuts.end(), cuts_.begin(), cuts_.end());
        pieces_.clear();
        cuts_.clear();
    }

    [[nodiscard]] std::size_t piece_count() const { return pieces_.size(); }
    [[nodiscard]] std::size_t cut_count() const { return cuts_.size(); }

    [[nodiscard]] double side_of_viewer(const TreePlane& plane) const {
        return rays_.side_of_viewer(plane);
    }

private:
    void add_piece(const Met& met, std::uint32_t screen_triangle) {
        Piece piece;
        piece.triangle = screen_triangle;
        if (met.part->cut != kNone) {
            find_cuts(met);
            // Few cuts are cheaper to ask than to prune.
            if (page_.size() > kFewCuts && !pruner_.prune(screen_, screen_triangle, page_)) return;
            piece.first_cut = static_cast<std::uint32_t>(cuts_.size());
            cuts_.insert(cuts_.end(), page_.begin(), page_.end());
            piece.end_cut = static_cast<std::uint32_t>(cuts_.size());
        }
        pieces_.push_back(piece);
    }

    // A part on top of the tree may lie in a node whose plane is equal to its own only in effect.
    void find_cuts(const Met& met) {
        const Tree& tree = *met.tree;
        const TreePlane surface =
            &tree == &below_ ? tree.planes[met.node] : surfaces_.plane(met.part->triangle);
        constexpr std::int32_t kEverywhere = std::int32_t{1} << kCoordBits;
        page_.clear();
        for (CutSide side = met.part->cut; side != kNone; side = tree.cuts[side >> 1].parent) {
            const glm::dvec3 line = rays_.line(tree.planes[tree.cuts[side >> 1].node], surface);
            const bool back = (side & 1) != 0;
            page_.push_back({back ? -line : line, !back, -kEverywhere, kEverywhere});
        }
    }

    static constexpr std::size_t kFewCuts = 2;

    const ScreenScene& screen_;
    const Tree& below_;
    Surfaces surfaces_;
    Rays rays_;
    Order order_;
    std::vector<Piece> pieces_;
    std::vector<PageCut> cuts_;
    std::vector<PageCut> page_;
    CutPruner pruner_;
};

/// A walk over a tree and what is on top of it.
class Walk {
public:
    Walk(const ScreenScene& screen, const Tree& below, const Tree& top, Order order, int threads,
         Observer* observer)
        : below_(below),
          top_(top),
          order_(order),
          threads_(threads),
          observer_(observer),
          maker_(screen, below, order) {}

    [[nodiscard]] OrderedPieces run() {
        met_.reserve(below_.parts.size() + top_.parts.size());
        // In-order: down the side that comes first, then the node, then the other side.
        struct Open {
            NodePair pair;
            double viewer;
        };
        std::vector<Open> open;
        NodePair at{below_.root(), top_.root()};
        while (!at.empty() || !open.empty()) {
            for (; !at.empty(); at = child(at, goes_back_first(open.back().viewer)))
                open.push_back({at, maker_.side_of_viewer(plane_of(at))});
            const Open node = open.back();
            open.pop_back();
            emit(node.pair, node.viewer);
            at = child(node.pair, !goes_back_first(node.viewer));
        }
        make_pieces();
        return std::move(out_);
    }

private:
    [[nodiscard]] const TreePlane& plane_of(const NodePair& pair) const {
        return pair.below != kNone ? below_.planes[pair.below] : top_.planes[pair.top];
    }

    [[nodiscard]] bool goes_back_first(double viewer) const {
        return (viewer >= 0) == (order_ == Order::back_to_front);
    }

    [[nodiscard]] NodePair child(const NodePair& pair, bool back) const {
        const auto of = [back](const Tree& tree, std::uint32_t node) {
            if (node == kNone) return kNone;
            return back ? tree.nodes[node].back : tree.nodes[node].front;
        };
        return {of(below_, pair.below), of(top_, pair.top)};
    }

    void emit(const NodePair& pair, double viewer) {
        ++out_.nodes_met;
        bool first = true;
        for_each_part(below_, top_, pair, order_,
                      [&](const Tree& tree, std::uint32_t node, const Part& part) {
                          if (first) tell(StepKind::node_entered, part.triangle);
                          first = false;
                          ++out_.parts_met;
                          out_.moving_parts += &tree == &top_ ? 1 : 0;
                          const bool shows_back = part.reversed != 0 ? viewer > 0 : viewer < 0;
                          out_.back_faces_met += shows_back ? 1 : 0;
                          take({&tree, &part, node});
                      });
        if (first) tell(StepKind::node_entered, kNone);
    }

    // Whoever watches sees each piece when its node is met.
    void take(const Met& met) {
        if (observer_ == nullptr)
            met_.push_back(met);
        else if (maker_.add(met))
            tell(StepKind::polygon_painted, met.part->triangle);
    }

    void make_pieces() {
        if (observer_ != nullptr) {
            maker_.move_to(out_);
            return;
        }
        constexpr std::size_t kChunk = 8192;
        std::vector<PieceMaker> makers((met_.size() + kChunk - 1) / kChunk, maker_);
        const auto make = [&](std::size_t chunk) {
            const std::size_t end = std::min(met_.size(), (chunk + 1) * kChunk);
            for (std::size_t k = chunk * kChunk; k < end; ++k) makers[chunk].add(met_[k]);
        };
        in_arena(threads_, [&] { tbb::parallel_for(std::size_t{0}, makers.size(), make); });
        std::size_t pieces = 0, cuts = 0;
        for (const PieceMaker& maker : makers) {
            pieces += maker.piece_count();
            cuts += maker.cut_count();
        }
        out_.pieces.reserve(pieces);
        out_.cuts.reserve(cuts);
        for (PieceMaker& maker : makers) maker.move_to(out_);
    }

    void tell(StepKind kind, std::uint32_t triangle) const {
        if (observer_ != nullptr) observer_->step({kind, triangle});
    }

    const Tree& below_;
    const Tree& top_;
    Order order_;
    int threads_;
    Observer* observer_;
    PieceMaker maker_;
    std::vector<Met> met_;
    OrderedPieces out_;
};

/// What moves and is on the page, on top of the tree.
Tree put_on_top(const ScreenScene& screen, const Tree& below, int threads) {
    std::vector<Face> faces;
    for (std::uint32_t t = 0; t < below.moving.size(); ++t)
        if (below.moving[t] != 0 && !screen_triangles(screen, t).empty())
            faces.push_back({t, Face::kNoCut, {}});
    if (faces.empty()) return {};
    const Surfaces surfaces(screen.scene(), below.grid);
    return in_arena(threads, [&] { return divide_space(surfaces, std::move(faces), &below); });
}

}  // namespace

OrderedPieces order_pieces(const ScreenScene& screen, const BspTree& tree, Order order, int threads,
                           Observer* observer) {
    const Tree& below = tree.data();
    const Tree top = put_on_top(screen, below, observer != nullptr ? 1 : threads);
    return Walk(screen, below, top, order, threads, observer).run();
}

BspTree tree_for(const ScreenScene& screen, const ResolveOptions& options) {
    const bool given = options.tree != nullptr && options.tree->fits(screen.scene());
    const int threads = options.observer != nullptr ? 1 : options.threads;
    return given ? *options.tree : make_tree(screen.scene(), {threads, {}});
}

}  // namespace bsp

namespace {

/// The cuts of pieces, as painting asks for them.
class BspCuts {
public:
    BspCuts(BspTree tree, bsp::OrderedPieces order, SampleUnits units)
        : tree_(std::move(tree)), order_(std::move(order)), units_(units) {}

    [[nodiscard]] Stretch narrow(const Piece& piece, std::int32_t row, Stretch stretch) const {
        const std::int32_t y = units_.position(row);
        const bsp::PageCut& any = order_.cuts[piece.first_cut];
        if (y < any.top || y > any.bottom) return {stretch.first, stretch.first};
        for (std::uint32_t k = piece.first_cut; k < piece.end_cut && stretch.first < stretch.end;
             ++k)
            stretch = narrow_by(order_.cuts[k], y, stretch);
        return stretch;
    }

    void report(const ResolveOptions& options) const {
        if (options.counters == nullptr) return;
        const BspStats stats = tree_.stats();
        count(options, "bsp nodes", stats.nodes);
        count(options, "bsp free planes", stats.free_planes);
        count(options, "bsp depth", stats.depth);
        count(options, "bsp splits", stats.splits);
        count(options, "bsp pieces", stats.pieces);
        count(options, "nodes met", order_.nodes_met);
        count(options, "pieces met", order_.parts_met);
        count(options, "back faces met", order_.back_faces_met);
        count(options, "pieces that moved", order_.moving_parts);
        count(options, "cuts on the page", order_.cuts.size());
    }

private:
    // What a cut holds of a row begins at the row's left end or reaches its right end.
    [[nodiscard]] Stretch narrow_by(const bsp::PageCut& cut, std::int32_t y,
                                    Stretch stretch) const {
        const double row = cut.on_row(y);
        const auto holds = [&](std::int32_t i) { return cut.holds_at(units_.position(i), row); };
        const std::int32_t last = stretch.end - 1;
        const bool left = holds(stretch.first), right = holds(last);
        if (left == right) return left ? stretch : Stretch{stretch.first, stretch.first};
        // One division, then its neighbours; halving ends the search in any case.
        const double zero = (-row / cut.line.x - units_.offset) / units_.step();
        auto guess = static_cast<std::int32_t>(
            std::clamp(zero, static_cast<double>(stretch.first), static_cast<double>(last)));
        std::int32_t low = stretch.first, high = last;  // as `left` at low, as `right` at high
        for (int probes = 0; high - low > 1; ++probes) {
            const std::int32_t i =
                probes < 3 ? std::clamp(guess, low + 1, high - 1) : low + (high - low) / 2;
            const bool like_left = holds(i) == left;
            (like_left ? low : high) = i;
            guess = like_left ? i + 1 : i - 1;
        }
        return left ? Stretch{stretch.first, high} : Stretch{high, stretch.end};
    }

    BspTree tree_;
    bsp::OrderedPieces order_;
    SampleUnits units_;
};

}  // namespace

std::unique_ptr<LayerSource> open_bsp_layers(const ScreenScene& screen, const SampleGrid& grid,
                                             const ResolveOptions& options) {
    const int threads = options.observer != nullptr ? 1 : options.threads;
    BspTree tree = bsp::tree_for(screen, options);
    bsp::OrderedPieces order =
        bsp::order_pieces(screen, tree, bsp::Order::back_to_front, threads, options.observer);
    std::vector<Piece> pieces = std::move(order.pieces);
    return std::make_unique<PieceLayers<BspCuts>>(
        screen, grid, options, std::move(pieces),
        BspCuts(std::move(tree), std::move(order), SampleUnits(grid, screen.subpixel_bits())));
}

std::unique_ptr<RowSource> open_bsp(const ScreenScene& screen, const SampleGrid& grid,
                                    const ResolveOptions& options) {
    return open_painted_rows(screen, grid, options, open_bsp_layers(screen, grid, options),
                             Ties::last_wins);
}

}  // namespace sightline
