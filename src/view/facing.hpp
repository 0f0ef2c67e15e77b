// Back-face removal: which side of a face is seen.
#pragma once

#include <array>
#include <glm/vec3.hpp>

#include "sightline/camera.hpp"

namespace sightline {

enum class Facing { front, back, edge_on };

/// The plane test: the sign of V . N, where N is the normal by Newell's method and V runs from the
/// eye to the face in perspective and along the direction of projection otherwise. Negative: front.
[[nodiscard]] Facing facing(const Camera& camera, const std::array<glm::dvec3, 3>& corners);

/// The sign of C: the z component of the normal in the camera's own space, where the viewer is on
/// the positive side. Right for parallel projections perpendicular to the view plane. Positive:
/// front.
[[nodiscard]] Facing facing_by_c(const Camera& camera, const std::array<glm::dvec3, 3>& corners);

/// The winding of the picture of the face: counter-clockwise on the page is front.
/// Precondition: all corners have a picture (they lie in front of the eye).
[[nodiscard]] Facing facing_by_winding(const Camera& camera,
                                       const std::array<glm::dvec3, 3>& corners);

}  // namespace sightline
