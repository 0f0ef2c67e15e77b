// Quadrics: the equations of spheres, cylinders, cones and general surfaces of the second degree.
//
// Source: J. Foley, A. van Dam, S. Feiner, J. Hughes, "Computer Graphics: Principles and Practice",
// 2nd ed., 1990, section 11.4. How this version differs: a quadric is kept in coordinates of its
// own, in which a sphere is the unit sphere, so that its equation loses no digits far from the
// origin.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "math/frame.hpp"
#include "sightline/scene.hpp"

namespace sightline {
namespace {

// A cut that a surface has no part in: far enough for rounding never to meet it.
constexpr double kBeyond = 2;
// Squares and cubes of what is smaller or larger leave the range of doubles in later stages.
constexpr double kSmallest = 1e-30, kLargest = 1e30;

glm::dmat4 frame_of(glm::dvec3 u, glm::dvec3 v, glm::dvec3 w, glm::dvec3 origin) {
    return {glm::dvec4(u, 0), glm::dvec4(v, 0), glm::dvec4(w, 0), glm::dvec4(origin, 1)};
}

/// Two vectors of a length at right angles to an axis and to each other.
std::array<glm::dvec3, 2> across(glm::dvec3 axis, double length) {
    const glm::dvec3 size = glm::abs(axis);
    const double largest = std::max({size.x, size.y, size.z});
    const glm::dvec3 a = axis / largest;
    const glm::dvec3 least = size.x <= size.y && size.x <= size.z ? glm::dvec3{1, 0, 0}
                             : size.y <= size.z                   ? glm::dvec3{0, 1, 0}
                                                                  : glm::dvec3{0, 0, 1};
    const glm::dvec3 u = glm::normalize(glm::cross(least, a));
    return {length * u, length * glm::normalize(glm::cross(a, u))};
}

/// The largest distance along the world's axes of a point of the ellipse u cos + v sin.
glm::dvec3 reach_of_ellipse(glm::dvec3 u, glm::dvec3 v) { return glm::sqrt(u * u + v * v); }

}  // namespace

double Quadric::value_at(glm::dvec3 own) const {
    const std::array<double, 10>& c = coefficients;
    return (own.x * (((c[0] * own.x + c[3] * own.y) + c[4] * own.z) + c[6]) +
            own.y * ((c[1] * own.y + c[5] * own.z) + c[7])) +
           (own.z * (c[2] * own.z + c[8]) + c[9]);
}

glm::dvec3 Quadric::gradient_at(glm::dvec3 own) const {
    const std::array<double, 10>& c = coefficients;
    return {(2 * c[0] * own.x + c[3] * own.y) + (c[4] * own.z + c[6]),
            (c[3] * own.x + 2 * c[1] * own.y) + (c[5] * own.z + c[7]),
            (c[4] * own.x + c[5] * own.y) + (2 * c[2] * own.z + c[8])};
}

Quadric make_sphere(glm::dvec3 centre, double radius) {
    const glm::dmat4 frame = frame_of({radius, 0, 0}, {0, radius, 0}, {0, 0, radius}, centre);
    return {QuadricKind::sphere,
            frame,
            {1, 1, 1, 0, 0, 0, 0, 0, 0, -1},
            {glm::dvec3(-kBeyond), glm::dvec3(kBeyond)}};
}

Quadric make_cylinder(glm::dvec3 from, glm::dvec3 to, double radius) {
    const auto [u, v] = across(to - from, radius);
    return {QuadricKind::cylinder,
            frame_of(u, v, 0.5 * (to - from), 0.5 * (from + to)),
            {1, 1, 0, 0, 0, 0, 0, 0, 0, -1},
            {{-kBeyond, -kBeyond, -1}, {kBeyond, kBeyond, 1}}};
}

Quadric make_cone(glm::dvec3 apex, glm::dvec3 base, double radius) {
    const auto [u, v] = across(base - apex, radius);
    return {QuadricKind::cone,
            frame_of(u, v, base - apex, apex),
            {1, 1, -1, 0, 0, 0, 0, 0, 0, 0},
            {{-kBeyond, -kBeyond, 0}, {kBeyond, kBeyond, 1}}};
}

Quadric make_quadric(const std::array<double, 10>& coefficients, const Box& box) {
    const glm::dvec3 m = box.centre(), h = 0.5 * box.extent();
    Quadric quadric;
    quadric.coefficients = coefficients;
    // Around the box's centre the constant is the value there and the linear part the gradient.
    const double value = quadric.value_at(m);
    const glm::dvec3 gradient = quadric.gradient_at(m);
    const std::array<double, 10>& c = coefficients;
    quadric.coefficients = {
        c[0] * h.x * h.x, c[1] * h.y * h.y, c[2] * h.z * h.z, c[3] * h.x * h.y, c[4] * h.x * h.z,
        c[5] * h.y * h.z, gradient.x * h.x, gradient.y * h.y, gradient.z * h.z, value};
    double largest = 0;
    for (const double factor : quadric.coefficients) largest = std::max(largest, std::abs(factor));
    for (double& factor : quadric.coefficients) factor /= largest;
    quadric.frame = frame_of({h.x, 0, 0}, {0, h.y, 0}, {0, 0, h.z}, m);
    return quadric;
}

Quadric transformed(Quadric quadric, const glm::dmat4& by) {
    quadric.frame = by * quadric.frame;
    return quadric;
}

bool is_regular(const Quadric& quadric) {
    for (const double factor : quadric.coefficients)
        if (!std::isfinite(factor)) return false;
    const math::Frame frame(quadric.frame);
    const double volume = std::abs(frame.determinant());
    double extent = 1;
    for (int k = 0; k < 3; ++k) extent *= glm::length(glm::dvec3(quadric.frame[k]));
    const Box box = bounds_of(quadric);
    const glm::dvec3 far = glm::max(glm::abs(box.lo), glm::abs(box.hi));
    const bool moderate = far.x <= kLargest && far.y <= kLargest && far.z <= kLargest;
    // A parallelepiped that is flat to 12 digits has no inverse to speak of.
    return moderate && volume >= 1e-12 * extent && volume >= kSmallest * kSmallest * kSmallest;
}

Box bounds_of(const Quadric& quadric) {
    const auto axis = [&](int k) { return glm::dvec3(quadric.frame[k]); };
    const glm::dvec3 origin = axis(3);
    const glm::dvec3 round = reach_of_ellipse(axis(0), axis(1));
    switch (quadric.kind) {
        case QuadricKind::sphere: {
            const glm::dvec3 reach =
                glm::sqrt(axis(0) * axis(0) + axis(1) * axis(1) + axis(2) * axis(2));
            return {origin - reach, origin + reach};
        }
        case QuadricKind::cylinder: {
            const glm::dvec3 reach = round + glm::abs(axis(2));
            return {origin - reach, origin + reach};
        }
        case QuadricKind::cone: {
            const glm::dvec3 base = origin + axis(2);
            return {glm::min(origin, base - round), glm::max(origin, base + round)};
        }
        case QuadricKind::general:
            break;
    }
    const glm::dvec3 m = quadric.clip.centre(), h = 0.5 * quadric.clip.extent();
    const glm::dvec3 centre = origin + m.x * axis(0) + m.y * axis(1) + m.z * axis(2);
    const glm::dvec3 reach =
        h.x * glm::abs(axis(0)) + h.y * glm::abs(axis(1)) + h.z * glm::abs(axis(2));
    return {centre - reach, centre + reach};
}

void add_quadric(Scene& scene, const Quadric& quadric, const std::string& name,
                 const Material& material) {
    Object object;
    object.name = name;
    object.first_triangle = scene.triangle_count();
    if (!scene.objects.empty())
        object.first_polygon =
            scene.objects.back().first_polygon + scene.objects.back().polygon_count;
    object.material = static_cast<std::uint32_t>(scene.materials.size());
    scene.materials.push_back(material);
    scene.objects.push_back(std::move(object));
    scene.quadrics.push_back(quadric);
}

}  // namespace sightline
