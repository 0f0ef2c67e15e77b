// Roots on the edges of one layer of a grid.
#include "plot/section_layer.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace sightline {
namespace {

/// Roots so near to a node, as a part of the edge, become the node: triangles would have no shape
/// there. The surface moves by no more than this, which no page shows.
constexpr double kAtNode = 1e-9;

glm::dvec3 node_at(const SectionGrid& grid, std::size_t i, std::size_t j, std::size_t k) {
    return {grid.x[i], grid.y[j], grid.z[k]};
}

/// Follows the edges of one layer.
class CrossingFinder {
public:
    CrossingFinder(Evaluator& value, const SectionGrid& grid, std::size_t k, double noise,
                   SectionLayer& layer, const SectionLayer* above)
        : value_(value), grid_(grid), k_(k), noise_(noise), layer_(layer), above_(above) {}

    void run() {
        const std::size_t nx = grid_.x.size(), ny = grid_.y.size();
        layer_.edges.assign(nx * ny, 0);
        for (std::size_t j = 0; j < ny; ++j)
            for (std::size_t i = 0; i < nx; ++i) visit_node(i, j);
    }

private:
    void visit_node(std::size_t i, std::size_t j) {
        const std::size_t nx = grid_.x.size(), node = j * nx + i;
        const Sign sign = layer_.sign[node];
        if (sign == Sign::none) return;
        for (unsigned direction = 1; direction <= kDirections; ++direction) {
            const std::size_t di = direction & 1u, dj = direction >> 1 & 1u, dk = direction >> 2;
            if (i + di >= nx || j + dj >= grid_.y.size() || (dk == 1 && above_ == nullptr))
                continue;
            const SectionLayer& other = dk == 1 ? *above_ : layer_;
            const std::size_t end = node + dj * nx + di;
            if (other.sign[end] == sign || other.sign[end] == Sign::none) continue;
            const glm::dvec3 base = node_at(grid_, i, j, k_);
            const Bracket bracket{base, node_at(grid_, i + di, j + dj, k_ + dk), layer_.value[node],
                                  other.value[end]};
            const EdgeState state = cross(bracket);
            layer_.edges[node] |= static_cast<std::uint32_t>(state) << 3 * (direction - 1);
            if (state == EdgeState::at_base || (state == EdgeState::at_end && dk == 0))
                layer_.used.push_back(
                    static_cast<std::uint32_t>(state == EdgeState::at_base ? node : end));
            else if (state == EdgeState::at_end)
                layer_.used_up.push_back(static_cast<std::uint32_t>(end));
        }
    }

    EdgeState cross(const Bracket& bracket) {
        const std::optional<double> t = find_root(value_, bracket, noise_);
        if (!t) return EdgeState::broken;
        const glm::dvec3 raw = bracket.from + *t * (bracket.to - bracket.from);
        const glm::dvec3 point = glm::min(raw, bracket.to);  // rounding must not leave the cell
        if (*t < kAtNode || point == bracket.from) return EdgeState::at_base;
        if (*t > 1 - kAtNode || point == bracket.to) return EdgeState::at_end;
        layer_.crossings.push_back(point);
        return EdgeState::crossed;
    }

    Evaluator& value_;
    const SectionGrid& grid_;
    std::size_t k_;
    double noise_;
    SectionLayer& layer_;
    const SectionLayer* above_;
};

}  // namespace

void evaluate_layer(Evaluator& value, const SectionGrid& grid, std::size_t k, SectionLayer& layer) {
    layer.value.clear();
    layer.sign.clear();
    layer.value.reserve(grid.x.size() * grid.y.size());
    layer.sign.reserve(grid.x.size() * grid.y.size());
    for (const double y : grid.y) {
        for (const double x : grid.x) {
            const double f = value({x, y, grid.z[k]});
            layer.value.push_back(f);
            layer.sign.push_back(!std::isfinite(f) ? Sign::none
                                 : f >= 0          ? Sign::positive
                                                   : Sign::negative);
        }
    }
}

void find_crossings(Evaluator& value, const SectionGrid& grid, std::size_t k, double noise,
                    SectionLayer& layer, const SectionLayer* above) {
    CrossingFinder(value, grid, k, noise, layer, above).run();
}

void number_vertices(const SectionGrid& grid, std::size_t k, SectionLayer& layer,
                     const SectionLayer* below) {
    const std::size_t nx = grid.x.size(), nodes = layer.edges.size();
    layer.vertices.assign(nodes, 0);
    for (std::size_t node = 0; node < nodes; ++node) {
        if (layer.edges[node] == 0) continue;
        for (unsigned direction = 1; direction <= kDirections; ++direction)
            if (layer.state(node, direction) == EdgeState::crossed)
                layer.vertices[node] |= static_cast<std::uint8_t>(1u << (direction - 1));
    }
    for (const std::uint32_t node : layer.used) layer.vertices[node] |= 0x80;
    if (below != nullptr)
        for (const std::uint32_t node : below->used_up) layer.vertices[node] |= 0x80;
    layer.first.assign(nodes, 0);
    auto crossing = layer.crossings.begin();
    for (std::size_t node = 0; node < nodes; ++node) {
        layer.first[node] = static_cast<std::uint32_t>(layer.points.size());
        const unsigned bits = layer.vertices[node];
        for (int n = std::popcount(bits & 0x7Fu); n > 0; --n) layer.points.push_back(*crossing++);
        layer.node_point.resize(layer.points.size(), 0);
        if ((bits & 0x80) == 0) continue;
        layer.points.push_back(node_at(grid, node % nx, node / nx, k));
        layer.node_point.push_back(1);
    }
    layer.crossings = {};
}

}  // namespace sightline
