// Rotations about an axis through the origin, with the same bits on every machine.
#pragma once

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "math/elementary.hpp"

namespace sightline::math {

/// Rodrigues' rotation formula, counter-clockwise seen against the axis; the identity at multiples
/// of 360 degrees. Precondition: |axis| = 1.
[[nodiscard]] inline glm::dmat3 rotation_about(const glm::dvec3& axis, double degrees) {
    const double s = sin_degrees(degrees), c = cos_degrees(degrees);
    glm::dmat3 m(1.0);
    for (int column = 0; column < 3; ++column) {
        glm::dvec3 unit{0, 0, 0};
        unit[column] = 1;
        m[column] = c * unit + s * glm::cross(axis, unit) + ((1 - c) * axis[column]) * axis;
    }
    return m;
}

}  // namespace sightline::math
