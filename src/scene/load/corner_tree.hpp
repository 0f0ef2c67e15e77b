// The corners of a polygon in the plane, to look up marked ones inside of a triangle.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

namespace sightline::load {

/// Twice the signed area of a triangle: positive when a, b, c turn left.
[[nodiscard]] inline double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// A balanced tree of boxes (J. L. Bentley, "Multidimensional Binary Search Trees Used for
/// Associative Searching", 1975) whose nodes know how many of their corners are marked. Built in
/// O(n log n); a mark takes O(log n), a search O(sqrt n) but for corners on the triangle's border.
class CornerTree {
public:
    /// `points` must outlive the tree. No corner is marked.
    void build(std::span<const glm::dvec2> points);
    void mark(std::uint32_t corner, bool marked);

    /// Whether found(corner) is true for one of the marked corners that lie in a triangle that
    /// turns left, its border included: those strictly inside are not even asked for. Adds the
    /// steps it took to `work`.
    template <class Found>
    [[nodiscard]] bool any_in(const std::array<glm::dvec2, 3>& triangle, std::uint64_t& work,
                              const Found& found) const;

private:
    struct Node {
        glm::dvec2 lo, hi;
        std::uint32_t begin, end;           // in order_
        std::uint32_t parent, first_child;  // 0: it has no children; the second is the next
        std::uint32_t marked = 0;           // corners in it
    };
    enum class Place { outside, across, inside };

    static constexpr std::uint32_t kLeaf = 8;  // corners that are not divided any more

    void divide(std::uint32_t node);
    /// Where a box lies to a triangle. This is exactly what turn() says of each point of the box:
    /// its roundings keep the order.
    [[nodiscard]] static Place place_of(const Node& node,
                                        const std::array<glm::dvec2, 3>& triangle);

    std::span<const glm::dvec2> points_;
    std::vector<Node> nodes_;
    std::vector<std::uint32_t> order_;
    std::vector<std::uint32_t> leaf_of_;  // of each corner
    std::vector<std::uint8_t> marks_;
};

template <class Found>
bool CornerTree::any_in(const std::array<glm::dvec2, 3>& triangle, std::uint64_t& work,
                        const Found& found) const {
    std::array<std::uint32_t, 64> open{};  // the depth is at most 32
    std::size_t count = 1;
    while (count > 0) {
        const Node& node = nodes_[open[--count]];
        ++work;
        if (node.marked == 0) continue;
        const Place place = place_of(node, triangle);
        if (place == Place::inside) return true;
        if (place == Place::outside) continue;
        if (node.first_child != 0) {
            open[count++] = node.first_child + 1;
            open[count++] = node.first_child;
            continue;
        }
        work += node.end - node.begin;
        for (std::uint32_t i = node.begin; i < node.end; ++i)
            if (marks_[order_[i]] != 0 && found(order_[i])) return true;
    }
    return false;
}

}  // namespace sightline::load
