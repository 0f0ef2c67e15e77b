// Cameras, projections and vanishing points.
//
// The camera looks along -z of its own space: `right`, `up` and `back` (= -gaze) are a right-handed
// orthonormal frame. `depth` is the distance along the gaze from the eye, in the scene's unit, in
// every projection. Pixel coordinates have their origin at the top left corner of the picture, x to
// the right and y down; the centre of pixel (i, j) is (i + 1/2, j + 1/2).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/error.hpp"

namespace sightline {

struct Box;
struct Scene;

enum class Projection { perspective, orthographic, cavalier, cabinet };

enum class NamedView { front, back, left, right, top, bottom, isometric, dimetric, trimetric };

/// What a user says about the camera; whatever is absent is chosen so that the whole scene is in
/// view. Angles in degrees.
struct CameraOptions {
    std::optional<glm::dvec3> eye, target;
    /// Eye and target are in the scene's own coordinates, not in those of its files (which are
    /// larger by Scene::offset).
    bool relative = false;
    std::optional<glm::dvec3> up;         ///< default +Y
    std::optional<glm::dvec3> direction;  ///< of the gaze, from the eye into the scene
    std::optional<NamedView> view;        ///< default isometric
    std::optional<Projection> projection;
    std::optional<double> fov;            ///< vertical, in (0, 180); default 40
    std::optional<double> ortho_height;   ///< height of a parallel view in the scene's unit
    std::optional<double> oblique_angle;  ///< default 45, counter-clockwise from +x of the page
    std::optional<double> zoom;           ///< default 1; enlarges about the centre
    std::optional<double> near_plane, far_plane;  ///< depths; fitted to the scene when absent
};

/// The fitted near plane of a perspective is at least this share of far. A step of z at the depth d
/// is d^2 / near / 2^30, so at the far end 1 / 1e-5 / 2^30 = 1e-4 of far.
inline constexpr double kLeastNear = 1e-5;

inline constexpr std::uint32_t kMaxSide = 65536;  ///< largest width or height of a picture

/// Size of a picture in pixels.
struct Resolution {
    std::uint32_t width = 1024, height = 768;
    friend bool operator==(const Resolution&, const Resolution&) = default;
};

/// A camera whose every number is decided. Build one with make_camera().
struct Camera {
    Projection projection = Projection::perspective;
    Resolution resolution;
    glm::dvec3 eye{0, 0, 0}, target{0, 0, -1};
    glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, back{0, 0, 1};  ///< orthonormal, right-handed
    /// The gaze as it was said, of any length: -back is this, rounded.
    glm::dvec3 aim{0, 0, -1};
    double fov = 40;           ///< vertical, degrees; perspective only
    double view_height = 2;    ///< of the view plane: at depth 1 in perspective, else in units
    glm::dvec2 oblique{0, 0};  ///< shift on the page of a point one unit behind the target's plane
    double near_plane = 1, far_plane = 2;  ///< depths, near < far; near > 0 in perspective

    [[nodiscard]] bool is_perspective() const { return projection == Projection::perspective; }
    [[nodiscard]] glm::dvec3 gaze() const { return -back; }
    /// Pixels per unit of the view plane.
    [[nodiscard]] double pixels_per_unit() const { return resolution.height / view_height; }
    /// Distance of a point along the gaze.
    [[nodiscard]] double depth_of(glm::dvec3 point) const;
    /// Pixel coordinates of a point (meaningless at or behind the eye in perspective).
    [[nodiscard]] glm::dvec2 pixel_of(glm::dvec3 point) const;
    /// Direction in the world (not normalised) along which a point is seen: from the eye to it in
    /// perspective, the direction of projection otherwise.
    [[nodiscard]] glm::dvec3 view_vector(glm::dvec3 point) const;
    /// Whether the plane through three points contains the eye, or in parallel projections the
    /// direction of projection: it is seen as a line. Decided exactly, on the very numbers that
    /// stand here: the eye; `aim` in orthographic views; the view vector in oblique ones.
    [[nodiscard]] bool sees_edge_on(const std::array<glm::dvec3, 3>& corners) const;
    /// The point of the world at a depth that projects onto a pixel coordinate.
    [[nodiscard]] glm::dvec3 unproject(glm::dvec2 pixel, double depth) const;
};

/// Depths from one to another; empty until something is taken in.
struct DepthRange {
    double nearest = std::numeric_limits<double>::infinity();
    double farthest = -std::numeric_limits<double>::infinity();
    [[nodiscard]] bool empty() const { return nearest > farthest; }
    void take_in(const DepthRange& other);
    friend bool operator==(const DepthRange&, const DepthRange&) = default;
};

/// Faces whose plane holds the eye cover nothing, but their edges can be drawn.
enum class EdgeOn { counts, is_left_out };

/// The depths at which a finished scene lies within the four sides of a view, whatever its near and
/// far planes; in perspective only what is in front of the eye. Triangles are clipped by the sides;
/// of a quadric the nearest depth is a lower bound, by little, and the farthest that of its box. Of
/// what moves all frames count. O(triangles), on all cores; the result does not depend on their
/// number.
[[nodiscard]] DepthRange depths_in_view(const Scene& scene, const Camera& camera,
                                        EdgeOn edge_on = EdgeOn::counts);

/// Tells at which depths something lies within the four sides of a view.
using DepthsInView = std::function<DepthRange(const Camera&)>;

/// Decides every number of a camera. `bounds` is the box of the scene, used to fit the view and the
/// near and far planes. In perspective, where the box reaches nearer to the eye's plane than 1e-4
/// of the far plane, near is fitted to the nearest depth that `depths` tells for a view 0.1 %
/// larger, if it is given; the fitted near is at least 1e-5 of the fitted far (or of a smaller one
/// that is given), which can cut what is nearer. Errors (bad_option): fov outside (0, 180), near
/// not below far, eye = target, up parallel to the gaze, heights, zooms or sizes that are not
/// positive, values not finite.
[[nodiscard]] Result<Camera> make_camera(const CameraOptions& options, const Box& bounds,
                                         Resolution resolution, const DepthsInView& depths = {});

/// The same for a finished scene, fitted to Scene::reach and depths_in_view(): nothing that can be
/// seen is cut by a fitted plane, unless it is nearer than 1e-5 of far. The camera is in the
/// scene's own coordinates: eye and target are those of relative_to().
[[nodiscard]] Result<Camera> make_camera(const CameraOptions& options, const Scene& scene,
                                         Resolution resolution);

/// The options in the own coordinates of a scene with this offset: eye and target less the offset,
/// unless they are relative already.
[[nodiscard]] CameraOptions relative_to(CameraOptions options, glm::dvec3 offset);

/// A camera on a turntable: the options for `camera`, which make_camera() made of `options`, turned
/// as a whole about the line along `axis` through its target, counter-clockwise when the axis
/// points at the viewer. Eye, target, up and the size of the view are then given, so that nothing
/// but near and far (where they are open) is fitted anew. Like the camera they are in the scene's
/// own coordinates. Precondition: axis is not 0.
[[nodiscard]] CameraOptions orbited(const CameraOptions& options, const Camera& camera,
                                    glm::dvec3 axis, double degrees);

/// The default camera of the benchmarks: box centre seen from (1, 0.6, 1.2), 2.2 bounding radii
/// away, fov 40; in the coordinates of the box, which are those of the scene.
[[nodiscard]] CameraOptions bench_camera(const Box& bounds);

/// A vanishing point: pixel coordinates, or nothing when it lies at infinity (the direction is
/// parallel to the view plane, or the projection is parallel).
using VanishingPoint = std::optional<glm::dvec2>;

/// Where lines of a direction of the world converge on the picture.
[[nodiscard]] VanishingPoint vanishing_point(const Camera& camera, glm::dvec3 direction);

/// Those of the world's x, y and z axes. How many are finite tells one-, two- and three-point
/// perspective apart.
[[nodiscard]] std::array<VanishingPoint, 3> principal_vanishing_points(const Camera& camera);

[[nodiscard]] std::optional<Projection> parse_projection(std::string_view name);
[[nodiscard]] std::string_view name_of(Projection projection);
[[nodiscard]] std::optional<NamedView> parse_view(std::string_view name);
[[nodiscard]] std::string_view name_of(NamedView view);

}  // namespace sightline
