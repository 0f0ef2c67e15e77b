// Drawings: the visible and hidden parts of edges, and the visible regions of faces, found in
// object precision. Nothing here depends on a resolution: the page is a grid of 2^22 to 2^23 steps
// a side (see page_of()), every decision on it is exact, and what is found can be enlarged without
// computing again.
//
// Coordinates of a Drawing are those of a picture by the same camera: pixels of
// Camera::resolution, origin at the top left corner, y down. They are multiples of the page's step
// and exact in double precision, so parts that meet have equal ends.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/screen_scene.hpp"

namespace sightline {

/// Why an edge is drawn. Where several reasons hold, the first one names the edge.
enum class EdgeKind : std::uint8_t {
    silhouette,    ///< contour: of the faces that share it some are seen from the front, some from
                   ///< behind
    boundary,      ///< only one face has it
    border,        ///< its faces are of different objects or materials
    crease,        ///< its faces meet at more than the crease angle, or they are three and more
    intersection,  ///< a curve in which two faces cross each other
    mesh,          ///< any other edge of a polygon of the file
    // Of plots (plot.hpp):
    upper,    ///< a curve on the upper side of its surface
    lower,    ///< the same, seen from below
    outline,  ///< where a closed surface turns away
    hatch,    ///< a curve that is there for its shade
    axis,     ///< an edge of the box of axes, or a tick
};
inline constexpr std::size_t kEdgeKinds = 11;

[[nodiscard]] std::string_view name_of(EdgeKind kind);

/// A set of kinds.
class EdgeKinds {
public:
    constexpr EdgeKinds() = default;
    constexpr EdgeKinds(std::initializer_list<EdgeKind> kinds) {
        for (const EdgeKind kind : kinds) add(kind);
    }
    constexpr void add(EdgeKind kind) { bits_ |= 1u << static_cast<unsigned>(kind); }
    [[nodiscard]] constexpr bool has(EdgeKind kind) const {
        return (bits_ >> static_cast<unsigned>(kind) & 1u) != 0;
    }
    [[nodiscard]] constexpr bool empty() const { return bits_ == 0; }
    friend constexpr bool operator==(EdgeKinds, EdgeKinds) = default;

private:
    unsigned bits_ = 0;
};

/// What is drawn when nobody says otherwise: all but the edges inside smooth or flat regions.
inline constexpr EdgeKinds kFeatureEdges = {EdgeKind::silhouette, EdgeKind::boundary,
                                            EdgeKind::border, EdgeKind::crease,
                                            EdgeKind::intersection};
/// Every polygon edge of the file, and no curves.
inline constexpr EdgeKinds kMeshEdges = {EdgeKind::silhouette, EdgeKind::boundary, EdgeKind::border,
                                         EdgeKind::crease, EdgeKind::mesh};

/// Parts of edges, each wholly visible or wholly hidden. Structure of arrays; part i runs from
/// from[i] to to[i], which differ.
struct DrawnLines {
    std::vector<glm::dvec2> from, to;
    std::vector<EdgeKind> kind;
    std::vector<std::uint8_t> visible;  ///< 1, or 0 = hidden
    /// Source polygons of the edge, ascending: one (the other is kNone) or two; of an edge with
    /// more faces the first two, of an intersection curve the two that cross. Of a FreeLine none.
    std::vector<glm::uvec2> polygons;
    std::vector<std::uint32_t> object;  ///< of the first polygon, or as FreeLine has it

    [[nodiscard]] std::size_t size() const { return from.size(); }
};

/// The visible part of each face: the triangles of one source polygon together. Structure of
/// arrays. A region is bounded by loops, each the closed polygon of its points (the last one is
/// joined to the first); they run clockwise on the page, holes the other way, so that both the
/// even-odd and the non-zero rule fill the region.
struct DrawnRegions {
    std::vector<std::uint32_t> polygon, object;
    std::vector<glm::vec3> color;            ///< linear, 0..1
    std::vector<std::uint32_t> first_loop;   ///< loops of r: first_loop[r] .. first_loop[r + 1] - 1
    std::vector<std::uint32_t> first_point;  ///< the same of loops and points
    std::vector<glm::dvec2> points;

    [[nodiscard]] std::size_t size() const { return polygon.size(); }
};

/// Construction lines of perspective: towards a vanishing point.
struct GuideLine {
    glm::dvec2 from, to;
    std::uint8_t axis = 0;  ///< of the world: 0 x, 1 y, 2 z
};

/// From the corners of a box to the finite vanishing points of its edges, which may lie far outside
/// of the page. Nothing in parallel projections.
[[nodiscard]] std::vector<GuideLine> vanishing_guides(const Camera& camera, const Box& box);

/// A word on the page.
struct Label {
    glm::dvec2 position;    ///< of the middle of its letters
    glm::dvec2 away{0, 0};  ///< it grows from there to this side: -1, 0 or 1 in x and y of the page
    std::string text;       ///< UTF-8, one line
};

/// What was done, for `--stats`.
struct DrawingCounts {
    std::uint64_t edges = 0;           ///< that were looked at
    std::uint64_t intersections = 0;   ///< edges on which surfaces cross
    std::uint64_t dismissed = 0;       ///< wholly hidden without being tested
    std::uint64_t occluder_tests = 0;  ///< edges against triangles
    std::uint64_t visible_segments = 0, hidden_segments = 0;
    double visible_length = 0, hidden_length = 0;                       ///< in pixels
    std::uint64_t faces_whole = 0, faces_partly = 0, faces_hidden = 0;  ///< triangles
};

struct Drawing {
    Resolution resolution;  ///< the page in pixels: what lies outside of it is not in the drawing
    DrawnLines lines;
    DrawnRegions regions;
    std::vector<GuideLine> guides;
    std::vector<Label> labels;
    DrawingCounts counts;
};

/// How occluders are found.
enum class TraceMethod {
    fast,      ///< through a spatial structure
    pairwise,  ///< every edge and every polygon against every other one: the oracle
};

/// A line in space that belongs to no face: anything in front of it hides it.
struct FreeLine {
    glm::dvec3 from{}, to{};
    EdgeKind kind = EdgeKind::axis;
    std::uint32_t object = kNone;  ///< for DrawnLines
};

enum class FillStyle {
    none,      ///< no regions
    flat,      ///< all of one light grey
    material,  ///< base colours
    lambert,   ///< base colours in the light of the scene
};

struct TraceOptions {
    EdgeKinds edges = kFeatureEdges;
    double crease_angle = 30;  ///< degrees, 0..180
    bool hidden = false;       ///< keep the hidden parts
    FillStyle fill = FillStyle::none;
    TraceMethod method = TraceMethod::fast;
    int threads = 0;  ///< 0 = all cores
    /// Called now and then, from any thread but one at a time, with the share of the work that is
    /// done, 0..1. When it answers false, the work ends.
    std::function<bool(double)> progress;
    /// Drawn with the edges, cut off by the view volume and by the page as they are.
    std::vector<FreeLine> free_lines;
};

/// The camera's scene on a page: as project() makes it for pictures, but with as many steps a
/// pixel as fit. Errors as those of project().
[[nodiscard]] Result<ScreenScene> page_of(const Scene& scene, const Camera& camera,
                                          const ProjectOptions& options = {});

/// Finds what is visible on a page. Precondition: the scene has no quadrics (see
/// tessellate_quadrics()). About O(n log n) for meshes, on all cores; the result does not depend on
/// the number of threads. Error (cancelled): the progress function said so.
[[nodiscard]] Result<Drawing> trace(const ScreenScene& page, const TraceOptions& options);

/// How much of a face is seen. Areas are those of the projection onto the page, in pixels^2; parts
/// outside of the page or beyond the near and far planes do not count.
struct FaceArea {
    double projected = 0;  ///< of the whole face
    double visible = 0;    ///< of what is seen of it
    bool front = false;    ///< its front is towards the viewer
};

/// For every triangle of the scene; exact but for the rounding of sums in double precision.
/// Precondition, errors and cost as those of trace().
[[nodiscard]] Result<std::vector<FaceArea>> visible_areas(const ScreenScene& page,
                                                          const TraceOptions& options);

}  // namespace sightline
