// Source: A. Doi, A. Koide, "An Efficient Method of Triangulating Equi-Valued Surfaces by Using
// Tetrahedral Cells", IEICE Transactions E74(1), 1991, on H. Kuhn's subdivision of a cube into six
// tetrahedra about its main diagonal, which is the same in every cell, so that neighbours agree.
//
// How this version differs: vertices are roots of the field itself and not of its interpolation; a
// root at a node is one vertex, whatever edges lead there, and pairs of triangles that fall on each
// other because of it cancel out; tetrahedra are left out where the field has no value or jumps.
// The grid is taken a few layers at a time.
#include "plot/section_mesh.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <tuple>

#include "math/arena.hpp"
#include "plot/section_layer.hpp"

namespace sightline {
namespace {

constexpr std::size_t kBatch = 32;  // layers that are worked on at a time

/// A corner of a cell is a set of axes, as a direction is. Each tetrahedron is a chain of such
/// sets from 0 to 7, in an order that makes its volume positive.
using Tetrahedron = std::array<unsigned, 4>;
constexpr std::array<Tetrahedron, 6> kTetrahedra = {{
    {0, 1, 3, 7},
    {0, 2, 6, 7},
    {0, 4, 5, 7},
    {0, 3, 2, 7},
    {0, 6, 4, 7},
    {0, 5, 1, 7},
}};

/// The corners of a tetrahedron in an order of positive volume that begins with a given one.
constexpr std::array<std::array<unsigned, 4>, 4> kBeginningWith = {{
    {0, 1, 2, 3},
    {1, 0, 3, 2},
    {2, 0, 1, 3},
    {3, 0, 2, 1},
}};

/// Follows the surface through the cells between two layers.
class SlabMesher {
public:
    SlabMesher(const SectionGrid& grid, const SectionLayer& low, const SectionLayer& high)
        : nx_(grid.x.size()), ny_(grid.y.size()), low_(low), high_(high) {}

    AlignedVector<Corners> run() {
        for (std::size_t j = 0; j + 1 < ny_; ++j)
            for (std::size_t i = 0; i + 1 < nx_; ++i) visit_cell(j * nx_ + i);
        return std::move(triangles_);
    }

private:
    [[nodiscard]] const SectionLayer& layer(unsigned corner) const {
        return corner >> 2 != 0 ? high_ : low_;
    }
    [[nodiscard]] std::size_t node(unsigned corner) const {
        return node_ + (corner >> 1 & 1u) * nx_ + (corner & 1u);
    }

    void visit_cell(std::size_t at) {
        node_ = at;
        bool all_equal = true;
        for (unsigned corner = 0; corner < 8; ++corner) {
            signs_[corner] = layer(corner).sign[node(corner)];
            all_equal = all_equal && signs_[corner] == signs_[0];
        }
        if (all_equal) return;
        for (const Tetrahedron& tetrahedron : kTetrahedra) visit(tetrahedron);
    }

    void visit(const Tetrahedron& t) {
        unsigned positive = 0;
        for (unsigned k = 0; k < 4; ++k) {
            if (signs_[t[k]] == Sign::none) return;
            if (signs_[t[k]] == Sign::positive) positive |= 1u << k;
        }
        const int count = std::popcount(positive);
        if (count == 0 || count == 4) return;
        if (count == 2) {
            cut_in_half(t, positive);
        } else {
            const unsigned alone = count == 1 ? positive : ~positive & 15u;
            cut_off(t, static_cast<unsigned>(std::countr_zero(alone)), count == 1);
        }
    }

    /// One corner is on one side, three on the other.
    void cut_off(const Tetrahedron& t, unsigned alone, bool is_positive) {
        const auto& order = kBeginningWith[alone];
        std::array<std::uint32_t, 3> v{};
        for (unsigned k = 0; k < 3; ++k)
            if (!find(t[order[0]], t[order[k + 1]], v[k])) return;
        if (is_positive) std::swap(v[1], v[2]);
        add(v[0], v[1], v[2]);
    }

    void cut_in_half(const Tetrahedron& t, unsigned positive) {
        // i and j are negative, k and l positive, and the order i, j, k, l has a positive volume.
        const auto i = static_cast<unsigned>(std::countr_zero(~positive & 15u));
        const auto& order = kBeginningWith[i];
        unsigned j = 1;
        while ((positive >> order[j] & 1u) != 0) ++j;
        const unsigned a = t[i], b = t[order[j]], c = t[order[j % 3 + 1]],
                       d = t[order[(j + 1) % 3 + 1]];
        std::uint32_t ac = 0, ad = 0, bd = 0, bc = 0;
        if (!find(a, c, ac) || !find(a, d, ad) || !find(b, d, bd) || !find(b, c, bc)) return;
        const auto square = [&](std::uint32_t p, std::uint32_t q) {
            const glm::dvec3 way = point(p) - point(q);
            return glm::dot(way, way);
        };
        if (square(ac, bd) <= square(ad, bc)) {
            add(ac, ad, bd);
            add(ac, bd, bc);
        } else {
            add(ac, ad, bc);
            add(ad, bd, bc);
        }
    }

    /// The vertex on the edge between two corners of the cell; false when there is no root.
    bool find(unsigned u, unsigned w, std::uint32_t& vertex) const {
        const unsigned base = u & w, end = u | w, direction = u ^ w;
        const SectionLayer& owner = layer(base);
        switch (owner.state(node(base), direction)) {
            case EdgeState::crossed:
                vertex = owner.vertex(node(base), direction - 1);
                return true;
            case EdgeState::at_base:
                vertex = owner.vertex(node(base), kDirections);
                return true;
            case EdgeState::at_end:
                vertex = layer(end).vertex(node(end), kDirections);
                return true;
            default:
                return false;
        }
    }
    [[nodiscard]] const glm::dvec3& point(std::uint32_t vertex) const {
        return vertex < high_.offset ? low_.points[vertex - low_.offset]
                                     : high_.points[vertex - high_.offset];
    }
    void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        if (a != b && b != c && c != a) triangles_.emplace_back(a, b, c);
    }

    std::size_t nx_, ny_;
    const SectionLayer &low_, &high_;
    std::size_t node_ = 0;  // the cell's first corner
    std::array<Sign, 8> signs_{};
    AlignedVector<Corners> triangles_;
};

/// A triangle by its corners, whichever way round.
struct Unturned {
    Corners sorted;
    bool turned = false;
    std::size_t index = 0;

    Unturned(Corners c, std::size_t at) : sorted(c), index(at) {
        const auto order = [&](int a, int b) {
            if (sorted[a] <= sorted[b]) return;
            std::swap(sorted[a], sorted[b]);
            turned = !turned;
        };
        order(0, 1);
        order(1, 2);
        order(0, 1);
    }
    [[nodiscard]] auto key() const { return std::tuple(sorted.x, sorted.y, sorted.z, turned); }
};

/// Removes pairs of triangles with the same corners that are turned opposite ways. Only such with
/// nodes for all of their corners can lie in two cells.
void cancel_pairs(const std::vector<std::uint8_t>& is_node, AlignedVector<Corners>& triangles) {
    std::vector<Unturned> flat;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const Corners c = triangles[t];
        if (is_node[c.x] != 0 && is_node[c.y] != 0 && is_node[c.z] != 0) flat.emplace_back(c, t);
    }
    std::ranges::sort(flat, [](const Unturned& a, const Unturned& b) { return a.key() < b.key(); });
    bool some = false;
    for (std::size_t k = 0; k + 1 < flat.size(); ++k) {
        const Unturned &a = flat[k], &b = flat[k + 1];
        if (a.sorted != b.sorted || a.turned == b.turned) continue;
        triangles[a.index] = triangles[b.index] = Corners(0);
        some = true;
        ++k;
    }
    if (some) std::erase(triangles, Corners(0));
}

class FieldMesher {
public:
    FieldMesher(const Field& field, const SectionGrid& grid)
        : grid_(grid), evaluators_(field), layers_(grid.z.size()) {
        noise_ = kNoise * usual_size(evaluators_.local(), grid.lo(), grid.hi());
    }

    /// False when the progress function said so.
    bool run(const std::function<bool(double)>& progress) {
        for (std::size_t begin = 0; begin < layers_.size(); begin += kBatch) {
            if (progress &&
                !progress(static_cast<double>(begin) / static_cast<double>(layers_.size())))
                return false;
            take(begin, std::min(begin + kBatch, layers_.size()));
        }
        cancel_pairs(is_node_, mesh_.triangles);
        return true;
    }
    SectionMesh mesh() { return std::move(mesh_); }

private:
    /// Layers up to `end`, and the cells between them and from the last one of the batch before.
    void take(std::size_t begin, std::size_t end) {
        const std::size_t n = layers_.size();
        tbb::parallel_for(begin == 0 ? 0 : begin + 1, std::min(end + 1, n), [&](std::size_t k) {
            evaluate_layer(evaluators_.local(), grid_, k, layers_[k]);
        });
        tbb::parallel_for(begin, end, [&](std::size_t k) {
            find_crossings(evaluators_.local(), grid_, k, noise_, layers_[k],
                           k + 1 < n ? &layers_[k + 1] : nullptr);
        });
        tbb::parallel_for(begin, end, [&](std::size_t k) {
            number_vertices(grid_, k, layers_[k], k > 0 ? &layers_[k - 1] : nullptr);
        });
        for (std::size_t k = begin; k < end; ++k) {
            SectionLayer& layer = layers_[k];
            layer.offset = static_cast<std::uint32_t>(mesh_.points.size());
            mesh_.points.insert(mesh_.points.end(), layer.points.begin(), layer.points.end());
            is_node_.insert(is_node_.end(), layer.node_point.begin(), layer.node_point.end());
        }
        const std::size_t first = begin == 0 ? 0 : begin - 1;
        std::vector<AlignedVector<Corners>> slabs(end - 1 - first);
        tbb::parallel_for(std::size_t{0}, slabs.size(), [&](std::size_t s) {
            slabs[s] = SlabMesher(grid_, layers_[first + s], layers_[first + s + 1]).run();
        });
        for (const AlignedVector<Corners>& slab : slabs)
            mesh_.triangles.insert(mesh_.triangles.end(), slab.begin(), slab.end());
        for (std::size_t k = first; k + 1 < end; ++k) layers_[k] = {};
    }

    const SectionGrid& grid_;
    Evaluators evaluators_;
    double noise_ = 0;
    std::vector<SectionLayer> layers_;  // those of the batch are filled
    SectionMesh mesh_;
    std::vector<std::uint8_t> is_node_;  // of each point: it is a node
};

}  // namespace

Result<SectionMesh> mesh_of_field(const Field& field, const SectionGrid& grid, int threads,
                                  const std::function<bool(double)>& progress) {
    FieldMesher mesher(field, grid);
    if (!in_arena(threads, [&] { return mesher.run(progress); }))
        return Error{ErrorKind::cancelled, "the plot was stopped before it was done"};
    return mesher.mesh();
}

}  // namespace sightline
