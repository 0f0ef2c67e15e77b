// Perspective-correct barycentric coordinates from homogeneous ones.
//
// In the camera's space let v0, v1, v2 be the corners and d = (X, Y, 1) the ray through the point
// (X, Y) of the view plane at depth 1. By Cramer's rule (T. Moller, B. Trumbore, "Fast, minimum
// storage ray/triangle intersection", 1997) the ray meets the plane at
//
//     b1 = d . (e2 x v0) / s,   b2 = d . (v0 x e1) / s,   s = d . (e1 x e2),   e_k = v_k - v0,
//
// all linear in X and Y. We differ in two ways. d is replaced by d - v0 / v0.z in the numerators,
// which changes nothing (both are perpendicular to v0) but leaves only differences of positions on
// the page, so that small triangles far away lose no digits. And parallel projections use the same
// formulas with v = (X of the corner, Y of the corner, 1).
#include "shading/surface.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "scene/tolerance.hpp"

namespace sightline {
namespace {

constexpr glm::dvec3 kMiddle{1.0 / 3, 1.0 / 3, 1.0 / 3};

/// A corner in the camera's space, its x and y in pixels at depth 1 and y down the picture.
glm::dvec3 camera_space(const Camera& camera, glm::dvec3 point) {
    const double scale = camera.pixels_per_unit();
    if (!camera.is_perspective()) {
        const glm::dvec2 pixel = camera.pixel_of(point);
        return {pixel.x - 0.5 * camera.resolution.width, pixel.y - 0.5 * camera.resolution.height,
                1.0};
    }
    const glm::dvec3 v = point - camera.eye;
    return {glm::dot(v, camera.right) * scale, glm::dot(v, camera.up) * -scale,
            -glm::dot(v, camera.back)};
}

using Triangle = std::array<glm::dvec3, 3>;

Triangle corners_of(const Scene& scene, const Corners& c) {
    return {scene.positions[c.x], scene.positions[c.y], scene.positions[c.z]};
}

/// Twice the area, along the normal.
glm::dvec3 area_vector(const Triangle& p) { return glm::cross(p[1] - p[0], p[2] - p[0]); }

/// The triangles of a source polygon: they stand together, in ascending order of polygons.
struct PolygonRange {
    std::uint32_t first, last;
};

PolygonRange polygon_of(const Scene& scene, std::uint32_t id) {
    constexpr std::uint32_t kSteps = 16;  // further ones are looked up in O(log n)
    const auto& polygons = scene.triangle_polygon;
    if (id >= polygons.size()) return {id, id};
    const auto shares = [&](std::uint32_t t) { return polygons[t] == polygons[id]; };
    PolygonRange range{id, id};
    const std::uint32_t lowest = id < kSteps ? 0 : id - kSteps;
    const auto highest =
        static_cast<std::uint32_t>(std::min(polygons.size() - 1, std::size_t{id} + kSteps));
    while (range.first > lowest && shares(range.first - 1)) --range.first;
    while (range.last < highest && shares(range.last + 1)) ++range.last;
    if (id - range.first == kSteps || range.last - id == kSteps) {
        const auto all = std::equal_range(polygons.begin(), polygons.end(), polygons[id]);
        range = {static_cast<std::uint32_t>(all.first - polygons.begin()),
                 static_cast<std::uint32_t>(all.second - polygons.begin()) - 1};
    }
    return range;
}

/// The largest of (at most 32 of) the triangles of a polygon, whose plane is known best.
std::uint32_t largest_of(const Scene& scene, const PolygonRange& range) {
    if (range.first == range.last) return range.first;
    const std::uint32_t step = (range.last - range.first) / 32 + 1;
    std::uint32_t largest = range.first;
    double most = -1;
    for (std::uint64_t t = range.first; t <= range.last; t += step) {
        const glm::dvec3 n = area_vector(corners_of(scene, scene.triangles[t]));
        const double area = glm::dot(n, n);
        if (!(area > most)) continue;
        most = area;
        largest = static_cast<std::uint32_t>(t);
    }
    return largest;
}

/// Whether corners lie in the plane of other ones, up to the precision of coordinates.
bool lies_in(const Scene& scene, const Triangle& corners, const Triangle& plane) {
    const glm::dvec3 n = unit_or(area_vector(plane), {0, 0, 0});
    const double tolerance = rounding_of(scene.bounds, scene.rounding);
    return std::ranges::all_of(corners, [&](const glm::dvec3& p) {
        return std::abs(glm::dot(n, p - plane[0])) <= tolerance;
    });
}

/// Three points of the plane of a face: the same ones for all triangles of a flat polygon (thin
/// ones can be too uncertain for its sheet), and for all faces of a sheet, so that they are lit
/// alike.
Triangle plane_of(const Scene& scene, std::uint32_t id) {
    const auto of_sheet = [&](std::uint32_t t) {
        const std::uint32_t sheet = scene.sheets.of(t);
        return corners_of(scene, sheet == kNone ? scene.triangles[t] : scene.sheets.frame[sheet]);
    };
    const PolygonRange polygon = polygon_of(scene, id);
    const std::uint32_t largest = largest_of(scene, polygon);
    if (largest == id ||
        (scene.sheets.of(id) != kNone && scene.sheets.of(largest) == scene.sheets.of(id))) {
        return of_sheet(id);
    }
    const Triangle plane = of_sheet(largest);
    return lies_in(scene, corners_of(scene, scene.triangles[id]), plane) ? plane : of_sheet(id);
}

/// The normal of a plane, turned to the side from which it is seen.
glm::dvec3 facing_normal(const Camera& camera, const Triangle& p) {
    const glm::dvec3 view = camera.view_vector(p[0]);
    const glm::dvec3 n = unit_or(area_vector(p), -unit_or(view, {0, 0, -1}));
    return glm::dot(n, view) > 0 ? -n : n;
}

/// The face decides the side of its corners' normals: one beyond the silhouette, which turns away
/// from the viewer, must not jump to the other.
glm::dvec3 on_side_of(glm::dvec3 face, glm::dvec3 n) { return glm::dot(n, face) < 0 ? -n : n; }

}  // namespace

const Material& material_of(const Scene& scene, std::uint32_t id) {
    static const Material kDefault;
    if (scene.objects.empty()) return kDefault;
    const std::uint32_t material = scene.objects[scene.object_of(id)].material;
    return material < scene.materials.size() ? scene.materials[material] : kDefault;
}

BarycentricMap::BarycentricMap(const Camera& camera, const std::array<glm::dvec3, 3>& corners) {
    std::array<glm::dvec3, 3> v;
    for (std::size_t k = 0; k < 3; ++k) v[k] = camera_space(camera, corners[k]);
    // The deepest corner is in front of the eye when anything of the triangle is.
    for (int k = 1; k < 3; ++k) {
        if (v[static_cast<std::size_t>(k)].z > v[static_cast<std::size_t>(base_)].z) base_ = k;
    }
    const glm::dvec3 v0 = v[static_cast<std::size_t>(base_)];
    const glm::dvec3 e1 = v[static_cast<std::size_t>((base_ + 1) % 3)] - v0;
    const glm::dvec3 e2 = v[static_cast<std::size_t>((base_ + 2) % 3)] - v0;
    const glm::dvec3 area = glm::cross(e1, e2);
    first_ = glm::dvec2(glm::cross(e2, v0));
    second_ = glm::dvec2(glm::cross(v0, e1));
    sum_ = glm::dvec2(area);
    sum_at_origin_ = glm::dot(v0, area) / v0.z;
    origin_ =
        glm::dvec2(v0) / v0.z + 0.5 * glm::dvec2(camera.resolution.width, camera.resolution.height);
}

glm::dvec3 BarycentricMap::at(glm::dvec2 pixel) const {
    const glm::dvec2 d = pixel - origin_;
    const double inverse = 1.0 / (sum_at_origin_ + glm::dot(d, sum_));
    // Written so that a NaN, from a triangle seen edge-on, becomes 0.
    const double b1 = std::max(0.0, glm::dot(d, first_) * inverse);
    const double b2 = std::max(0.0, glm::dot(d, second_) * inverse);
    const double b0 = std::max(0.0, 1.0 - b1 - b2);
    const double total = b0 + b1 + b2;
    if (!(total <= 1e6)) return kMiddle;
    glm::dvec3 b;
    b[base_] = b0 / total;
    b[(base_ + 1) % 3] = b1 / total;
    b[(base_ + 2) % 3] = b2 / total;
    return b;
}

Surface make_surface(const ScreenScene& screen, std::uint32_t id) {
    const Scene& scene = screen.scene();
    Surface surface;
    surface.corners = corners_of(scene, scene.triangles[id]);
    surface.normal = facing_normal(screen.camera(), plane_of(scene, id));
    surface.material = &material_of(scene, id);
    surface.smooth = !scene.triangle_normals.empty() && scene.triangle_normals[id].x != kNone;
    surface.colored = !scene.triangle_colors.empty() && scene.triangle_colors[id].x != kNone;
    return surface;
}

void add_attributes(const ScreenScene& screen, std::uint32_t id, Surface& surface) {
    const Scene& scene = screen.scene();
    surface.barycentrics = BarycentricMap(screen.camera(), surface.corners);
    surface.normals.fill(surface.normal);
    for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        if (surface.smooth) {
            const glm::dvec3 n(scene.normals[scene.triangle_normals[id][k]]);
            surface.normals[i] = on_side_of(surface.normal, unit_or(n, surface.normal));
        }
        if (surface.colored) {
            surface.colors[i] = scene.colors[scene.triangle_colors[id][k]];
        }
    }
}

glm::dvec3 polygon_point(const Scene& scene, std::uint32_t id) {
    const PolygonRange polygon = polygon_of(scene, id);
    glm::dvec3 sum{0, 0, 0};
    for (const std::uint32_t t : {polygon.first, polygon.last}) {
        for (int k = 0; k < 3; ++k) sum += scene.positions[scene.triangles[t][k]];
    }
    return sum / 6.0;
}

glm::dvec3 position_at(const Surface& surface, glm::dvec3 b) {
    return b.x * surface.corners[0] + b.y * surface.corners[1] + b.z * surface.corners[2];
}

glm::dvec3 normal_at(const Surface& surface, glm::dvec3 b) {
    return unit_or(b.x * surface.normals[0] + b.y * surface.normals[1] + b.z * surface.normals[2],
                   surface.normal);
}

}  // namespace sightline
