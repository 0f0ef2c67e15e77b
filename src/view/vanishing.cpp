// Vanishing points: where the pictures of parallel lines converge.
// Source: Foley, van Dam, Feiner, Hughes, "Computer Graphics: Principles and Practice", 2nd ed.,
// section 6.1.1. The point is the picture of the direction itself: that of eye + direction * t as t
// grows without bound.
#include <cmath>
#include <glm/geometric.hpp>

#include "math/moderate.hpp"
#include "sightline/camera.hpp"

namespace sightline {

VanishingPoint vanishing_point(const Camera& camera, glm::dvec3 direction) {
    direction = math::moderate(direction);
    const double along = glm::dot(direction, camera.gaze());
    // A direction this close to the view plane is parallel to it but for the rounding of the frame.
    constexpr double kParallel = 1e-12;
    if (!camera.is_perspective() || !(std::abs(along) > kParallel * glm::length(direction)))
        return std::nullopt;
    const double scale = camera.pixels_per_unit() / along;
    return glm::dvec2{0.5 * camera.resolution.width + glm::dot(direction, camera.right) * scale,
                      0.5 * camera.resolution.height - glm::dot(direction, camera.up) * scale};
}

std::array<VanishingPoint, 3> principal_vanishing_points(const Camera& camera) {
    return {vanishing_point(camera, {1, 0, 0}), vanishing_point(camera, {0, 1, 0}),
            vanishing_point(camera, {0, 0, 1})};
}

}  // namespace sightline
