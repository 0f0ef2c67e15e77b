// A tree of boxes of the page: which polygons can overlap this one?
//
// Source: A. Guttman, "R-trees", 1984; I. Kamel, C. Faloutsos, "On Packing R-trees", 1993. How this
// version differs: it is packed once, in Morton order within classes of size, so that large boxes
// do not swell the nodes of small ones; boxes know the farthest z in them; and what is done with is
// taken out by counting down, so that searches pass over it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "math/page_line.hpp"

namespace sightline {

/// The extents of a polygon. Boxes that only touch do not overlap.
struct PageBox : PageBounds {
    std::int32_t far = 0;  ///< the deepest z in it

    [[nodiscard]] bool overlaps(const PageBounds& other) const {
        return x0 < other.x1 && other.x0 < x1 && y0 < other.y1 && other.y0 < y1;
    }
    void include(const PageBox& other);
};

class BoxTree {
public:
    /// O(n log n), on all cores; 0 threads = all.
    BoxTree(const std::vector<PageBox>& boxes, int threads);

    /// visit(item) for every item still in the tree whose box overlaps `box` and reaches at least
    /// as deep as z = `near`. In an order that depends on the boxes alone.
    template <class Visit>
    void search(const PageBox& box, std::int32_t near, const Visit& visit) const;

    /// Takes an item out. O(log n).
    void remove(std::uint32_t item);

private:
    static constexpr std::uint32_t kFanOut = 8;

    /// A level: its boxes, and how many items are left in each. The children of node k are
    /// kFanOut * k and the following ones of the level below.
    struct Level {
        std::vector<PageBox> boxes;
        std::vector<std::uint32_t> left;
    };

    template <class Visit>
    void search_node(std::size_t level, std::uint32_t node, const PageBox& box, std::int32_t near,
                     const Visit& visit) const;

    std::vector<std::uint32_t> items_;     // in their packed order
    std::vector<std::uint32_t> place_of_;  // of each item
    std::vector<Level> levels_;            // the items' boxes first, the root last
};

template <class Visit>
void BoxTree::search(const PageBox& box, std::int32_t near, const Visit& visit) const {
    if (levels_.empty()) return;
    for (std::uint32_t k = 0; k < levels_.back().boxes.size(); ++k)
        search_node(levels_.size() - 1, k, box, near, visit);
}

template <class Visit>
void BoxTree::search_node(std::size_t level, std::uint32_t node, const PageBox& box,
                          std::int32_t near, const Visit& visit) const {
    const PageBox& own = levels_[level].boxes[node];
    if (levels_[level].left[node] == 0 || own.far < near || !own.overlaps(box)) return;
    if (level == 0) {
        visit(items_[node]);
        return;
    }
    const auto count = static_cast<std::uint32_t>(levels_[level - 1].boxes.size());
    const std::uint32_t end = node * kFanOut + kFanOut < count ? node * kFanOut + kFanOut : count;
    for (std::uint32_t child = node * kFanOut; child < end; ++child)
        search_node(level - 1, child, box, near, visit);
}

}  // namespace sightline
