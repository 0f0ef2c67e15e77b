// The inside of a BSP tree, and its geometry.
//
// Units. The tree has coordinates of its own: the origin is the centre of the box of all frames
// (Scene::reach), and its longest side has 2^24 steps. Positions are not rounded to whole steps.
//
// Error. A value of a plane is n . p - offset. |p| <= 0.87 * 2^24 for points of the box, so the
// three products and three sums are off by less than 5 u |p| < 2^-26 steps (u = 2^-53). Whether a
// point lies in front of a plane is therefore known but for kTolerance, an eighth of a step: a part
// of a surface that is farther from the plane is always on the right side of it.
//
// A cut ends on an edge where the values at its ends, more than kTolerance to either side, have the
// ratio of the two parts. So it is off along the edge by at most the edge's length, 1.73 * 2^24 or
// less, times 2^-26 over 2 * kTolerance: below 7/8 of a step (reached by a face as long as the
// scene that meets the plane at an angle of 2^-27; for others it is far below). Together with the
// tolerance: parts of surfaces lie on the right sides of all planes but for one step, kWorldTerm.
#pragma once

#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "sightline/bsp.hpp"

namespace sightline::bsp {

inline constexpr double kSteps = 0x1p24;     // along the longest side of the scene's box
inline constexpr double kTolerance = 0.125;  // steps
inline constexpr double kWorldTerm = 1.0;    // steps

/// Points with normal . p = offset; |normal| = 1. In front of it where at() > 0.
struct TreePlane {
    glm::dvec3 normal{0, 0, 1};
    double offset = 0;

    [[nodiscard]] double at(const glm::dvec3& p) const {
        return ((normal.x * p.x + normal.y * p.y) + normal.z * p.z) - offset;
    }
    /// How fast at() grows along a direction.
    [[nodiscard]] double along(const glm::dvec3& d) const {
        return (normal.x * d.x + normal.y * d.y) + normal.z * d.z;
    }
    friend bool operator==(const TreePlane&, const TreePlane&) = default;
};

/// From the world to the tree's coordinates.
struct WorldGrid {
    glm::dvec3 origin{0, 0, 0};
    double step = 1;  ///< in units of the world, > 0

    [[nodiscard]] glm::dvec3 of(const glm::dvec3& p) const {
        return {(p.x - origin.x) / step, (p.y - origin.y) / step, (p.z - origin.z) / step};
    }
};

[[nodiscard]] WorldGrid make_grid(const Box& bounds);

/// The surfaces of a scene in the tree's coordinates.
class Surfaces {
public:
    Surfaces(const Scene& scene, const WorldGrid& grid) : scene_(scene), grid_(grid) {}

    [[nodiscard]] std::array<glm::dvec3, 3> corners(std::uint32_t triangle) const {
        return points(scene_.triangles[triangle]);
    }
    /// The plane of a triangle: that of its sheet when it has one. The normal of a triangle without
    /// sheet points to the side from which its corners run counter-clockwise.
    [[nodiscard]] TreePlane plane(std::uint32_t triangle) const;
    /// Whether two triangles have one plane by their sheet.
    [[nodiscard]] bool share_plane(std::uint32_t a, std::uint32_t b) const {
        return a == b ||
               (scene_.sheets.of(a) != kNone && scene_.sheets.of(a) == scene_.sheets.of(b));
    }
    /// Whether the front of a triangle is at the back of a plane that it lies in.
    [[nodiscard]] bool is_reversed(std::uint32_t triangle, const TreePlane& plane) const;

private:
    [[nodiscard]] std::array<glm::dvec3, 3> points(const Corners& c) const {
        return {grid_.of(scene_.positions[c.x]), grid_.of(scene_.positions[c.y]),
                grid_.of(scene_.positions[c.z])};
    }

    const Scene& scene_;
    WorldGrid grid_;
};

/// The plane through three points. A needle's holds its longest side, to a rounding, whatever
/// becomes of the rest; any plane through the points when they have no area.
[[nodiscard]] TreePlane plane_through(const std::array<glm::dvec3, 3>& corners);

/// One side of a cut: 2 * cut + 1 behind its plane, 2 * cut in front of it or on it. kNone: no cut.
using CutSide = std::uint32_t;

/// A part of a triangle was split by the plane of a node.
struct Cut {
    std::uint32_t node;
    CutSide parent;  ///< which part of the triangle it was
    friend bool operator==(const Cut&, const Cut&) = default;
};

/// What the sides of a chain of cuts leave of a triangle. All cuts of a triangle are on the chains
/// of its parts, none of them is left out as redundant: so the same numbers decide for all of its
/// parts, and each of its samples belongs to exactly one.
struct Part {
    std::uint32_t triangle;
    CutSide cut;
    std::uint32_t reversed;  ///< 1: its front is at the back of the node's plane
    friend bool operator==(const Part&, const Part&) = default;
};

/// Children come after their parent.
struct Node {
    std::uint32_t front = kNone, back = kNone;
    /// The parts in its plane: first_part .. first_part of the next node, in descending order of
    /// their triangles. A free plane has none.
    std::uint32_t first_part = 0;
    friend bool operator==(const Node&, const Node&) = default;
};

/// A tree, or what moves on top of one: then node i of it, where `below[i]` is not kNone, has the
/// plane of that node of the tree below, and holds what lies in the same cell of space.
struct Tree {
    WorldGrid grid;
    std::vector<Node> nodes;  ///< the root first; one more at the end that closes the last parts
    std::vector<TreePlane> planes;  ///< of the nodes
    std::vector<Part> parts;
    std::vector<Cut> cuts;             ///< parents before what they were cut into
    std::vector<std::uint8_t> moving;  ///< one byte a triangle of the scene: left out; may be empty
    std::uint64_t fingerprint = 0;     ///< of the scene
    std::uint32_t triangles = 0;       ///< of the scene
    std::vector<std::uint32_t> below;  ///< empty but on top of another tree

    [[nodiscard]] std::uint32_t node_count() const {
        return static_cast<std::uint32_t>(planes.size());
    }
    [[nodiscard]] std::uint32_t root() const { return planes.empty() ? kNone : 0; }
    [[nodiscard]] std::span<const Part> parts_of(std::uint32_t node) const {
        return std::span(parts).subspan(nodes[node].first_part,
                                        nodes[node + 1].first_part - nodes[node].first_part);
    }
};

/// A number that tells scenes apart by the triangles that are not left out.
[[nodiscard]] std::uint64_t fingerprint_of(const Scene& scene,
                                           std::span<const std::uint8_t> moving);

}  // namespace sightline::bsp
