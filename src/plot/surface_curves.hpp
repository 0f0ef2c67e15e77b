// Curves on implicit surfaces that lie across the cells of their meshes: outlines, and where two
// surfaces cross.
//
// They are pieces within the triangles of a mesh; pieces that meet have equal ends. They lie nearer
// to the viewer than the surface by the size of a cell, on the same points of the page: the
// triangles around them, which turn away a little sooner or later than the surface does, would hide
// bits of them. Where they run along a section they are left out. Results don't depend on the
// number of threads.
#pragma once

#include <vector>

#include "plot/field.hpp"
#include "plot/section_grid.hpp"
#include "plot/section_mesh.hpp"
#include "sightline/drawing.hpp"

namespace sightline {

/// A surface with its mesh, as mesh_of_field() made it.
struct MeshedField {
    const Field& field;
    const SectionMesh& mesh;
    const SectionGrid& grid;
};

/// Where lines of sight touch a surface: EdgeKind::outline.
[[nodiscard]] std::vector<FreeLine> find_outlines(const MeshedField& surface, const Camera& camera,
                                                  const SectionPlanes& planes, int threads);

/// Where a surface crosses another one: EdgeKind::intersection.
[[nodiscard]] std::vector<FreeLine> find_common_curves(const MeshedField& surface,
                                                       const Field& other, const Camera& camera,
                                                       const SectionPlanes& planes, int threads);

}  // namespace sightline
