// Meshes of implicit surfaces whose edges lie in given planes.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "plot/field.hpp"
#include "sightline/scene.hpp"

namespace sightline {

/// Ascending coordinates of the planes between cells, at least two of each.
struct SectionGrid {
    std::vector<double> x, y, z;

    [[nodiscard]] glm::dvec3 lo() const { return {x.front(), y.front(), z.front()}; }
    [[nodiscard]] glm::dvec3 hi() const { return {x.back(), y.back(), z.back()}; }
    [[nodiscard]] std::size_t cells() const {
        return (x.size() - 1) * (y.size() - 1) * (z.size() - 1);
    }
};

/// Corners are on the surface; no two points are equal and no two corners of a triangle are the
/// same. Triangles turn their fronts to where the field grows.
struct SectionMesh {
    AlignedVector<glm::dvec3> points;
    AlignedVector<Corners> triangles;
};

/// The surface on which a field is 0, within a grid. Every triangle lies in one cell, so wherever
/// the mesh passes a plane between cells it has edges there. It is watertight inside of the grid,
/// except around places where the field has no value or changes its sign without being 0. Points
/// with value 0 count as positive.
/// O(cells), on all cores; the mesh does not depend on the number of threads. `progress` as in
/// TraceOptions. Error (cancelled): it said so.
[[nodiscard]] Result<SectionMesh> mesh_of_field(const Field& field, const SectionGrid& grid,
                                                int threads,
                                                const std::function<bool(double)>& progress);

}  // namespace sightline
