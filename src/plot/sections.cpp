// Source: T. Wright, "A Two-Space Solution to the Hidden Line Problem for Plotting Functions of Two
// Variables", IEEE Transactions on Computers C-22(1), 1973, and D. Rogers, "Procedural Elements for
// Computer Graphics", 1985, section 4-2, on surfaces drawn as families of plane curves.
//
// How this version differs: horizons fail where a surface has several heights at a place, so the
// surfaces are meshed here, with edges along every curve, and the hidden lines of the mesh are
// found exactly (see trace()). Outlines and crossings are curves of their own: surface_curves.hpp.
#include "sightline/sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <utility>

#include "plot/section_grid.hpp"
#include "plot/surface_curves.hpp"
#include "scene/finish.hpp"

namespace sightline {
namespace {

constexpr std::size_t kFirstCells = 64;                   // along the longest side
constexpr std::size_t kMostCells = std::size_t{1} << 24;  // in a grid, but for what planes need
constexpr double kMostTriangles = 1u << 22;               // of a surface
constexpr double kMeshingShare = 0.5;  // of the whole work, for the progress function

Error wrong(std::string message) { return {ErrorKind::bad_option, std::move(message)}; }

Status check(const SectionOptions& options) {
    const glm::dvec3 extent = options.box.extent();
    for (int axis = 0; axis < 3; ++axis) {
        if (!(extent[axis] > 0) || !std::isfinite(extent[axis]) ||
            !std::isfinite(options.box.lo[axis]))
            return wrong(
                "the box of the plot is empty or not finite; give ranges from a smaller "
                "to a larger number");
    }
    if (!(options.tolerance > 0)) return wrong("the tolerance must be larger than 0 pixels");
    const std::size_t planes = std::max(options.x_planes.size(), options.z_planes.size());
    if (planes > kMaxSectionPlanes)
        return wrong(fmt::format("{} curves of a family are too many; at most {} are possible",
                                 planes, kMaxSectionPlanes));
    return success();
}

/// A surface and what is drawn of it.
struct Surface {
    SectionGrid grid;
    SectionMesh mesh;
    std::vector<std::uint8_t> drawn;  ///< of each triangle: bit k, side k is part of a section
};

/// The next finer number of cells; nothing when the grid is fine enough or can be no finer.
std::optional<std::size_t> refined(const SectionPlanes& planes, const SectionMesh& mesh,
                                   std::size_t cells, double error, double tolerance) {
    if (!(error > tolerance)) return std::nullopt;
    // The error is of the square of a cell, and so is the number of triangles.
    double finer = static_cast<double>(cells) * std::min(2.0, std::sqrt(error / tolerance) * 1.05);
    const double triangles = std::max(1.0, static_cast<double>(mesh.triangles.size()));
    finer = std::min(finer, static_cast<double>(cells) * std::sqrt(kMostTriangles / triangles));
    auto next =
        static_cast<std::size_t>(std::min(std::ceil(finer), static_cast<double>(kMaxSectionCells)));
    while (next > cells && grid_of(planes, next).cells() > kMostCells) next -= next / 16;
    if (next <= cells) return std::nullopt;
    return next;
}

Result<Surface> surface_of(const Field& field, const SectionPlanes& planes, const Camera& camera,
                           const SectionOptions& options,
                           const std::function<bool(double)>& progress) {
    Surface surface;
    std::optional<std::size_t> cells = kFirstCells;
    double last_error = HUGE_VAL, last_cells = 1;
    while (cells) {
        const SectionGrid grid = grid_of(planes, *cells);
        Result<SectionMesh> mesh = mesh_of_field(field, grid, options.threads, progress);
        if (!mesh) return mesh.error();
        const double error = chord_error(field, *mesh, planes, camera);
        // The error of a smooth surface falls with the square of the cells. Where it does not even
        // fall with the cells the surface is as rough as the grid is fine (noise, waves shorter
        // than a cell), and finer ones are no better.
        const auto now = static_cast<double>(*cells);
        if (error * now > last_error * last_cells) break;
        last_error = error;
        last_cells = now;
        surface.grid = grid;
        surface.mesh = std::move(*mesh);
        cells = refined(planes, surface.mesh, *cells, error, options.tolerance);
    }
    surface.drawn.reserve(surface.mesh.triangles.size());
    for (const Corners& c : surface.mesh.triangles) {
        const auto& p = surface.mesh.points;
        unsigned bits = 0;
        for (int k = 0; k < 3; ++k)
            if (planes.contain(p[c[k]], p[c[(k + 1) % 3]], p[c[(k + 2) % 3]])) bits |= 1u << k;
        surface.drawn.push_back(static_cast<std::uint8_t>(bits));
    }
    return surface;
}

/// Whether a side lies in the skin of the box.
bool on_skin(const Box& box, glm::dvec3 a, glm::dvec3 b) {
    for (int axis = 0; axis < 3; ++axis)
        if (a[axis] == b[axis] && (a[axis] == box.lo[axis] || a[axis] == box.hi[axis])) return true;
    return false;
}

/// The scene of all surfaces, each an object, each triangle a polygon whose edges are the sides
/// that are drawn.
Scene scene_of(std::vector<Surface>& surfaces, std::span<const Field> fields, const Box& box,
               bool boundary) {
    Scene scene;
    scene.materials.emplace_back();
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
        const Surface& from = surfaces[s];
        Object object;
        object.name = fields[s].name;
        object.first_triangle = object.first_polygon = scene.triangle_count();
        object.triangle_count = object.polygon_count =
            static_cast<std::uint32_t>(from.mesh.triangles.size());
        scene.objects.push_back(object);
        const auto first = static_cast<std::uint32_t>(scene.positions.size());
        const auto& p = from.mesh.points;
        scene.positions.insert(scene.positions.end(), p.begin(), p.end());
        for (std::size_t t = 0; t < from.mesh.triangles.size(); ++t) {
            const Corners c = from.mesh.triangles[t];
            unsigned edges = from.drawn[t];
            for (int k = 0; boundary && k < 3; ++k)
                if (on_skin(box, p[c[k]], p[c[(k + 1) % 3]])) edges |= 1u << k;
            scene.triangle_polygon.push_back(scene.triangle_count());
            scene.polygon_edges.push_back(static_cast<std::uint8_t>(edges));
            scene.triangles.push_back(c + first);
        }
        surfaces[s].mesh = {};
    }
    finish_scene_without_sheets(scene);
    return scene;
}

double distance_from_line(glm::dvec2 at, glm::dvec2 a, glm::dvec2 b) {
    const glm::dvec2 way = b - a, to = at - a;
    const double length = glm::length(way);
    return length > 0 ? std::abs(way.x * to.y - way.y * to.x) / length : glm::length(to);
}

/// What the lines of a traced scene are in a plot.
class LinePicker {
public:
    LinePicker(const Scene& scene, const std::vector<Surface>& surfaces, const Camera& camera)
        : scene_(scene), camera_(camera) {
        drawn_.reserve(scene.triangles.size());
        for (const Surface& s : surfaces)
            drawn_.insert(drawn_.end(), s.drawn.begin(), s.drawn.end());
    }

    /// Keeps the lines of the plot and gives them their kinds.
    void pick(DrawnLines& lines) const {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < lines.size(); ++i) {
            const auto kind = kind_of(lines, i);
            if (!kind) continue;
            lines.from[kept] = lines.from[i];
            lines.to[kept] = lines.to[i];
            lines.kind[kept] = *kind;
            lines.visible[kept] = lines.visible[i];
            lines.object[kept++] = lines.object[i];
        }
        lines.from.resize(kept);
        lines.to.resize(kept);
        lines.kind.resize(kept);
        lines.visible.resize(kept);
        lines.object.resize(kept);
        // Triangles mean nothing outside of here.
        lines.polygons.assign(kept, glm::uvec2(kNone));
    }

private:
    /// Nothing: the line is an edge of the mesh and no more.
    [[nodiscard]] std::optional<EdgeKind> kind_of(const DrawnLines& lines, std::size_t i) const {
        const glm::uvec2 faces = lines.polygons[i];
        const EdgeKind traced = lines.kind[i];
        switch (traced) {
            case EdgeKind::axis:
            case EdgeKind::outline:
            case EdgeKind::intersection:
                return traced;
            case EdgeKind::boundary:
                return is_drawn(faces.x, nearest_side(faces.x, 0.5 * (lines.from[i] + lines.to[i])))
                           ? EdgeKind::upper
                           : traced;
            case EdgeKind::silhouette:
                if (!share_drawn_side(faces)) return {};
                return EdgeKind::upper;
            default:
                return EdgeKind::upper;
        }
    }
    [[nodiscard]] bool is_drawn(std::uint32_t face, int side) const {
        return (drawn_[face] >> side & 1) != 0;
    }
    /// The side of a face that a point of the page lies on.
    [[nodiscard]] int nearest_side(std::uint32_t face, glm::dvec2 at) const {
        const Corners c = scene_.triangles[face];
        int nearest = 0;
        double least = HUGE_VAL;
        for (int k = 0; k < 3; ++k) {
            const double distance =
                distance_from_line(at, camera_.pixel_of(scene_.positions[c[k]]),
                                   camera_.pixel_of(scene_.positions[c[(k + 1) % 3]]));
            if (distance >= least) continue;
            least = distance;
            nearest = k;
        }
        return nearest;
    }
    /// Positions are compared: surfaces that lie on each other share them, but not their numbers.
    [[nodiscard]] bool share_drawn_side(glm::uvec2 faces) const {
        const auto at = [&](std::uint32_t face, int corner) {
            return scene_.positions[scene_.triangles[face][corner % 3]];
        };
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                const bool same =
                    (at(faces.x, i) == at(faces.y, j + 1) &&
                     at(faces.x, i + 1) == at(faces.y, j)) ||
                    (at(faces.x, i) == at(faces.y, j) && at(faces.x, i + 1) == at(faces.y, j + 1));
                if (same && (is_drawn(faces.x, i) || is_drawn(faces.y, j))) return true;
            }
        }
        return false;
    }

    const Scene& scene_;
    const Camera& camera_;
    std::vector<std::uint8_t> drawn_;  // of each triangle, see Surface
};

TraceOptions trace_options_for(const SectionOptions& options, std::size_t fields,
                               const std::function<bool(double)>& progress) {
    TraceOptions trace;
    // Sections are silhouettes, too, where the surface turns away along them.
    trace.edges = {EdgeKind::silhouette, EdgeKind::boundary, EdgeKind::border, EdgeKind::crease,
                   EdgeKind::mesh};
    trace.crease_angle = 180;
    trace.hidden = options.hidden;
    trace.threads = options.threads;
    trace.progress = progress;
    for (const auto& axis : options.axes)
        trace.free_lines.push_back(
            {axis[0], axis[1], EdgeKind::axis, static_cast<std::uint32_t>(fields)});
    return trace;
}

/// The curves on surface k that are not sections: its outline, and crossings with those after it.
void append_curves(std::span<const Field> fields, std::size_t k, const Surface& surface,
                   const SectionPlanes& planes, const Camera& camera, const SectionOptions& options,
                   std::vector<FreeLine>& lines) {
    const auto append = [&](const std::vector<FreeLine>& curves) {
        for (FreeLine line : curves) {
            line.object = static_cast<std::uint32_t>(k);
            lines.push_back(line);
        }
    };
    const MeshedField meshed{fields[k], surface.mesh, surface.grid};
    std::vector<Field> others(fields.begin(), fields.end());
    for (std::size_t other = k + 1; other < fields.size(); ++other)
        append(
            find_common_curves(meshed, fields[other], {camera, planes, others, options.threads}));
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    if (options.outline) append(find_outlines(meshed, {camera, planes, others, options.threads}));
}

/// The counts that belong to the lines which are left.
void count_lines(Drawing& drawing) {
    DrawingCounts& counts = drawing.counts;
    counts.visible_segments = counts.hidden_segments = 0;
    counts.visible_length = counts.hidden_length = 0;
    const DrawnLines& lines = drawing.lines;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const bool visible = lines.visible[i] != 0;
        ++(visible ? counts.visible_segments : counts.hidden_segments);
        (visible ? counts.visible_length : counts.hidden_length) +=
            glm::distance(lines.from[i], lines.to[i]);
    }
}

}  // namespace

Result<Drawing> trace_sections(std::span<const Field> fields, const Camera& camera,
                               const SectionOptions& options) {
    if (const Status fine = check(options); !fine) return fine.error();
    const SectionPlanes planes(options.box, options.x_planes, options.z_planes);
    double reached = 0;  // finer meshes begin anew, what is told goes on
    const auto progress_of = [&](double from, double to) -> std::function<bool(double)> {
        if (!options.progress) return {};
        return [&options, &reached, from, to](double share) {
            reached = std::max(reached, from + share * (to - from));
            return options.progress(reached);
        };
    };
    TraceOptions trace_options =
        trace_options_for(options, fields.size(), progress_of(kMeshingShare, 1));
    std::vector<Surface> surfaces;
    for (std::size_t k = 0; k < fields.size(); ++k) {
        const double share = kMeshingShare / static_cast<double>(fields.size());
        const double done = share * static_cast<double>(k);
        Result<Surface> surface =
            surface_of(fields[k], planes, camera, options, progress_of(done, done + share));
        if (!surface) return surface.error();
        append_curves(fields, k, *surface, planes, camera, options, trace_options.free_lines);
        surfaces.push_back(std::move(*surface));
    }
    const Scene scene = scene_of(surfaces, fields, options.box, options.boundary);
    ProjectOptions project_options;
    project_options.threads = options.threads;
    const Result<ScreenScene> page = page_of(scene, camera, project_options);
    if (!page) return page.error();
    Result<Drawing> drawing = trace(*page, trace_options);
    if (!drawing) return drawing;
    LinePicker(scene, surfaces, camera).pick(drawing->lines);
    count_lines(*drawing);
    return drawing;
}

}  // namespace sightline
