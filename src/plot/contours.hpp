// The outlines of implicit surfaces: where they turn away from the viewer.
#pragma once

#include <vector>

#include "plot/field.hpp"
#include "plot/section_mesh.hpp"
#include "sightline/drawing.hpp"

namespace sightline {

/// The curves of a surface along which lines of sight touch it, as pieces within the triangles of
/// its mesh; pieces that meet have equal ends. They are of EdgeKind::outline, and lie nearer to the
/// viewer than the surface by the size of a cell, on the same points of the page, so that the
/// triangles around them, which turn away a little sooner or later, don't hide them. Those in one
/// of the given planes x = const or z = const are left out. The result does not depend on the
/// number of threads.
[[nodiscard]] std::vector<FreeLine> find_contours(const Field& field, const SectionMesh& mesh,
                                                  const SectionGrid& grid, const Camera& camera,
                                                  const std::vector<double>& x_planes,
                                                  const std::vector<double>& z_planes, int threads);

}  // namespace sightline
