// Plots: functions of two variables and terrain as families of curves, by the floating horizon.
//
// The world is that of the camera: y is up, curves lie in planes of constant x or z.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sightline/camera.hpp"
#include "sightline/drawing.hpp"
#include "sightline/error.hpp"
#include "sightline/formula.hpp"
#include "sightline/height_map.hpp"

namespace sightline {

struct Box;

/// What is drawn along a row or a column of a grid.
enum class LineUse : std::uint8_t {
    none,        ///< nothing: it is there for the shape
    curve,       ///< a curve of the plot
    half_shade,  ///< hatching: a curve where the surface turns away from the light
    full_shade,  ///< hatching where it turns away far
};

/// A break in an edge of the grid: the surface ends on the way from the first node to the second.
struct Cut {
    std::uint64_t edge = 0;  ///< see HeightGrid::edge_along_x() and edge_along_z()
    /// How far it reaches from either node, as shares of the edge, end0 <= end1, and its heights
    /// there: NaN where the node itself has none.
    double end0 = 0, end1 = 1, y0 = 0, y1 = 0;
};

/// One surface over a grid: two triangles a cell, parted by the diagonal from its lowest x and z to
/// its highest.
struct HeightLayer {
    std::vector<double> y;  ///< y[row * columns + column]; NaN where there is nothing
    /// Ascending by edge. An edge between a height and none that is not here ends at the height.
    std::vector<Cut> cuts;
    /// Whether one can look through its gaps. Terrain is only not known there.
    bool open_gaps = true;
};

/// Surfaces over one grid.
struct HeightGrid {
    std::vector<double> x, z;  ///< of columns and rows, ascending, two or more each
    std::vector<LineUse> column_use, row_use;
    std::vector<HeightLayer> layers;

    [[nodiscard]] std::uint64_t node(std::size_t column, std::size_t row) const {
        return std::uint64_t{row} * x.size() + column;
    }
    /// From a node to the next one in x, or in z.
    [[nodiscard]] std::uint64_t edge_along_x(std::size_t column, std::size_t row) const {
        return 2 * node(column, row);
    }
    [[nodiscard]] std::uint64_t edge_along_z(std::size_t column, std::size_t row) const {
        return 2 * node(column, row) + 1;
    }
    /// Of all heights. Empty where there are none.
    [[nodiscard]] Box bounds() const;
};

// -- from functions and maps to a grid ------------------------------------------------------------

/// A surface y = f(x, z), whatever it comes from.
struct PlotField {
    /// Makes the function for one thread; NaN where there is no surface.
    std::function<std::function<double(double x, double z)>()> make;
    /// Where it has corners, so that the grid has nodes there; may be empty.
    std::vector<double> x, z;
    bool open_gaps = true;  ///< see HeightLayer
};

/// Precondition: the formula is a function.
[[nodiscard]] PlotField field_of(const Formula& formula);
/// On the map's own triangles. Copies the map, once.
[[nodiscard]] PlotField field_of(const HeightMap& map);

/// Over what something is plotted.
struct PlotDomain {
    glm::dvec2 x{0, 1}, z{0, 1};  ///< from low to high
    /// Heights outside of it are left out.
    glm::dvec2 y{-1e300, 1e300};
};

/// Which curves are drawn.
struct PlotCurves {
    bool along_x = true;       ///< of constant z
    bool along_z = false;      ///< of constant x
    std::uint32_t count = 40;  ///< of either family, the first and the last one on the border; >= 2
    bool hatch = false;        ///< more of them where the surface turns away from the light
};

/// From the least to the greatest height of fields over a domain, as a sample of them shows. Where
/// a field grows without limit, the range holds most of what is not near there. Error (bad_input):
/// no field has a height anywhere.
[[nodiscard]] Result<glm::dvec2> height_range(const std::vector<PlotField>& fields,
                                              const PlotDomain& domain);

/// A grid fine enough for a camera: between its nodes the fields are straight but for `tolerance`
/// pixels, as far as 2,000 columns and rows allow; where they end or jump, that place is found to
/// double precision. Fields with nodes of their own get all of these. On all cores (threads: 0);
/// the result does not depend on their number.
[[nodiscard]] HeightGrid sample(const std::vector<PlotField>& fields, const PlotDomain& domain,
                                const PlotCurves& curves, const Camera& camera, double tolerance,
                                int threads = 0);

/// The grid of a map alone, as it is. Curves run along the rows and columns nearest to where they
/// would be.
[[nodiscard]] HeightGrid grid_of(HeightMap map, const PlotCurves& curves);

/// Where the `count` curves of a family are, from `range.x` to `range.y`.
[[nodiscard]] std::vector<double> curve_places(glm::dvec2 range, std::uint32_t count);

// -- drawing --------------------------------------------------------------------------------------

enum class PlotSides { both, upper, lower };

struct PlotOptions {
    PlotSides sides = PlotSides::both;
    bool hidden = false;  ///< keep the hidden parts
    /// Curves hide what is below them down to the page's end, and nothing is between them.
    bool ridges = false;
    /// Curves lose points as far as they move by no more than this, in pixels of the camera; 0:
    /// none.
    double tolerance = 0.05;
    int threads = 0;  ///< 0 = all cores
    /// Called now and then, from one thread at a time, with the share of the work that is done.
    /// When it answers false, the work ends.
    std::function<bool(double)> progress;
};

/// A line of the box of axes. It must not lead through the space over the grid.
using AxisLine = std::array<glm::dvec3, 2>;

/// A box with ticks around a plot: those of its edges that are not between it and the viewer.
struct PlotAxes {
    std::vector<AxisLine> lines;
    std::vector<Label> labels;
};

/// Numbers beside the ticks are coordinates times `units`. Axes that would be too short on the page
/// for numbers have none.
[[nodiscard]] PlotAxes axes_around(const Box& box, const Camera& camera,
                                   glm::dvec3 units = glm::dvec3(1));

/// Draws the curves of a grid as far as they can be seen, and lines around it. Kinds of the lines:
/// upper, lower, hatch, axis; `object` is the layer (the first number after them for axes), the
/// first of `polygons` the number of the curve: those of constant z first. Near and far planes cut
/// nothing. About O(cells) time and O(nodes) memory, on all cores; the result does not depend on
/// their number. Errors: cancelled.
///
/// Exact on the triangles of the grid but for rounding in double precision: what is seen is found
/// by comparing lines, with no samples in between.
///
/// Source: as in src/drawing/horizon.hpp; order of cells: D. P. Anderson, "Hidden line elimination
/// in projected grid surfaces", ACM Transactions on Graphics 1 (1982), 274-288.
[[nodiscard]] Result<Drawing> floating_horizon(const HeightGrid& grid, const Camera& camera,
                                               const PlotOptions& options,
                                               const std::vector<AxisLine>& axes = {});

/// The algorithm as textbooks have it, on arrays with one height for each column of pixels, for
/// teaching and comparison: only the curves across the view, no surface between them.
[[nodiscard]] Result<Drawing> image_space_horizon(const HeightGrid& grid, const Camera& camera,
                                                  const PlotOptions& options);

}  // namespace sightline
