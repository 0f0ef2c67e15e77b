// A camera on a turntable.
#include <cmath>
#include <glm/geometric.hpp>

#include "math/rotation.hpp"
#include "sightline/camera.hpp"

namespace sightline {

CameraOptions orbited(const CameraOptions& options, const Camera& camera, glm::dvec3 axis,
                      double degrees) {
    const glm::dmat3 turn = math::rotation_about(glm::normalize(axis), degrees);
    CameraOptions turned = options;
    turned.direction = std::nullopt;
    turned.view = std::nullopt;
    turned.relative = true;
    turned.target = camera.target;
    // The sum would round, even where nothing turns.
    turned.eye =
        turn == glm::dmat3(1.0) ? camera.eye : camera.target + turn * (camera.eye - camera.target);
    turned.up = turn * camera.up;
    turned.projection = camera.projection;
    if (!camera.is_perspective()) {
        // Fitted to a target that was not given, it might be another one now.
        turned.ortho_height = camera.view_height;
        turned.zoom = std::nullopt;
    }
    return turned;
}

}  // namespace sightline
