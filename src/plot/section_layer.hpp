// One layer of a grid (the nodes with one z) while a surface is followed through it.
//
// Notation. A direction 1..7 is a set of axes: bit 0 x, bit 1 y, bit 2 z. An edge runs from its
// base, a node, along the diagonal that steps by one cell on every axis of its direction; the edges
// of tetrahedra in Kuhn's subdivision are of this kind and no others. A layer owns the edges whose
// base lies in it: 1..3 lie in the layer, 4..7 lead to the next one.
#pragma once

#include <bit>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "plot/root.hpp"
#include "plot/section_mesh.hpp"

namespace sightline {

inline constexpr unsigned kDirections = 7;

/// What is known of an edge: three bits in SectionLayer::edges.
enum class EdgeState : std::uint8_t {
    none,     ///< no change of sign, or an end without a value
    crossed,  ///< there is a vertex on it
    at_base,  ///< its vertex is that of the node at its base
    at_end,   ///< or of the one at its end
    broken,   ///< the sign changes, but there is no root
};

enum class Sign : std::uint8_t { negative, positive, none };

struct SectionLayer {
    std::vector<double> value;           // of nodes, row by row
    std::vector<Sign> sign;              // theirs
    std::vector<std::uint32_t> edges;    // of each node 7 states, direction 1 in the lowest bits
    std::vector<glm::dvec3> crossings;   // of crossed edges, by node and direction
    std::vector<std::uint32_t> used;     // nodes that are vertices because of this layer's edges
    std::vector<std::uint32_t> used_up;  // the same in the next layer
    // Vertices of a node are those of its crossed edges by direction, then its own.
    std::vector<std::uint32_t> first;      // of a node's vertices in this layer
    std::vector<std::uint8_t> vertices;    // of a node: bit direction - 1; bit 7: its own
    std::vector<glm::dvec3> points;        // of the vertices
    std::vector<std::uint8_t> node_point;  // 1: of a node
    std::uint32_t offset = 0;              // of the vertices in the mesh

    [[nodiscard]] EdgeState state(std::size_t node, unsigned direction) const {
        return static_cast<EdgeState>(edges[node] >> 3 * (direction - 1) & 7u);
    }
    /// Index in the mesh; bit 0..6 a direction less one, 7 the node itself.
    [[nodiscard]] std::uint32_t vertex(std::size_t node, unsigned bit) const {
        const unsigned before = vertices[node] & ((1u << bit) - 1);
        return offset + first[node] + static_cast<std::uint32_t>(std::popcount(before));
    }
};

/// Evaluates a field on layer k.
void evaluate_layer(Evaluator& value, const SectionGrid& grid, std::size_t k, SectionLayer& layer);

/// Finds the roots on the edges of layer k. `above`: the next layer, evaluated, or null.
void find_crossings(Evaluator& value, const SectionGrid& grid, std::size_t k, double noise,
                    SectionLayer& layer, const SectionLayer* above);

/// Numbers the vertices of layer k. `below`: the layer before, or null.
void number_vertices(const SectionGrid& grid, std::size_t k, SectionLayer& layer,
                     const SectionLayer* below);

}  // namespace sightline
