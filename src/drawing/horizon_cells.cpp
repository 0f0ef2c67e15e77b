// What lies between the edges of a cell: the diagonal, or where the surface has breaks, the pieces
// that they leave.
//
// Around a cell, corners between two breaks belong together: they are a piece, whose last side
// leads from one break to the other. That side is the surface's rim. Lines of sight that leave the
// surface over a rim go on through the gap, so what the surface has hidden so far is set aside.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "drawing/horizon_sweep.hpp"

namespace sightline {

void HorizonSweep::inside(std::size_t layer, std::size_t column) {
    const std::vector<double>&near = near_.v[layer], &far = far_.v[layer];
    const double sum = near[column] + near[column + 1] + far[column] + far[column + 1];
    bool whole = !std::isnan(sum);
    if (whole && !plan_.has_cut[layer].empty()) {
        whole = is_whole(layer, across_edge(layer, column, near_)) &&
                is_whole(layer, across_edge(layer, column, far_)) &&
                is_whole(layer, depth_edge(layer, column)) &&
                is_whole(layer, depth_edge(layer, column + 1));
    }
    if (!whole) return broken_inside(layer, column);
    // The grid's diagonal leads from lower to higher x and z; rows may come the other way round.
    const std::size_t a = view_.forward() ? column : column + 1,
                      b = view_.forward() ? column + 1 : column;
    skylines_[layer].raise(slope_of({near_.u[a], near[a]}, {far_.u[b], far[b]}));
}

void HorizonSweep::broken_inside(std::size_t layer, std::size_t column) {
    const std::vector<double>& across = view_.across();
    const auto corner = [&](const Row& row, std::size_t c) {
        return Corner{{row.u[c], row.v[layer][c]}, {across[c], row.depth}};
    };
    // Around: near left, near right, far right, far left; side k leads from corner k to the next.
    const std::array<Corner, 4> corners = {corner(near_, column), corner(near_, column + 1),
                                           corner(far_, column + 1), corner(far_, column)};
    std::array<Parts, 4> sides = {parts_of(layer, across_edge(layer, column, near_)),
                                  parts_of(layer, depth_edge(layer, column + 1)),
                                  parts_of(layer, across_edge(layer, column, far_)),
                                  parts_of(layer, depth_edge(layer, column))};
    for (const std::size_t k : {std::size_t{2}, std::size_t{3}}) {  // these are met from behind
        std::swap(sides[k].has0, sides[k].has1);
        std::swap(sides[k].end0, sides[k].end1);
    }
    std::size_t begin = 0;
    while (begin < 4 && sides[begin].whole) ++begin;
    if (begin == 4) return;
    patches_.clear();
    for (std::size_t n = 0; n < 4; ++n) {
        const std::size_t side = (begin + n) % 4, next = (side + 1) % 4;
        if (!sides[side].whole) {
            patches_.emplace_back();
            if (sides[side].has1) patches_.back().push_back(sides[side].end1);
        }
        if (std::isnan(corners[next].seen.y)) continue;
        patches_.back().push_back(corners[next]);
        if (!sides[next].whole) patches_.back().push_back(sides[next].end0);
    }
    const glm::dvec2 sight = view_.sight(0.5 * (corners[0].plan + corners[2].plan));
    const auto key = [&](const Patch& patch) {
        glm::dvec2 sum(0, 0);
        for (const Corner& c : patch) sum += c.plan;
        return glm::dot(sum, sight) / static_cast<double>(patch.size());
    };
    std::erase_if(patches_, [](const Patch& patch) { return patch.size() < 2; });
    std::sort(patches_.begin(), patches_.end(),
              [&](const Patch& a, const Patch& b) { return key(a) < key(b); });
    for (const Patch& patch : patches_) put_patch(layer, patch);
}

void HorizonSweep::put_patch(std::size_t layer, const Patch& patch) {
    Skyline& skyline = skylines_[layer];
    for (std::size_t k = 2; k + 1 < patch.size(); ++k)
        skyline.raise(slope_of(patch[0].seen, patch[k].seen));
    const Corner &a = patch.back(), &b = patch.front();
    const Slope rim = slope_of(a.seen, b.seen);
    skyline.raise(rim);
    // The piece is to the left of its rim.
    const glm::dvec2 along = b.plan - a.plan, sight = view_.sight(0.5 * (a.plan + b.plan));
    const bool leaves = along.y * sight.x - along.x * sight.y > 0;
    if (leaves && plan_.grid.layers[layer].open_gaps) skyline.set_aside(rim.u0, rim.u1);
}

}  // namespace sightline
