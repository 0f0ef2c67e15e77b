// Plots of implicit surfaces: curves on them in planes, with hidden lines removed.
#pragma once

#include <array>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "plot/field.hpp"
#include "sightline/drawing.hpp"

namespace sightline {

struct SectionOptions {
    std::vector<double> x_planes, z_planes;  ///< curves in x = const and z = const; any order
    Box box;                                 ///< what lies outside of it is cut off
    bool outline = true;                     ///< where surfaces turn away from the viewer
    bool boundary = false;                   ///< where the box cuts them off, drawn planes or not
    bool hidden = false;                     ///< keep the hidden parts
    double tolerance = 0.1;                  ///< of curves on the page, in pixels; > 0
    int threads = 0;                         ///< 0 = all cores
    std::function<bool(double)> progress;    ///< as in TraceOptions
    std::vector<std::array<glm::dvec3, 2>> axes;  ///< lines in space that surfaces can hide
};

/// Draws the surfaces on which fields are 0: curves are EdgeKind::upper, outlines
/// EdgeKind::outline, borders at the box EdgeKind::boundary, curves in which two surfaces cross
/// EdgeKind::intersection, and axes EdgeKind::axis. The object of a line is the number of its field
/// (of an axis the number of fields); its polygons are none. A field that is 0 nowhere in the box
/// has no lines.
///
/// Surfaces are meshed on grids fine enough for the tolerance, up to kMaxSectionCells a side, 2^24
/// in all and about 2^22 triangles. The result does not depend on the number of threads.
/// Errors: bad_option (the box is empty or not finite, the tolerance is not positive, more than
/// kMaxSectionPlanes planes), cancelled, and those of page_of().
[[nodiscard]] Result<Drawing> trace_sections(std::span<const Field> fields, const Camera& camera,
                                             const SectionOptions& options);

inline constexpr std::size_t kMaxSectionCells = 256;
inline constexpr std::size_t kMaxSectionPlanes = 1024;  ///< of each family

}  // namespace sightline
