// Curves on implicit surfaces that lie across the cells of their meshes: outlines, and where two
// surfaces cross.
//
// They are pieces within the triangles of a mesh; pieces that meet have equal ends. They lie nearer
// to the viewer than the surface by the size of a cell, on the same points of the page: the
// triangles around them, which turn away a little sooner or later than the surface does, would hide
// bits of them. Where they run along a section they are left out. Results don't depend on the
// number of threads.
#pragma once

#include <span>
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

/// What curves are found for.
struct CurveView {
    const Camera& camera;
    const SectionPlanes& planes;
    std::span<const Field> others;  ///< surfaces that hide what is just behind them
    int threads = 0;
};

/// Where lines of sight touch a surface: EdgeKind::outline.
[[nodiscard]] std::vector<FreeLine> find_outlines(const MeshedField& surface,
                                                  const CurveView& view);

/// Where a surface crosses another one: EdgeKind::intersection. Both may be among view.others.
[[nodiscard]] std::vector<FreeLine> find_common_curves(const MeshedField& surface,
                                                       const Field& second, const CurveView& view);

}  // namespace sightline
