// Parts of surfaces while a BSP tree is built: convex polygons in the tree's coordinates, and how
// they lie to a plane.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "visibility/bsp_tree.hpp"

namespace sightline::bsp {

/// A part of a triangle. Its corners only say on which side of a plane it is; what it covers on a
/// page follows from the triangle and its cuts.
struct Face {
    std::uint32_t triangle = kNone;
    std::uint64_t cut = kNoCut;       ///< see CutName in bsp_build.cpp
    std::vector<glm::dvec3> corners;  ///< empty: the whole triangle

    static constexpr std::uint64_t kNoCut = ~std::uint64_t{0};
};

/// The corners of a face; holds those of a whole triangle.
class FaceCorners {
public:
    FaceCorners(const Surfaces& surfaces, const Face& face) : face_(face) {
        if (face.corners.empty()) whole_ = surfaces.corners(face.triangle);
    }
    [[nodiscard]] std::span<const glm::dvec3> span() const {
        return face_.corners.empty() ? std::span<const glm::dvec3>(whole_) : face_.corners;
    }

private:
    const Face& face_;
    std::array<glm::dvec3, 3> whole_{};
};

enum class Side { front, back, both };

/// Where a polygon lies.
struct Placement {
    Side side;
    bool in_plane;  ///< within the tolerance; `side` is then where more of it is
};

[[nodiscard]] Placement place(std::span<const glm::dvec3> polygon, const TreePlane& plane);

/// Cuts a convex polygon that lies on both sides. Corners within the tolerance go to both parts.
void split(std::span<const glm::dvec3> polygon, const TreePlane& plane,
           std::vector<glm::dvec3>& front, std::vector<glm::dvec3>& back);

}  // namespace sightline::bsp
