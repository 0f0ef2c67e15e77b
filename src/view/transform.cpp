#include "view/transform.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace sightline {

namespace {

glm::dvec4 row_of(const glm::dvec3& direction, const glm::dvec3& origin) {
    return {direction, -glm::dot(direction, origin)};
}

void set_volume(ScreenTransform& t, const Camera& camera) {
    // One unit less than half the extent, so that differences stay below 2^b.
    constexpr double kHalf = (std::int32_t{1} << (kCoordBits - 1)) - 1;
    t.volume = {camera.near_plane, camera.far_plane, t.cx - kHalf,
                t.cx + kHalf,      t.cy - kHalf,     t.cy + kHalf};
}

}  // namespace

int subpixel_bits_for(Resolution resolution) {
    const double side = std::max(resolution.width, resolution.height);
    int bits = 8;
    // At least 6 % of guard band on either side.
    while (std::ldexp(side, bits) > 0.94 * (std::int32_t{1} << kCoordBits)) --bits;
    return bits;
}

int page_bits_for(Resolution resolution) {
    const double side = std::max(resolution.width, resolution.height);
    int bits = kCoordBits;
    while (std::ldexp(side, bits) >= (std::int32_t{1} << kCoordBits)) --bits;
    return bits;
}

void ScreenTransform::crop() {
    volume.x_min = volume.y_min = 0;
    volume.x_max = 2 * cx;
    volume.y_max = 2 * cy;
}

ScreenTransform make_transform(const Camera& camera, int subpixel_bits) {
    ScreenTransform t;
    t.perspective = camera.is_perspective();
    const double unit = std::ldexp(1.0, subpixel_bits);
    const double scale = camera.pixels_per_unit() * unit;
    t.cx = 0.5 * camera.resolution.width * unit;
    t.cy = 0.5 * camera.resolution.height * unit;
    t.d_row = row_of(camera.gaze(), camera.eye);
    t.x_row = row_of(camera.right, camera.eye);
    t.y_row = row_of(camera.up, camera.eye);
    if (!t.perspective) {
        const double target = camera.depth_of(camera.target);
        const glm::dvec4 beyond = t.d_row - glm::dvec4{0, 0, 0, target};
        t.x_row += camera.oblique.x * beyond;
        t.y_row += camera.oblique.y * beyond;
    }
    t.x_row *= scale;
    t.y_row *= -scale;  // y grows downwards on the screen
    const double n = camera.near_plane, f = camera.far_plane, range = f - n;
    if (t.perspective) {
        t.z_offset = f / range * kDepthMax;
        t.z_scale = -(f * n / range * kDepthMax);
    } else {
        t.z_scale = kDepthMax / range;
        t.z_offset = -n * t.z_scale;
    }
    set_volume(t, camera);
    return t;
}

ScreenTransform page_transform(const ScreenScene& page) {
    ScreenTransform t = make_transform(page.camera(), page.subpixel_bits());
    t.crop();
    return t;
}

ScreenPoint ScreenTransform::snap(const HomogeneousPoint& h) const {
    double x = h.x, y = h.y, depth = h.d;
    if (perspective) {
        const double inverse = 1.0 / h.d;
        x = h.x * inverse;
        y = h.y * inverse;
        depth = inverse;
    }
    const auto round_to = [](double value, double lo, double hi) {
        return static_cast<std::int32_t>(std::nearbyint(std::clamp(value, lo, hi)));
    };
    return {round_to(cx + x, volume.x_min, volume.x_max),
            round_to(cy + y, volume.y_min, volume.y_max),
            round_to(z_offset + z_scale * depth, 0, kDepthMax)};
}

}  // namespace sightline
