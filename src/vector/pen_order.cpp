// Nearest end first, through a k-d tree from which ends are removed (J. L. Bentley,
// "Multidimensional binary search trees used for associative searching", 1975).
//
// The tree is implicit: the node of the range [low, high) of the sorted array is its middle element
// and its children are the halves beside it. A count of live elements a node keeps searches out of
// what is used up. Distances to boxes grow with each plane that is crossed (S. Arya and D. M.
// Mount, 1993). Of equally near ends the lower number is taken, so the answer does not depend on
// the shape of the tree.
#include "vector/pen_order.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "sightline/scene.hpp"

namespace sightline {
namespace {

class Ends {
public:
    explicit Ends(std::vector<glm::dvec2> points)
        : points_(std::move(points)),
          order_(points_.size()),
          place_(points_.size()),
          live_(points_.size()),
          gone_(points_.size(), 0) {
        std::iota(order_.begin(), order_.end(), 0u);
        build(whole());
        for (std::uint32_t i = 0; i < order_.size(); ++i) place_[order_[i]] = i;
    }

    /// The live end that is nearest to a point; kNone when there is none.
    [[nodiscard]] std::uint32_t nearest(glm::dvec2 from) const {
        Search search{from, kNone, std::numeric_limits<double>::infinity()};
        look(whole(), glm::dvec2(0), search);
        return search.best;
    }

    void remove(std::uint32_t end) {
        const std::uint32_t at = place_[end];
        gone_[end] = 1;
        for (Range r = whole();;) {
            --live_[r.middle()];
            if (at == r.middle()) return;
            r = at < r.middle() ? r.lower() : r.upper();
        }
    }

    [[nodiscard]] glm::dvec2 operator[](std::uint32_t end) const { return points_[end]; }

private:
    struct Range {
        std::uint32_t low, high;
        int axis;
        [[nodiscard]] std::uint32_t middle() const { return low + (high - low) / 2; }
        [[nodiscard]] Range lower() const { return {low, middle(), 1 - axis}; }
        [[nodiscard]] Range upper() const { return {middle() + 1, high, 1 - axis}; }
        [[nodiscard]] bool empty() const { return low == high; }
    };
    struct Search {
        glm::dvec2 from;
        std::uint32_t best;
        double distance;  // squared
    };

    [[nodiscard]] Range whole() const { return {0, static_cast<std::uint32_t>(order_.size()), 0}; }

    void build(Range r) {
        if (r.empty()) return;
        std::nth_element(order_.begin() + r.low, order_.begin() + r.middle(),
                         order_.begin() + r.high, [&](std::uint32_t a, std::uint32_t b) {
                             return points_[a][r.axis] < points_[b][r.axis];
                         });
        live_[r.middle()] = r.high - r.low;
        build(r.lower());
        build(r.upper());
    }

    /// `beside` is how far the range's box is away from the point along each axis, at least.
    void look(Range r, glm::dvec2 beside, Search& search) const {
        if (r.empty() || live_[r.middle()] == 0) return;
        if (beside.x * beside.x + beside.y * beside.y > search.distance) return;
        const std::uint32_t end = order_[r.middle()];
        const glm::dvec2 way = points_[end] - search.from;
        const double distance = way.x * way.x + way.y * way.y;
        const bool nearer =
            distance < search.distance || (distance == search.distance && end < search.best);
        if (gone_[end] == 0 && nearer) {
            search.best = end;
            search.distance = distance;
        }
        glm::dvec2 across = beside;
        across[r.axis] = std::max(beside[r.axis], std::abs(way[r.axis]));
        const bool below = search.from[r.axis] < points_[end][r.axis];
        look(below ? r.lower() : r.upper(), beside, search);
        look(below ? r.upper() : r.lower(), across, search);
    }

    std::vector<glm::dvec2> points_;    // end 2p is the beginning of path p, 2p + 1 its end
    std::vector<std::uint32_t> order_;  // ends as the tree has them
    std::vector<std::uint32_t> place_;  // of an end in order_
    std::vector<std::uint32_t> live_;   // in the range whose middle this is
    std::vector<std::uint8_t> gone_;    // by end
};

void append(const Paths& from, std::uint32_t path, bool turned, Paths& to) {
    const std::uint32_t begin = from.first_point[path], end = from.first_point[path + 1];
    to.kind.push_back(from.kind[path]);
    to.visible.push_back(from.visible[path]);
    to.object.push_back(from.object[path]);
    if (turned) {
        for (std::uint32_t i = end; i-- > begin;) to.points.push_back(from.points[i]);
        for (std::uint32_t i = end - 1; i-- > begin;) to.part.push_back(from.part[i]);
        to.part.push_back(kNone);
    } else {
        for (std::uint32_t i = begin; i < end; ++i) to.points.push_back(from.points[i]);
        for (std::uint32_t i = begin; i < end; ++i) to.part.push_back(from.part[i]);
    }
    to.first_point.push_back(static_cast<std::uint32_t>(to.points.size()));
}

/// Appends the paths first .. last - 1 from where the pen is, and moves the pen.
void append_layer(const Paths& paths, std::uint32_t first, std::uint32_t last, glm::dvec2& pen,
                  Paths& out) {
    std::vector<glm::dvec2> points;
    for (std::uint32_t p = first; p < last; ++p) {
        points.push_back(paths.points[paths.first_point[p]]);
        points.push_back(paths.points[paths.first_point[p + 1] - 1]);
    }
    Ends ends(std::move(points));
    for (std::uint32_t i = first; i < last; ++i) {
        const std::uint32_t end = ends.nearest(pen);
        append(paths, first + end / 2, end % 2 == 1, out);
        ends.remove(end);
        ends.remove(end ^ 1u);
        pen = ends[end ^ 1u];
    }
}

}  // namespace

Paths in_pen_order(const Paths& paths) {
    Paths out;
    out.first_point.push_back(0);
    glm::dvec2 pen(0);
    const auto count = static_cast<std::uint32_t>(paths.size());
    for (std::uint32_t first = 0; first < count;) {
        std::uint32_t last = first + 1;
        while (last < count && paths.visible[last] == paths.visible[first] &&
               paths.kind[last] == paths.kind[first]) {
            ++last;
        }
        append_layer(paths, first, last, pen, out);
        first = last;
    }
    return out;
}

}  // namespace sightline
