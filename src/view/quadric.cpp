// Rays and quadrics: the z of a surface that is not a polygon, computed at the sample.
//
// Source: E. Catmull, "Computer Display of Curved Surfaces", 1975, for a z-buffer of whatever can
// tell its z; the quadratic equation as in E. Haines et al., "Precision Improvements for Ray/Sphere
// Intersection", Ray Tracing Gems, 2019, chapter 7: the ray starts at its point nearest to the
// middle of the box, and the root that cancels is found from the other one.
//
// How this version differs: it is a definition. Coverage and depth at a sample are what this fixed
// sequence of + - * / sqrt on doubles gives, rounded to the depth grid; so all algorithms and all
// machines agree, and against triangles the rounded depth is compared exactly.
//
// Notation, in the quadric's own coordinates: the ray is p + s w, Q the quadric's polynomial. Then
// Q(p + s w) = A s^2 + 2 B s + C with A = Q's quadratic form of w, 2 B = w . grad Q(p), C = Q(p).
#include "view/quadric.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "math/frame.hpp"

namespace sightline {
namespace {

double quadratic_form(const std::array<double, 10>& c, glm::dvec3 w) {
    return (w.x * ((c[0] * w.x + c[3] * w.y) + c[4] * w.z) + w.y * (c[1] * w.y + c[5] * w.z)) +
           w.z * (c[2] * w.z);
}

/// Both roots of A s^2 + 2 B s + C, the smaller one first; NaN or infinite where there is none.
std::pair<double, double> roots(double a, double b, double c) {
    const double discriminant = b * b - a * c;
    if (!(discriminant >= 0)) {
        constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
        return {kNaN, kNaN};
    }
    const double q = -(b + std::copysign(std::sqrt(discriminant), b));
    const double first = q / a, second = c / q;
    // A double root at 0 makes the second one 0/0.
    return first <= second ? std::pair{first, second} : std::pair{second, first};
}

bool inside(const Box& box, glm::dvec3 p) {
    return p.x >= box.lo.x && p.x <= box.hi.x && p.y >= box.lo.y && p.y <= box.hi.y &&
           p.z >= box.lo.z && p.z <= box.hi.z;
}

/// Nearest whole unit of the depth grid, the even one of two: as ScreenTransform::snap().
std::int32_t depth_grid(const ScreenQuadrics& view, double depth) {
    const double z = view.z_offset + view.z_scale * (view.perspective ? 1.0 / depth : depth);
    return static_cast<std::int32_t>(
        std::nearbyint(std::clamp(z, 0.0, static_cast<double>(kDepthMax))));
}

// -- making -----------------------------------------------------------------------------------

/// The rays of a view in the world, in the notation of ScreenQuadric.
ScreenQuadric world_rays(const Camera& camera, const ScreenTransform& transform) {
    const double scale = camera.pixels_per_unit() * (transform.cx * 2 / camera.resolution.width);
    const glm::dvec3 across = camera.right / scale, down = camera.up / -scale;
    ScreenQuadric rays;
    rays.origin = camera.eye;
    rays.way = camera.gaze();
    if (camera.is_perspective()) {
        rays.way_x = across;
        rays.way_y = down;
        return rays;
    }
    const glm::dvec3 shift = camera.oblique.x * camera.right + camera.oblique.y * camera.up;
    rays.origin = rays.origin + camera.depth_of(camera.target) * shift;
    rays.way = rays.way - shift;
    rays.origin_x = across;
    rays.origin_y = down;
    return rays;
}

ScreenQuadric own_rays(const ScreenQuadric& world, const Quadric& quadric) {
    const math::Frame frame(quadric.frame);
    ScreenQuadric own;
    own.origin = frame.own_point(world.origin);
    own.origin_x = frame.own_vector(world.origin_x);
    own.origin_y = frame.own_vector(world.origin_y);
    own.way = frame.own_vector(world.way);
    own.way_x = frame.own_vector(world.way_x);
    own.way_y = frame.own_vector(world.way_y);
    return own;
}

/// A rectangle of the screen that holds all of it that can be seen: around the corners of its box
/// of the world, a pixel wider, or everything when some of that is not clearly before the eye.
void set_reach(ScreenQuadric& rays, const Box& box, const ScreenTransform& transform,
               std::int32_t pixel) {
    double x_min = transform.volume.x_max, x_max = transform.volume.x_min;
    double y_min = transform.volume.y_max, y_max = transform.volume.y_min;
    const double margin = pixel;
    bool all_before = true;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p{(corner & 1u) != 0 ? box.hi.x : box.lo.x,
                           (corner & 2u) != 0 ? box.hi.y : box.lo.y,
                           (corner & 4u) != 0 ? box.hi.z : box.lo.z};
        const HomogeneousPoint h = transform.apply(p);
        const double w = transform.w_of(h);
        all_before = all_before && (!transform.perspective || w >= transform.volume.near_plane);
        x_min = std::min(x_min, transform.cx + h.x / w - margin);
        x_max = std::max(x_max, transform.cx + h.x / w + margin);
        y_min = std::min(y_min, transform.cy + h.y / w - margin);
        y_max = std::max(y_max, transform.cy + h.y / w + margin);
    }
    const ViewVolume& v = transform.volume;
    if (!all_before) {
        x_min = v.x_min;
        x_max = v.x_max;
        y_min = v.y_min;
        y_max = v.y_max;
    }
    const auto whole = [](double value, double lo, double hi) {
        return static_cast<std::int32_t>(std::floor(std::clamp(value, lo, hi)));
    };
    rays.x_min = whole(x_min, v.x_min, v.x_max);
    rays.x_max = whole(x_max, v.x_min, v.x_max);
    rays.y_min = whole(y_min, v.y_min, v.y_max);
    rays.y_max = whole(y_max, v.y_min, v.y_max);
}

}  // namespace

void make_screen_quadrics(const std::vector<Quadric>& quadrics, const Camera& camera,
                          const ScreenTransform& transform, ScreenQuadrics& out) {
    out.rays.clear();
    out.perspective = transform.perspective;
    out.cx = transform.cx;
    out.cy = transform.cy;
    out.z_offset = transform.z_offset;
    out.z_scale = transform.z_scale;
    out.near_plane = camera.near_plane;
    out.far_plane = camera.far_plane;
    const auto pixel = static_cast<std::int32_t>(transform.cx * 2 / camera.resolution.width);
    const ScreenQuadric world = world_rays(camera, transform);
    for (const Quadric& quadric : quadrics) {
        ScreenQuadric rays = own_rays(world, quadric);
        set_reach(rays, bounds_of(quadric), transform, pixel);
        out.rays.push_back(rays);
    }
}

std::optional<QuadricHit> hit_quadric(const ScreenScene& screen, std::uint32_t k, std::int32_t x,
                                      std::int32_t y) {
    const ScreenQuadrics& view = screen.quadrics();
    const ScreenQuadric& rays = view.rays[k];
    if (x < rays.x_min || x > rays.x_max || y < rays.y_min || y > rays.y_max) return {};
    const Quadric& quadric = screen.scene().quadrics[k];
    const double dx = x - view.cx, dy = y - view.cy;
    const glm::dvec3 w = (rays.way + dx * rays.way_x) + dy * rays.way_y;
    const glm::dvec3 origin = (rays.origin + dx * rays.origin_x) + dy * rays.origin_y;
    const double start = glm::dot(quadric.clip.centre() - origin, w) / glm::dot(w, w);
    const glm::dvec3 p = origin + start * w;

    const double a = quadratic_form(quadric.coefficients, w);
    const double b = 0.5 * glm::dot(quadric.gradient_at(p), w);
    const auto [first, second] = roots(a, b, quadric.value_at(p));
    for (const double s : {first, second}) {
        const double depth = start + s;
        const glm::dvec3 own = p + s * w;
        // NaN and infinities fail here.
        if (depth >= view.near_plane && depth <= view.far_plane && inside(quadric.clip, own))
            return QuadricHit{depth_grid(view, depth), depth, own};
    }
    return {};
}

}  // namespace sightline
