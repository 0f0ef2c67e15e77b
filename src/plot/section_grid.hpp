// How fine a grid a plot of sections needs.
#pragma once

#include <vector>

#include "plot/section_mesh.hpp"
#include "sightline/camera.hpp"

namespace sightline {

/// Sections of a box: ascending planes within it.
struct SectionPlanes {
    Box box;
    std::vector<double> x, z;

    SectionPlanes(const Box& of, std::vector<double> x_planes, std::vector<double> z_planes);
    /// Whether a side of a triangle is part of a section: it lies in a plane that the triangle does
    /// not lie in.
    [[nodiscard]] bool contain(glm::dvec3 a, glm::dvec3 b, glm::dvec3 third) const;
};

/// A grid with about so many cells along the longest side of the box, and all planes among its
/// nodes.
[[nodiscard]] SectionGrid grid_of(const SectionPlanes& planes, std::size_t cells);

/// How far the chords of sections are off the surface, in pixels: what all but 1 % of a sample stay
/// below. Of the whole mesh, where there are no sections.
[[nodiscard]] double chord_error(const Field& field, const SectionMesh& mesh,
                                 const SectionPlanes& planes, const Camera& camera);

}  // namespace sightline
