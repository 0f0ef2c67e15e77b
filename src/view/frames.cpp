#include "view/frames.hpp"

#include <glm/geometric.hpp>

#include "math/elementary.hpp"

namespace sightline {

namespace {

glm::dvec3 gaze_from(double azimuth_degrees, double elevation_degrees) {
    const double horizontal = math::cos_degrees(elevation_degrees);
    return -glm::dvec3(horizontal * math::sin_degrees(azimuth_degrees),
                       math::sin_degrees(elevation_degrees),
                       horizontal * math::cos_degrees(azimuth_degrees));
}

// In a +Y-up world.
Aim upright_aim(NamedView view) {
    const glm::dvec3 y{0, 1, 0};
    switch (view) {
        case NamedView::front:
            return {{0, 0, -1}, y};
        case NamedView::back:
            return {{0, 0, 1}, y};
        case NamedView::left:
            return {{1, 0, 0}, y};
        case NamedView::right:
            return {{-1, 0, 0}, y};
        case NamedView::top:
            return {{0, -1, 0}, {0, 0, -1}};
        case NamedView::bottom:
            return {{0, 1, 0}, {0, 0, 1}};
        case NamedView::isometric:
            return {{-1, -1, -1}, y};
        // The elevation at which one axis is foreshortened to half of the two others.
        case NamedView::dimetric:
            return {gaze_from(45, 20.7048), y};
        case NamedView::trimetric:
            return {gaze_from(30, 20), y};
    }
    return {{0, 0, -1}, y};
}

// Rodrigues' rotation by the shortest arc from +Y to the unit vector u. When u is -Y any axis
// across it serves; x is taken.
glm::dvec3 turn(const glm::dvec3& v, const glm::dvec3& u) {
    const double cosine = u.y;
    if (cosine <= -1.0 + 1e-15) return {v.x, -v.y, -v.z};
    const glm::dvec3 axis{u.z, 0, -u.x};  // Y x u
    return v * cosine + glm::cross(axis, v) + axis * (glm::dot(axis, v) / (1 + cosine));
}

}  // namespace

Aim aim_of(NamedView view, const glm::dvec3& world_up) {
    const glm::dvec3 u = glm::normalize(world_up);
    const Aim aim = upright_aim(view);
    return {turn(aim.gaze, u), turn(aim.up, u)};
}

}  // namespace sightline
