#include "scene/load/corner_tree.hpp"

#include <algorithm>
#include <glm/common.hpp>
#include <numeric>

namespace sightline::load {

void CornerTree::build(std::span<const glm::dvec2> points) {
    points_ = points;
    const auto n = static_cast<std::uint32_t>(points.size());
    order_.resize(n);
    std::iota(order_.begin(), order_.end(), 0u);
    leaf_of_.assign(n, 0);
    marks_.assign(n, 0);
    nodes_.clear();
    nodes_.push_back({{}, {}, 0, n, 0, 0});
    for (std::uint32_t node = 0; node < nodes_.size(); ++node) divide(node);
}

void CornerTree::divide(std::uint32_t node) {
    const std::uint32_t begin = nodes_[node].begin, end = nodes_[node].end;
    const auto corners = std::span(order_).subspan(begin, end - begin);
    glm::dvec2 lo = points_[corners[0]], hi = lo;
    for (const std::uint32_t corner : corners) {
        lo = glm::min(lo, points_[corner]);
        hi = glm::max(hi, points_[corner]);
        leaf_of_[corner] = node;
    }
    nodes_[node].lo = lo;
    nodes_[node].hi = hi;
    if (corners.size() <= kLeaf) return;
    const int axis = hi.x - lo.x >= hi.y - lo.y ? 0 : 1;
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(
        order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
        [&](std::uint32_t a, std::uint32_t b) { return points_[a][axis] < points_[b][axis]; });
    nodes_[node].first_child = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({{}, {}, begin, middle, node, 0});
    nodes_.push_back({{}, {}, middle, end, node, 0});
}

void CornerTree::mark(std::uint32_t corner, bool marked) {
    if ((marks_[corner] != 0) == marked) return;
    marks_[corner] = marked ? 1 : 0;
    for (std::uint32_t node = leaf_of_[corner];; node = nodes_[node].parent) {
        nodes_[node].marked += marked ? 1u : ~0u;
        if (node == 0) return;
    }
}

CornerTree::Place CornerTree::place_of(const Node& node,
                                       const std::array<glm::dvec2, 3>& triangle) {
    Place place = Place::inside;
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 &a = triangle[k], &b = triangle[k == 2 ? 0 : k + 1];
        // turn() grows with y where the side runs to the right, and with x where it runs down.
        const bool up = b.x - a.x >= 0, right = b.y - a.y <= 0;
        const glm::dvec2 most{right ? node.hi.x : node.lo.x, up ? node.hi.y : node.lo.y};
        if (turn(a, b, most) < 0) return Place::outside;
        const glm::dvec2 least{right ? node.lo.x : node.hi.x, up ? node.lo.y : node.hi.y};
        if (!(turn(a, b, least) > 0)) place = Place::across;
    }
    return place;
}

}  // namespace sightline::load
