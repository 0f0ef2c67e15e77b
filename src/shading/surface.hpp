// What shading needs to know of a visible triangle.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "shading/unit.hpp"
#include "sightline/screen_scene.hpp"

namespace sightline {

/// Barycentric coordinates in the world of the point of a triangle that is seen at a point of the
/// picture. Exact perspective: they come from the triangle of the world, not from the screen.
class BarycentricMap {
public:
    BarycentricMap() = default;
    BarycentricMap(const Camera& camera, const std::array<glm::dvec3, 3>& corners);

    /// At pixel coordinates. Each in 0..1 and their sum 1 (up to rounding), clamped to the
    /// triangle: snapping can put a sample a little outside of it. A triangle that is seen edge-on
    /// answers with its centre.
    [[nodiscard]] glm::dvec3 at(glm::dvec2 pixel) const;

private:
    // With base corner v0 and e1 = v1 - v0, e2 = v2 - v0, see surface.cpp.
    glm::dvec2 origin_{0, 0};  // where the base corner is seen
    glm::dvec2 first_{0, 0}, second_{0, 0}, sum_{0, 0};
    double sum_at_origin_ = 0;
    int base_ = 0;
};

/// One triangle of the scene as a surface.
struct Surface {
    std::array<glm::dvec3, 3> corners;
    /// Of the face's plane, which its sheet or flat polygon shares: unit, towards the viewer.
    glm::dvec3 normal;
    const Material* material = nullptr;  ///< never null; the default one where none is named
    bool smooth = false;                 ///< the scene has normals for this triangle
    bool colored = false;                ///< the scene has vertex colours for this triangle

    // What add_attributes() fills in.
    BarycentricMap barycentrics;
    /// At the corners, unit, on the same side of the face as `normal`; equal to it unless smooth.
    std::array<glm::dvec3, 3> normals;
    std::array<glm::vec4, 3> colors;  ///< of the vertices, when colored: straight alpha
};

/// That of the object of a triangle or quadric; the default one where none is named.
[[nodiscard]] const Material& material_of(const Scene& scene, std::uint32_t id);

/// What a triangle (by id) is, without what changes within it.
[[nodiscard]] Surface make_surface(const ScreenScene& screen, std::uint32_t id);

/// Adds what is needed to tell the points of the triangle apart.
void add_attributes(const ScreenScene& screen, std::uint32_t id, Surface& surface);

/// A point of the source polygon of a triangle, inside it when it is convex: the same for all
/// triangles of the polygon, so that its diagonals don't show when it is lit there. O(log n).
[[nodiscard]] glm::dvec3 polygon_point(const Scene& scene, std::uint32_t id);

[[nodiscard]] glm::dvec3 position_at(const Surface& surface, glm::dvec3 barycentrics);

/// The normal between those of the corners; the face's where they cancel out. Unit.
[[nodiscard]] glm::dvec3 normal_at(const Surface& surface, glm::dvec3 barycentrics);

}  // namespace sightline
