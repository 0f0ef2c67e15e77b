// Tessellation of quadrics, for the algorithms that take triangles only.
//
// Spheres, cylinders and cones have circles for sections, so their meshes are rings of vertices on
// such circles. Corners of polygons lie on the surface, the polygons inside of it.
#include "scene/quadric_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "math/elementary.hpp"
#include "math/frame.hpp"
#include "scene/finish.hpp"

namespace sightline {
namespace {

/// Appends a circle of vertices about the w axis.
void add_ring(QuadricMesh& mesh, std::uint32_t segments, double radius, double w) {
    for (std::uint32_t i = 0; i < segments; ++i) {
        const double degrees = 360.0 * i / segments;
        mesh.points.emplace_back(radius * math::cos_degrees(degrees),
                                 radius * math::sin_degrees(degrees), w);
    }
}

/// Joins the rings that begin at vertices `low` and `high`, which has the larger w.
void join_rings(QuadricMesh& mesh, std::uint32_t segments, std::uint32_t low, std::uint32_t high) {
    for (std::uint32_t i = 0; i < segments; ++i) {
        const std::uint32_t j = (i + 1) % segments;
        mesh.triangles.emplace_back(low + i, low + j, high + j);
        mesh.triangles.emplace_back(low + i, high + j, high + i);
    }
}

/// Joins a ring to a point below or above it.
void join_point(QuadricMesh& mesh, std::uint32_t segments, std::uint32_t ring, std::uint32_t point,
                bool above) {
    for (std::uint32_t i = 0; i < segments; ++i) {
        const std::uint32_t a = ring + i, b = ring + (i + 1) % segments;
        if (above)
            mesh.triangles.emplace_back(a, b, point);
        else
            mesh.triangles.emplace_back(b, a, point);
    }
}

std::uint32_t size(const AlignedVector<glm::dvec3>& points) {
    return static_cast<std::uint32_t>(points.size());
}

/// As many rings as make about square faces of a strip of this length around this radius.
std::uint32_t rings_for(double length, double radius, std::uint32_t segments) {
    constexpr double kTwoPi = 6.283185307179586;
    const double rings = length * segments / (kTwoPi * radius);
    return static_cast<std::uint32_t>(std::clamp(std::nearbyint(rings), 1.0, double{1} * segments));
}

QuadricMesh mesh_of(const Quadric& quadric, std::uint32_t segments) {
    const auto length = [&](int axis) { return glm::length(glm::dvec3(quadric.frame[axis])); };
    const double radius = std::max(length(0), length(1));
    switch (quadric.kind) {
        case QuadricKind::sphere:
            return mesh_of_sphere(segments);
        case QuadricKind::cylinder:
            return mesh_of_cylinder(segments, rings_for(2 * length(2), radius, segments));
        case QuadricKind::cone: {
            const double side = std::sqrt(length(2) * length(2) + radius * radius);
            return mesh_of_cone(segments, rings_for(side, radius, segments));
        }
        case QuadricKind::general:
            break;
    }
    return march_quadric(quadric, std::max(1u, segments * 3 / 4));
}

/// The apex of a cone has no normal: that of the corner's own face serves there.
glm::vec3 unit_normal(const glm::dvec3& n) {
    const double largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
    if (!(largest > 0)) return {0, 0, 0};
    return glm::vec3(glm::normalize(n / largest));
}

/// Puts meshes in the place of a scene's quadrics.
class Tessellator {
public:
    Tessellator(Scene& scene, std::uint32_t segments) : scene_(scene), segments_(segments) {}

    void run() {
        const std::vector<Quadric> quadrics = std::move(scene_.quadrics);
        scene_.quadrics.clear();
        fill(scene_.triangle_normals);
        const std::size_t first = scene_.objects.size() - quadrics.size();
        for (std::size_t k = 0; k < quadrics.size(); ++k)
            append(quadrics[k], scene_.objects[first + k]);
        if (!scene_.triangle_colors.empty()) fill(scene_.triangle_colors);
        finish_derived_scene(scene_);
    }

private:
    /// No attribute for triangles that have none yet.
    void fill(AlignedVector<Corners>& corners) const {
        corners.resize(scene_.triangles.size(), Corners(kNone));
    }

    void append(const Quadric& quadric, Object& object) {
        const QuadricMesh mesh = mesh_of(quadric, segments_);
        const math::Frame frame(quadric.frame);
        object.first_triangle = scene_.triangle_count();
        object.first_polygon = polygons_before(object);
        object.triangle_count = static_cast<std::uint32_t>(mesh.triangles.size());
        object.has_file_normals = true;
        const std::uint32_t first_point = size(scene_.positions);
        const auto first_normal = static_cast<std::uint32_t>(scene_.normals.size());
        for (const glm::dvec3& point : mesh.points) {
            scene_.positions.push_back(frame.point(point));
            scene_.normals.push_back(unit_normal(frame.normal(quadric.gradient_at(point))));
        }
        const bool mirrored = frame.determinant() < 0;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            const bool second = mesh.quads && t % 2 == 1;
            Corners corners = mesh.triangles[t];
            std::uint8_t edges = !mesh.quads ? 7 : second ? 6 : 3;
            if (mirrored) {
                std::swap(corners.y, corners.z);
                // Sides 0 and 2 change places, side 1 turns round.
                edges =
                    static_cast<std::uint8_t>((edges & 2) | (edges & 1) << 2 | (edges >> 2 & 1));
            }
            scene_.triangles.push_back(corners + first_point);
            scene_.triangle_normals.push_back(corners + first_normal);
            scene_.polygon_edges.push_back(edges);
            if (!second) ++object.polygon_count;
            scene_.triangle_polygon.push_back(object.first_polygon + object.polygon_count - 1);
        }
    }

    [[nodiscard]] std::uint32_t polygons_before(const Object& object) const {
        if (&object == scene_.objects.data()) return 0;
        const Object& before = *(&object - 1);
        return before.first_polygon + before.polygon_count;
    }

    Scene& scene_;
    std::uint32_t segments_;
};

}  // namespace

QuadricMesh mesh_of_sphere(std::uint32_t segments) {
    const std::uint32_t rings = segments / 2;
    QuadricMesh mesh;
    mesh.points.emplace_back(0, 0, -1);
    for (std::uint32_t r = 1; r < rings; ++r) {
        const double latitude = 180.0 * r / rings - 90.0;
        add_ring(mesh, segments, math::cos_degrees(latitude), math::sin_degrees(latitude));
    }
    mesh.points.emplace_back(0, 0, 1);
    const std::uint32_t top = size(mesh.points) - 1;
    join_point(mesh, segments, 1, 0, false);
    for (std::uint32_t r = 1; r + 1 < rings; ++r)
        join_rings(mesh, segments, 1 + (r - 1) * segments, 1 + r * segments);
    join_point(mesh, segments, top - segments, top, true);
    return mesh;
}

QuadricMesh mesh_of_cylinder(std::uint32_t segments, std::uint32_t rings) {
    QuadricMesh mesh;
    mesh.quads = true;
    for (std::uint32_t r = 0; r <= rings; ++r) add_ring(mesh, segments, 1, 2.0 * r / rings - 1);
    for (std::uint32_t r = 0; r < rings; ++r)
        join_rings(mesh, segments, r * segments, (r + 1) * segments);
    return mesh;
}

QuadricMesh mesh_of_cone(std::uint32_t segments, std::uint32_t rings) {
    QuadricMesh mesh;
    mesh.points.emplace_back(0, 0, 0);
    for (std::uint32_t r = 1; r <= rings; ++r) {
        const double w = double{1} * r / rings;
        add_ring(mesh, segments, w, w);
    }
    join_point(mesh, segments, 1, 0, false);
    for (std::uint32_t r = 1; r < rings; ++r)
        join_rings(mesh, segments, 1 + (r - 1) * segments, 1 + r * segments);
    return mesh;
}

Scene tessellate_quadrics(const Scene& scene, std::uint32_t segments) {
    Scene result = scene;
    if (!scene.quadrics.empty()) Tessellator(result, segments).run();
    return result;
}

}  // namespace sightline
