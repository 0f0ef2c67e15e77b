// The order in which a BSP tree gives the surfaces of a scene, and their parts on the page.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sightline/bsp.hpp"
#include "visibility/painting.hpp"

namespace sightline::bsp {

/// The half of the page on which a part of a surface lies: where l x + m y + n > 0, and where it is
/// 0 if `closed`; x and y in units of the screen. The other half has the factors with opposite
/// signs and is closed when this one is not, so that every sample lies in exactly one of the two.
struct PageCut {
    glm::dvec3 line{0, 0, 0};
    bool closed = true;
    /// The piece to which the cut belongs has no samples above or below; the same in all of its
    /// cuts.
    std::int32_t top = 0, bottom = 0;

    /// In this order and nothing else: the first product alone depends on x, and rounding is
    /// monotone, so what a row has inside begins at its left end or runs up to its right end.
    [[nodiscard]] bool holds(std::int32_t x, std::int32_t y) const {
        return holds_at(x, on_row(y));
    }
    [[nodiscard]] double on_row(std::int32_t y) const { return line.y * y + line.z; }
    [[nodiscard]] bool holds_at(std::int32_t x, double row) const {
        const double value = line.x * x + row;
        return closed ? value >= 0 : value > 0;
    }
};

enum class Order { back_to_front, front_to_back };

/// Pieces in their order; their cuts are numbers of `cuts`.
struct OrderedPieces {
    std::vector<Piece> pieces;
    std::vector<PageCut> cuts;
    std::uint64_t nodes_met = 0;
    std::uint64_t parts_met = 0;       ///< of triangles, seen or not
    std::uint64_t back_faces_met = 0;  ///< of these, how many show their back
    std::uint64_t moving_parts = 0;    ///< of these, how many moved on top of the tree
};

/// The order of all that is drawn in a view. Triangles that the tree leaves out are put on top of
/// it first. O(tree), and O(m log tree) for m triangles that move.
/// `observer`, when there is one, is told of nodes and pieces.
[[nodiscard]] OrderedPieces order_pieces(const ScreenScene& screen, const BspTree& tree,
                                         Order order = Order::back_to_front, int threads = 0,
                                         Observer* observer = nullptr);

/// The tree of the options, where it fits the scene, else one made for it.
[[nodiscard]] BspTree tree_for(const ScreenScene& screen, const ResolveOptions& options);

}  // namespace sightline::bsp
