// From the world to the screen, in double precision, before snapping.
//
// Notation. For a point p of the world, three linear functions: X and Y, whose quotients by w are
// screen coordinates relative to the picture's centre, in units of 1/2^subpixel_bits pixel, and the
// depth d along the gaze. w = d in perspective and 1 otherwise. Then
//
//     x = cx + X / w      y = cy + Y / w      z = z_offset + z_scale * (1/d in perspective, else d)
//
// Every implementation (vectors of any width, and the scalar one of the clipper) evaluates
// ((r.x p.x + r.y p.y) + r.z p.z) + r.w in this order and without fused operations, so that all
// of them give the same bits.
#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "sightline/screen_scene.hpp"

namespace sightline {

/// The values of the three linear functions at a point.
struct HomogeneousPoint {
    double x = 0, y = 0, d = 0;
    friend bool operator==(const HomogeneousPoint&, const HomogeneousPoint&) = default;
};

/// The view volume in screen units: near and far, and the guard band in x and y.
struct ViewVolume {
    double near_plane = 0, far_plane = 0;
    double x_min = 0, x_max = 0, y_min = 0, y_max = 0;
};

struct ScreenTransform {
    bool perspective = true;
    glm::dvec4 x_row{}, y_row{}, d_row{};
    double cx = 0, cy = 0;
    double z_offset = 0, z_scale = 0;
    ViewVolume volume;

    [[nodiscard]] HomogeneousPoint apply(const glm::dvec3& p) const {
        return {linear(x_row, p), linear(y_row, p), linear(d_row, p)};
    }
    [[nodiscard]] double w_of(const HomogeneousPoint& h) const { return perspective ? h.d : 1.0; }
    /// Rounds to the grid. Precondition: inside the volume up to rounding (it is clamped to it).
    [[nodiscard]] ScreenPoint snap(const HomogeneousPoint& h) const;
    /// Takes the picture itself for the guard band, so that nothing outside of it remains.
    void crop();
    [[nodiscard]] static double linear(const glm::dvec4& row, const glm::dvec3& p) {
        return ((row.x * p.x + row.y * p.y) + row.z * p.z) + row.w;
    }
};

/// Sub-pixel bits for a picture: 8, or fewer where the picture would not fit into kCoordBits.
[[nodiscard]] int subpixel_bits_for(Resolution resolution);

/// The same for a drawing: as many as fit.
[[nodiscard]] int page_bits_for(Resolution resolution);

[[nodiscard]] ScreenTransform make_transform(const Camera& camera, int subpixel_bits);
/// That of a page, see page_of().
[[nodiscard]] ScreenTransform page_transform(const ScreenScene& page);

}  // namespace sightline
