// Pages and drawings for tests, and what the parts of a drawing are before they are rounded.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "drawing/lines.hpp"
#include "drawing/regions.hpp"
#include "support/amount.hpp"
#include "support/scenes.hpp"

namespace sightline::testing {

/// Feature edges, mesh edges and curves: all that can be drawn.
inline constexpr EdgeKinds kAllEdges = {EdgeKind::silhouette, EdgeKind::boundary,
                                        EdgeKind::border,     EdgeKind::crease,
                                        EdgeKind::mesh,       EdgeKind::intersection};

inline ScreenScene page(const Scene& scene, const Camera& camera, Cull cull = Cull::none) {
    ProjectOptions options;
    options.cull = cull;
    return must(page_of(scene, camera, options));
}

/// The first triangles of a scene.
inline Scene beginning(const Scene& scene, std::uint32_t count) {
    SceneBuilder b;
    for (std::uint32_t t = 0; t < std::min(count, scene.triangle_count()); ++t) {
        const Corners c = scene.triangles[t];
        b.triangle(scene.positions[c.x], scene.positions[c.y], scene.positions[c.z]);
    }
    return b.build();
}

/// The lines of a page with their exact hidden parts.
struct CutLines {
    PageEdges edges;
    HiddenParts parts;

    [[nodiscard]] std::span<const EdgeInterval> hidden_of(std::size_t edge) const {
        return std::span(parts.hidden)
            .subspan(parts.first[edge], parts.first[edge + 1] - parts.first[edge]);
    }
};

inline CutLines cut_lines(const ScreenScene& page, const Occluders& occluders,
                          const TraceOptions& options) {
    CutLines lines;
    const std::function<bool(double)> nobody;
    WorkMeter meter(nobody);
    lines.edges = collect_edges(page, options);
    if (options.edges.has(EdgeKind::intersection))
        append_crossings(occluders, options.threads, meter, lines.edges);
    lines.parts = find_hidden_parts(page, occluders, lines.edges, options.threads, meter);
    return lines;
}

/// A view along -z in which a unit of the scene is a pixel: (x, y) stands at x + W/2, H/2 - y.
inline Camera pixel_camera(Resolution resolution, double depth = 100) {
    CameraOptions options;
    options.projection = Projection::orthographic;
    options.eye = glm::dvec3(0, 0, depth);
    options.target = glm::dvec3(0, 0, 0);
    options.ortho_height = resolution.height;
    options.near_plane = 1;
    options.far_plane = 2 * depth;
    return must(make_camera(options, {{-1, -1, -1}, {1, 1, 1}}, resolution));
}

/// An upright rectangle that faces the eye of pixel_camera().
inline void add_square(SceneBuilder& b, glm::dvec2 lo, glm::dvec2 hi, double z) {
    b.quad({lo.x, lo.y, z}, {hi.x, lo.y, z}, {hi.x, hi.y, z}, {lo.x, hi.y, z});
}

/// Total length of the lines of a kind, visible or hidden ones, in pixels.
inline double length_of(const Drawing& drawing, EdgeKinds kinds, bool visible) {
    double sum = 0;
    for (std::size_t i = 0; i < drawing.lines.size(); ++i) {
        if (!kinds.has(drawing.lines.kind[i]) || (drawing.lines.visible[i] != 0) != visible)
            continue;
        const glm::dvec2 d = drawing.lines.to[i] - drawing.lines.from[i];
        sum += std::hypot(d.x, d.y);
    }
    return sum;
}

/// The same of those that run along a -> b, given in pixels.
inline double length_along(const Drawing& drawing, glm::dvec2 a, glm::dvec2 b, bool visible) {
    const glm::dvec2 along = (b - a) / std::hypot(b.x - a.x, b.y - a.y);
    const double whole = std::hypot(b.x - a.x, b.y - a.y);
    const auto on_it = [&](const glm::dvec2& p) {
        const glm::dvec2 d = p - a;
        const double t = d.x * along.x + d.y * along.y;
        return std::abs(d.x * along.y - d.y * along.x) < 1e-3 && t > -1e-3 && t < whole + 1e-3;
    };
    double sum = 0;
    for (std::size_t i = 0; i < drawing.lines.size(); ++i) {
        const glm::dvec2 &p = drawing.lines.from[i], &q = drawing.lines.to[i];
        if ((drawing.lines.visible[i] != 0) == visible && on_it(p) && on_it(q))
            sum += std::hypot(q.x - p.x, q.y - p.y);
    }
    return sum;
}

inline TraceOptions with_hidden(EdgeKinds kinds = kFeatureEdges) {
    TraceOptions options;
    options.edges = kinds;
    options.hidden = true;
    return options;
}

}  // namespace sightline::testing
