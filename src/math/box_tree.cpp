#include "math/box_tree.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "math/arena.hpp"
#include "math/morton.hpp"

namespace sightline {

namespace {

/// Coordinates within 2^24 of the origin; 25 bits each, under four bits for the class of size.
std::uint64_t packing_key(const PageBox& box) {
    const auto size = static_cast<std::uint32_t>(std::max(box.x1 - box.x0, box.y1 - box.y0));
    const auto size_class = static_cast<std::uint64_t>(std::bit_width(size) / 2);
    return size_class << 52 |
           morton_code(box.x0 + (box.x1 - box.x0) / 2, box.y0 + (box.y1 - box.y0) / 2);
}

}  // namespace

void PageBox::include(const PageBox& other) {
    x0 = std::min(x0, other.x0);
    x1 = std::max(x1, other.x1);
    y0 = std::min(y0, other.y0);
    y1 = std::max(y1, other.y1);
    far = std::max(far, other.far);
}

BoxTree::BoxTree(const std::vector<PageBox>& boxes, int threads) {
    const std::size_t n = boxes.size();
    if (n == 0) return;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(n);
    for (std::size_t k = 0; k < n; ++k)
        keys[k] = {packing_key(boxes[k]), static_cast<std::uint32_t>(k)};
    in_arena(threads, [&] { tbb::parallel_sort(keys); });
    items_.resize(n);
    place_of_.resize(n);
    Level leaves{std::vector<PageBox>(n), std::vector<std::uint32_t>(n, 1)};
    for (std::size_t k = 0; k < n; ++k) {
        items_[k] = keys[k].second;
        place_of_[items_[k]] = static_cast<std::uint32_t>(k);
        leaves.boxes[k] = boxes[items_[k]];
    }
    levels_.push_back(std::move(leaves));
    while (levels_.back().boxes.size() > kFanOut) {
        const Level& below = levels_.back();
        Level level;
        for (std::size_t k = 0; k < below.boxes.size(); ++k) {
            if (k % kFanOut == 0) {
                level.boxes.push_back(below.boxes[k]);
                level.left.push_back(0);
            }
            level.boxes.back().include(below.boxes[k]);
            level.left.back() += below.left[k];
        }
        levels_.push_back(std::move(level));
    }
}

void BoxTree::remove(std::uint32_t item) {
    std::uint32_t node = place_of_[item];
    for (Level& level : levels_) {
        --level.left[node];
        node /= kFanOut;
    }
}

}  // namespace sightline
