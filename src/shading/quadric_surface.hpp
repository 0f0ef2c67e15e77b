// What shading needs to know of a visible quadric: it is computed at the sample, in every kind of
// shading, for there are no corners to interpolate between.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "sightline/screen_scene.hpp"

namespace sightline {

/// A point of a quadric in the world.
struct QuadricPoint {
    glm::dvec3 position{};
    glm::dvec3 normal{};  ///< the gradient's direction, unit, turned to the viewer
    double depth = 0;     ///< metric, rounded to the depth grid
};

/// The point of the quadric with this id that is seen at a point of the screen. Precondition: it is
/// seen there.
[[nodiscard]] QuadricPoint quadric_point(const ScreenScene& screen, std::uint32_t id,
                                         std::int32_t x, std::int32_t y);

}  // namespace sightline
