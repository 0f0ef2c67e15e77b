// Drawings on paper and in files: SVG, PDF, EPS, DXF, and PNG for a look.
//
// Every writer writes to a temporary name beside the target and renames it when the file is
// complete. The path "-" is standard output. The bytes depend on the drawing and the options alone.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/camera.hpp"
#include "sightline/drawing.hpp"
#include "sightline/error.hpp"

namespace sightline {

enum class VectorFormat { svg, pdf, eps, dxf, png };

/// By the extension of a path (case-insensitive), or nothing.
[[nodiscard]] std::optional<VectorFormat> vector_format_of(std::string_view path);
[[nodiscard]] std::optional<VectorFormat> parse_vector_format(std::string_view name);
[[nodiscard]] std::string_view name_of(VectorFormat format);

/// Where a drawing lies on its page: a point of the drawing, in pixels, lies at
/// offset + scale * pixel units of the page.
struct PageLayout {
    double width = 0, height = 0;  ///< of the page, in units of the page
    bool millimetres = false;      ///< the unit; else a pixel
    double scale = 1;              ///< units of the page a pixel
    glm::dvec2 offset{0, 0};
};

/// What the user says of the paper.
struct PageOptions {
    std::optional<glm::dvec2> size;  ///< width and height in mm; none: one unit is one pixel
    double margin = 10;              ///< mm, kept free on all sides of a page with a size
    /// Length on paper over length in the scene, whose unit is taken for a millimetre: 1:50 is
    /// 0.02. None: the drawing fills what the margins leave.
    std::optional<double> scale;
};

/// The layout of a camera's drawing. With a size the drawing is centred on the page; with a scale
/// and no size the page is as large as the drawing. Errors (bad_option): a scale in perspective,
/// where lengths have none; a margin that leaves nothing; a drawing that is larger at its scale
/// than the page.
[[nodiscard]] Result<PageLayout> lay_out(const PageOptions& options, const Camera& camera);

/// Segments joined end to end, each a path of one kind, visibility and object. Structure of arrays;
/// point k and k + 1 of a path are the ends of one part of DrawnLines.
struct Paths {
    std::vector<EdgeKind> kind;
    std::vector<std::uint8_t> visible;
    std::vector<std::uint32_t> object;
    std::vector<std::uint32_t>
        first_point;  ///< of path p: first_point[p] .. first_point[p + 1] - 1
    std::vector<glm::dvec2> points;
    /// Which part of the lines leads from point k to the next; kNone at the last point of a path.
    std::vector<std::uint32_t> part;

    [[nodiscard]] std::size_t size() const { return kind.size(); }
};

/// Chains the parts of lines into as few and as long paths as a walk finds, drops parts that stand
/// twice, and orders paths by visibility (hidden first), kind and object. With `sorted`, the paths
/// of one layer are put in an order (and turned) that keeps a plotter's pen in the air for short
/// ways. O(n log n); the result depends on the lines alone.
[[nodiscard]] Paths chain(const DrawnLines& lines, bool sorted);

/// What was written.
struct VectorCounts {
    std::uint64_t visible_paths = 0, hidden_paths = 0;
    double visible_length = 0, hidden_length = 0;  ///< in units of the page, each line once
};

struct VectorOptions {
    PageLayout layout;
    double stroke = 1;                 ///< width of lines, in units of the page
    bool dashed_hidden = true;         ///< hidden lines are dashed, else solid (and thinner)
    glm::vec4 background{0, 0, 0, 0};  ///< linear, straight alpha; none at alpha 0
    bool sorted = false;               ///< for a plotter, see chain()
    /// By number: names of the objects, for data-object. An object without one gets its number.
    std::vector<std::string> object_names;
    std::string title;               ///< one line; may be empty
    VectorCounts* counts = nullptr;  ///< filled in, when given
};

/// Writes a drawing. Errors (io): as for pictures; what a library could not write.
[[nodiscard]] Status write_drawing(const std::string& path, VectorFormat format,
                                   const Drawing& drawing, const VectorOptions& options);

}  // namespace sightline
