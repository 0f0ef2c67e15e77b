#include "shading/quadric_surface.hpp"

#include <cassert>
#include <glm/geometric.hpp>

#include "math/frame.hpp"
#include "shading/unit.hpp"

namespace sightline {

QuadricPoint quadric_point(const ScreenScene& screen, std::uint32_t id, std::int32_t x,
                           std::int32_t y) {
    const std::uint32_t k = id - screen.scene().triangle_count();
    const auto found = hit_quadric(screen, k, x, y);
    assert(found);
    const QuadricHit hit = found.value_or(QuadricHit{});
    const Quadric& quadric = screen.scene().quadrics[k];
    const math::Frame frame(quadric.frame);
    QuadricPoint point;
    point.position = frame.point(hit.own);
    point.depth = screen.metric_depth(hit.z);
    const glm::dvec3 view = screen.camera().view_vector(point.position);
    // The apex of a cone has no normal: there it faces the viewer.
    const glm::dvec3 n =
        unit_or(frame.normal(quadric.gradient_at(hit.own)), -unit_or(view, {0, 0, -1}));
    point.normal = glm::dot(n, view) > 0 ? -n : n;
    return point;
}

}  // namespace sightline
