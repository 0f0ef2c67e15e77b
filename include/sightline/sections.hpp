// Plots of implicit surfaces F(x, y, z) = 0: curves on them in planes of constant x or z, with
// hidden lines removed.
#pragma once

#include <array>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "sightline/drawing.hpp"
#include "sightline/error.hpp"
#include "sightline/formula.hpp"
#include "sightline/scene.hpp"

namespace sightline {

/// The value at a point; NaN or infinite where there is none.
using Evaluator = std::function<double(glm::dvec3)>;

/// A function of space that several threads evaluate. Evaluators of one field always agree.
struct Field {
    std::function<Evaluator()> make;  ///< one for each thread; may be called by any of them
    std::string name;                 ///< for messages
};

/// The field of an expression.
[[nodiscard]] Field field_of(const Expression& expression, std::string name);

/// The y between which a field is 0 over a part of the x-z plane (x: from, to; z likewise), with a
/// little to spare. Found on a grid of columns: parts thinner than about 1/100 of the extents can
/// be missed. Of a surface without end (a cylinder that stands, waves in all directions) as much as
/// the larger extent of x and z, about y = 0. Error (bad_input): nothing was found.
[[nodiscard]] Result<glm::dvec2> find_y_range(const Field& field, glm::dvec2 x, glm::dvec2 z);

/// The part of a box in which a field is 0, with a little to spare on those sides that it does not
/// reach; the box itself where nothing is found. Parts thinner than 1/64 of it can be missed.
[[nodiscard]] Box find_extent(const Field& field, const Box& box);

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
