#include "visibility/bsp_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sightline {

namespace bsp {

WorldGrid make_grid(const Box& bounds) {
    WorldGrid grid;
    if (bounds.empty()) return grid;
    const glm::dvec3 lo = bounds.lo, hi = bounds.hi;
    // Halves first: numbers near the largest that there are must not overflow.
    grid.origin = 0.5 * lo + 0.5 * hi;
    const glm::dvec3 half = 0.5 * hi - 0.5 * lo;
    const double step = std::max({half.x, half.y, half.z}) / (0.5 * kSteps);
    if (step > 0) grid.step = step;
    return grid;
}

namespace {

double squared(const glm::dvec3& v) { return glm::dot(v, v); }

// Perpendicular to d: with the axis that d follows least.
glm::dvec3 any_normal(const glm::dvec3& d) {
    const glm::dvec3 a{std::abs(d.x), std::abs(d.y), std::abs(d.z)};
    const glm::dvec3 axis = a.x <= a.y && a.x <= a.z ? glm::dvec3{1, 0, 0}
                            : a.y <= a.z             ? glm::dvec3{0, 1, 0}
                                                     : glm::dvec3{0, 0, 1};
    return glm::cross(d, axis);
}

}  // namespace

TreePlane plane_through(const std::array<glm::dvec3, 3>& corners) {
    // The longest side runs from corner k, in the order of the corners.
    std::size_t k = 0;
    for (std::size_t i = 1; i < 3; ++i)
        if (squared(corners[(i + 1) % 3] - corners[i]) > squared(corners[(k + 1) % 3] - corners[k]))
            k = i;
    const glm::dvec3 start = corners[k];
    const glm::dvec3 side = corners[(k + 1) % 3] - start;
    const double length2 = squared(side);
    glm::dvec3 normal = glm::cross(side, corners[(k + 2) % 3] - start);
    // For a needle the product is little more than its own error. What matters is that the plane
    // holds the side; the third corner is then as near as the needle is thin.
    if (length2 > 0) normal -= (glm::dot(normal, side) / length2) * side;
    double length = std::sqrt(squared(normal));
    if (!(length > 0)) {
        normal = any_normal(side);
        length = std::sqrt(squared(normal));
    }
    TreePlane plane;
    if (length > 0 && std::isfinite(length)) plane.normal = normal / length;
    plane.offset = plane.along(start);
    return plane;
}

TreePlane Surfaces::plane(std::uint32_t triangle) const {
    const std::uint32_t sheet = scene_.sheets.of(triangle);
    return plane_through(
        points(sheet != kNone ? scene_.sheets.frame[sheet] : scene_.triangles[triangle]));
}

bool Surfaces::is_reversed(std::uint32_t triangle, const TreePlane& plane) const {
    const std::array<glm::dvec3, 3> c = corners(triangle);
    return plane.along(glm::cross(c[1] - c[0], c[2] - c[0])) < 0;
}

std::uint64_t fingerprint_of(const Scene& scene, std::span<const std::uint8_t> moving) {
    // Sum and product as in FNV-1a, 64 bits at a time (Fowler, Noll, Vo 1991), then mixed.
    std::uint64_t hash = 0xCBF29CE484222325u;
    const auto take = [&](std::uint64_t value) {
        hash = (hash ^ value) * 0x9E3779B97F4A7C15u;
        hash ^= hash >> 29;
    };
    take(scene.triangle_count());
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
        const bool left_out = !moving.empty() && moving[t] != 0;
        take(left_out ? 1 : 0);
        if (left_out) continue;
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3& p = scene.positions[scene.triangles[t][k]];
            for (int axis = 0; axis < 3; ++axis) take(std::bit_cast<std::uint64_t>(p[axis] + 0.0));
        }
    }
    return hash;
}

}  // namespace bsp

bool BspTree::fits(const Scene& scene) const { return tree_->triangles == scene.triangle_count(); }

namespace {

std::uint64_t depth_of(const bsp::Tree& tree) {
    std::vector<std::uint32_t> depth(tree.node_count(), 1);
    std::uint32_t deepest = 0;
    for (std::uint32_t i = 0; i < tree.node_count(); ++i) {
        deepest = std::max(deepest, depth[i]);
        for (const std::uint32_t child : {tree.nodes[i].front, tree.nodes[i].back})
            if (child != kNone) depth[child] = depth[i] + 1;
    }
    return deepest;
}

}  // namespace

BspStats BspTree::stats() const {
    BspStats stats;
    stats.left_out = static_cast<std::uint64_t>(
        std::ranges::count_if(tree_->moving, [](std::uint8_t byte) { return byte != 0; }));
    stats.nodes = tree_->node_count();
    for (std::uint32_t i = 0; i < tree_->node_count(); ++i)
        stats.free_planes += tree_->parts_of(i).empty() ? 1 : 0;
    stats.pieces = tree_->parts.size();
    stats.splits = tree_->cuts.size();
    // Every split makes one part more than there were.
    stats.triangles = stats.pieces - stats.splits;
    stats.depth = depth_of(*tree_);
    return stats;
}

}  // namespace sightline
