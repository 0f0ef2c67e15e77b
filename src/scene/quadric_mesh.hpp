// Triangles of one quadric.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sightline/scene.hpp"

namespace sightline {

/// A mesh in a quadric's own coordinates. Triangles are counter-clockwise seen from where the
/// quadric's polynomial is positive: from outside.
struct QuadricMesh {
    AlignedVector<glm::dvec3> points;
    AlignedVector<Corners> triangles;
    /// Two triangles in succession are a quad with the diagonal of corners 0 and 2 of the first;
    /// otherwise each triangle is a polygon.
    bool quads = false;
};

/// `rings` along a cylinder or cone; spheres have segments / 2.
[[nodiscard]] QuadricMesh mesh_of_sphere(std::uint32_t segments);
[[nodiscard]] QuadricMesh mesh_of_cylinder(std::uint32_t segments, std::uint32_t rings);
[[nodiscard]] QuadricMesh mesh_of_cone(std::uint32_t segments, std::uint32_t rings);

/// Through a lattice of cells^3 over the quadric's box.
[[nodiscard]] QuadricMesh march_quadric(const Quadric& quadric, std::uint32_t cells);

}  // namespace sightline
