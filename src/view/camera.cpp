// Deciding a camera: gaze, frame, projection, fit, near and far.
//
// Source: the viewing model of Foley, van Dam, Feiner, Hughes, "Computer Graphics: Principles and
// Practice", 2nd ed., chapter 6. Oblique projections are a shear along the gaze that leaves the
// target's plane in place, followed by an orthographic projection.
#include "sightline/camera.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "math/coplanar.hpp"
#include "math/elementary.hpp"
#include "math/moderate.hpp"
#include "sightline/scene.hpp"
#include "view/frames.hpp"

namespace sightline {

namespace {

// Options may give numbers between these: their squares can still be computed with.
constexpr double kLargest = 1e100, kSmallest = 1e-100;
constexpr double kFitMargin = 1.05;    // of the bounding sphere
constexpr double kDepthMargin = 1e-3;  // of the depth range, on both sides of near and far

// A box that stays farther than this share of far from the eye's plane needs no closer look.
constexpr double kClearNear = 1e-4;
// The view whose depths near is fitted to is larger by this share, for what is drawn at its sides.
constexpr double kViewMargin = 1e-3;

Error wrong(std::string message) { return {ErrorKind::bad_option, std::move(message)}; }

bool finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

Status check_vectors(const CameraOptions& o) {
    const std::pair<const char*, const std::optional<glm::dvec3>*> vectors[] = {
        {"--eye", &o.eye}, {"--target", &o.target}, {"--up", &o.up}, {"--direction", &o.direction}};
    for (const auto& [name, value] : vectors)
        if (*value && !finite(**value))
            return wrong(std::string(name) + " must have three finite numbers x,y,z");
    for (const auto& [name, value] : {vectors[0], vectors[1]})
        if (*value && glm::any(glm::greaterThan(glm::abs(**value), glm::dvec3(kLargest))))
            return wrong(std::string(name) + " lies too far away: give coordinates up to 1e100");
    if (o.up && *o.up == glm::dvec3(0)) return wrong("--up must not be 0,0,0: give a direction");
    if (o.direction && *o.direction == glm::dvec3(0))
        return wrong("--direction must not be 0,0,0: give the direction of the gaze");
    if (o.direction && o.view) return wrong("give --direction or --view, not both");
    if (o.eye && o.target && (o.direction || o.view))
        return wrong(
            "--eye and --target already say where the camera looks: drop --direction/--view");
    if (o.eye && o.target && *o.eye == *o.target)
        return wrong("--eye and --target are the same point: move one of them");
    return success();
}

Status check_numbers(const CameraOptions& o, Resolution resolution) {
    if (resolution.width == 0 || resolution.height == 0)
        return wrong("--resolution must not be zero: give WIDTHxHEIGHT in pixels");
    if (resolution.width > kMaxSide || resolution.height > kMaxSide)
        return wrong("--resolution must be at most 65536 a side");
    if (o.fov && !(*o.fov > 0 && *o.fov < 180))
        return wrong("--fov must lie between 0 and 180 degrees");
    const std::pair<const char*, const std::optional<double>*> positive[] = {
        {"--ortho-height", &o.ortho_height}, {"--zoom", &o.zoom}};
    for (const auto& [name, value] : positive)
        if (*value && !(**value > 0 && std::isfinite(**value)))
            return wrong(std::string(name) + " must be a positive number");
    for (const auto& [name, value] : {std::pair{"--fov", &o.fov}, positive[0], positive[1]})
        if (*value && !(**value >= kSmallest && **value <= kLargest))
            return wrong(std::string(name) + " must lie between 1e-100 and 1e100");
    const std::pair<const char*, const std::optional<double>*> any[] = {
        {"--oblique-angle", &o.oblique_angle}, {"--near", &o.near_plane}, {"--far", &o.far_plane}};
    for (const auto& [name, value] : any)
        if (*value && !std::isfinite(**value))
            return wrong(std::string(name) + " must be a finite number");
    for (const auto& [name, value] : {any[1], any[2]})
        if (*value && std::abs(**value) > kLargest)
            return wrong(std::string(name) + " must not lie beyond 1e100");
    if (o.near_plane && o.far_plane && !(*o.near_plane < *o.far_plane))
        return wrong("--near must be less than --far");
    const bool perspective =
        o.projection.value_or(Projection::perspective) == Projection::perspective;
    if (perspective && o.near_plane && *o.near_plane <= 0)
        return wrong("--near must be positive in perspective");
    if (perspective && o.far_plane && *o.far_plane <= 0)
        return wrong("--far must be positive in perspective");
    if (perspective && o.near_plane && *o.near_plane < kSmallest)
        return wrong("--near must be at least 1e-100 in perspective");
    if (perspective && o.far_plane && *o.far_plane < kSmallest)
        return wrong("--far must be at least 1e-100 in perspective");
    return success();
}

// The ball that has to be in view.
struct Ball {
    glm::dvec3 centre;
    double radius;
};

Ball ball_around(const Box& bounds) {
    if (bounds.empty()) return {{0, 0, 0}, 1};
    const double radius = 0.5 * glm::length(bounds.extent());
    return {bounds.centre(), radius > 0 ? radius : 1};
}

Aim choose_aim(const CameraOptions& o, const Ball& ball, Projection projection) {
    const glm::dvec3 world_up = math::moderate(o.up.value_or(glm::dvec3{0, 1, 0}));
    if (o.direction) return {math::moderate(*o.direction), world_up};
    if (!o.view && o.eye)
        return {math::moderate(o.target.value_or(ball.centre) - *o.eye), world_up};
    // An oblique picture shows the front in its true shape; of an oblique isometric one nothing is.
    const bool oblique = projection == Projection::cavalier || projection == Projection::cabinet;
    return aim_of(o.view.value_or(oblique ? NamedView::front : NamedView::isometric), world_up);
}

Status set_frame(Camera& camera, const Aim& aim) {
    if (glm::length(aim.gaze) == 0)
        return wrong("the camera stands at the centre of the scene: give --target or --direction");
    camera.aim = aim.gaze;
    camera.back = -glm::normalize(aim.gaze);
    const glm::dvec3 across = glm::cross(glm::normalize(aim.up), camera.back);
    if (!(glm::length(across) > 1e-9))
        return wrong("up is parallel to the direction of gaze: give another --up");
    camera.right = glm::normalize(across);
    camera.up = glm::cross(camera.back, camera.right);
    return success();
}

void set_oblique(Camera& camera, const CameraOptions& o) {
    const double scale = camera.projection == Projection::cavalier  ? 1.0
                         : camera.projection == Projection::cabinet ? 0.5
                                                                    : 0.0;
    const double angle = o.oblique_angle.value_or(45);
    camera.oblique = scale * glm::dvec2(math::cos_degrees(angle), math::sin_degrees(angle));
}

// Places the eye (where it is not given) and sizes the view plane, so that the ball is in view.
void set_fit(Camera& camera, const CameraOptions& o, const Ball& ball) {
    const double aspect = static_cast<double>(camera.resolution.width) / camera.resolution.height;
    const glm::dvec3 centre = o.target.value_or(ball.centre);
    const double radius = kFitMargin * (ball.radius + glm::length(centre - ball.centre));
    camera.fov = o.fov.value_or(40);
    const double half = math::tan_degrees(camera.fov / 2);
    if (o.eye) {
        camera.eye = *o.eye;
    } else if (camera.is_perspective()) {
        // A ball touches the sides of the narrower angle when radius / distance = sin of its half.
        const double narrow = half * std::min(1.0, aspect);
        const double sine = narrow / std::sqrt(1 + narrow * narrow);
        camera.eye = centre + (radius / sine) * camera.back;
    } else {
        camera.eye = centre + (2 * radius) * camera.back;
    }
    camera.target =
        o.target ? *o.target
        : o.eye  ? camera.eye + std::max(camera.depth_of(ball.centre), ball.radius) * camera.gaze()
                 : centre;
    const double zoom = o.zoom.value_or(1);
    if (camera.is_perspective()) {
        camera.view_height = 2 * half / zoom;
    } else {
        // The shadow of a sheared ball is at most this much longer than the ball.
        const double shear = std::sqrt(1 + glm::dot(camera.oblique, camera.oblique));
        const double fitted = 2 * radius * shear / std::min(1.0, aspect);
        camera.view_height = o.ortho_height.value_or(fitted) / zoom;
    }
}

// Where the box comes close to the eye's plane, or lies around the eye, it says too little: what is
// seen may still be far away.
double fit_near(const Camera& camera, const CameraOptions& o, double box_near,
                const DepthsInView& depths) {
    const double far = std::min(camera.far_plane, o.far_plane.value_or(camera.far_plane));
    const double least = kLeastNear * far;
    if (box_near >= kClearNear * camera.far_plane || o.near_plane || !depths)
        return std::max(box_near, least);
    Camera wider = camera;
    wider.view_height *= 1 + kViewMargin;
    const DepthRange range = depths(wider);
    return std::max(range.empty() ? box_near : (1 - kDepthMargin) * range.nearest, least);
}

// Near and far hug the box: 30 bits of 1/depth are wasted otherwise.
Status set_depths(Camera& camera, const CameraOptions& o, const Box& bounds,
                  const DepthsInView& depths) {
    double lo = 0, hi = 1;
    if (!bounds.empty()) {
        const double middle = camera.depth_of(bounds.centre());
        const glm::dvec3 half = 0.5 * bounds.extent(), g = camera.gaze();
        const double reach =
            std::abs(g.x) * half.x + std::abs(g.y) * half.y + std::abs(g.z) * half.z;
        lo = middle - reach;
        hi = middle + reach;
    }
    // A flat scene that faces the camera has no range of its own.
    const double size = std::max({hi - lo, 1e-6 * std::abs(hi), 1e-6 * std::abs(lo)});
    const double margin = kDepthMargin * (size > 0 ? size : 1);
    camera.near_plane = lo - margin;
    camera.far_plane = hi + margin;
    if (camera.is_perspective()) {
        if (camera.far_plane <= 0) camera.far_plane = 1;  // everything lies behind the eye
        camera.near_plane = fit_near(camera, o, camera.near_plane, depths);
    }
    if (o.near_plane) camera.near_plane = *o.near_plane;
    if (o.far_plane) camera.far_plane = *o.far_plane;
    if (!(camera.near_plane < camera.far_plane)) {
        // One plane was given, and it lies beyond what the other would be fitted to.
        const double gap = std::max(margin, kDepthMargin * std::abs(camera.near_plane));
        if (o.near_plane)
            camera.far_plane = camera.near_plane + gap;
        else if (camera.is_perspective())
            camera.near_plane = camera.far_plane * 0.5;
        else
            camera.near_plane = camera.far_plane - gap;
    }
    if (!(camera.near_plane < camera.far_plane) ||
        !std::isfinite(camera.far_plane - camera.near_plane))
        return wrong("--near and --far are too close together or too far apart to be told apart");
    return success();
}

}  // namespace

Result<Camera> make_camera(const CameraOptions& options, const Box& bounds, Resolution resolution,
                           const DepthsInView& depths) {
    if (Status s = check_vectors(options); !s) return s.error();
    if (Status s = check_numbers(options, resolution); !s) return s.error();
    Camera camera;
    camera.projection = options.projection.value_or(Projection::perspective);
    camera.resolution = resolution;
    const Ball ball = ball_around(bounds);
    if (Status s = set_frame(camera, choose_aim(options, ball, camera.projection)); !s)
        return s.error();
    set_oblique(camera, options);
    set_fit(camera, options, ball);
    if (!finite(camera.eye) || !std::isfinite(camera.view_height))
        return wrong("the camera lies too far away: its coordinates overflow; give a larger --fov");
    if (Status s = set_depths(camera, options, bounds, depths); !s) return s.error();
    return camera;
}

Result<Camera> make_camera(const CameraOptions& options, const Scene& scene,
                           Resolution resolution) {
    return make_camera(relative_to(options, scene.offset), scene.reach, resolution,
                       [&](const Camera& view) { return depths_in_view(scene, view); });
}

CameraOptions relative_to(CameraOptions options, glm::dvec3 offset) {
    if (options.relative) return options;
    if (options.eye) *options.eye -= offset;
    if (options.target) *options.target -= offset;
    options.relative = true;
    return options;
}

CameraOptions bench_camera(const Box& bounds) {
    CameraOptions options;
    options.relative = true;
    const double radius = 0.5 * glm::length(bounds.extent());
    options.target = bounds.centre();
    options.eye = bounds.centre() + 2.2 * radius * glm::normalize(glm::dvec3{1, 0.6, 1.2});
    options.fov = 40;
    return options;
}

double Camera::depth_of(glm::dvec3 point) const { return glm::dot(eye - point, back); }

glm::dvec2 Camera::pixel_of(glm::dvec3 point) const {
    const glm::dvec3 v = point - eye;
    const double depth = depth_of(point);
    glm::dvec2 page{glm::dot(v, right), glm::dot(v, up)};
    if (is_perspective())
        page /= depth;
    else
        page += oblique * (depth - depth_of(target));
    return {0.5 * resolution.width + page.x * pixels_per_unit(),
            0.5 * resolution.height - page.y * pixels_per_unit()};
}

glm::dvec3 Camera::view_vector(glm::dvec3 point) const {
    if (is_perspective()) return point - eye;
    return gaze() - oblique.x * right - oblique.y * up;
}

bool Camera::sees_edge_on(const std::array<glm::dvec3, 3>& corners) const {
    if (is_perspective()) return math::is_in_plane(corners, eye);
    return math::is_parallel_to_plane(
        corners, projection == Projection::orthographic ? aim : view_vector(corners[0]));
}

glm::dvec3 Camera::unproject(glm::dvec2 pixel, double depth) const {
    glm::dvec2 page{(pixel.x - 0.5 * resolution.width) / pixels_per_unit(),
                    (0.5 * resolution.height - pixel.y) / pixels_per_unit()};
    if (is_perspective())
        page *= depth;
    else
        page -= oblique * (depth - depth_of(target));
    return eye + page.x * right + page.y * up - depth * back;
}

}  // namespace sightline
