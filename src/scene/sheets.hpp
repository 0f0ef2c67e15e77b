// Clustering of coplanar faces into sheets.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sightline/scene.hpp"

namespace sightline {

/// How far the normals of coplanar faces may differ: the normal of a face is that uncertain when
/// its size is 2^-12 of the scene's. Smaller faces are left alone rather than matched by chance.
inline constexpr double kNormalTolerance = 0x1p-12;

/// The plane of a face.
struct FacePlane {
    glm::dvec3 normal{0, 0, 0};  ///< unit
    double offset = 0;           ///< of the plane from the scene's centre, along the normal
    double area2 = 0;            ///< doubled area; 0: the face has no plane

    [[nodiscard]] bool is_usable() const { return area2 > 0; }
};

/// What counts as coplanar in a scene, all of its parts together. `tolerance`: how far corners may
/// stand off a plane in which they count as lying.
struct SheetScale {
    glm::dvec3 centre{};
    double radius = 0, tolerance = 0;

    SheetScale() = default;
    /// `rounding`: see Scene::rounding.
    SheetScale(const Box& bounds, double rounding);

    /// Whether a point lies in a plane.
    [[nodiscard]] bool holds(const FacePlane& plane, const glm::dvec3& point) const;
    [[nodiscard]] bool holds(const glm::dvec3& normal, double offset,
                             const glm::dvec3& point) const;
};

/// Whether normals agree, up to their sign.
[[nodiscard]] bool are_parallel(const glm::dvec3& n, const glm::dvec3& m);

/// Where the sign of a normal is fixed; no axis or diagonal of a model lies across it.
[[nodiscard]] double heading(const glm::dvec3& normal);

[[nodiscard]] FacePlane plane_of_face(const Scene& scene, const SheetScale& scale,
                                      std::uint32_t triangle);

/// Triangles one after the other.
struct TriangleRun {
    std::uint32_t first = 0, count = 0;
};

/// The parts of a scene: runs of objects that have one number.
[[nodiscard]] std::vector<TriangleRun> parts_of(const Scene& scene);

/// Fills scene.sheets. Preconditions: scene.bounds and scene.degenerate are set. The clusters do
/// not depend on the order of the triangles or on the number of threads. O(n log n) for meshes
/// whose planes are spread out; quadratic in the number of parallel planes closer than 1/500 of the
/// scene.
void build_sheets(Scene& scene);

// -- the steps of build_sheets() ---------------------------------------------------------------

/// Appends the sheets of one part to those of the scene, and to `seeds` the face of each whose
/// plane decides. of_triangle is filled, too; frames and balls are not.
void find_part_sheets(Scene& scene, const SheetScale& scale, TriangleRun part,
                      std::vector<std::uint32_t>& seeds);

/// Joins sheets, and faces without any, of different parts: of_triangle gets their new numbers.
void join_sheets_of_parts(Scene& scene, const SheetScale& scale,
                          const std::vector<TriangleRun>& parts,
                          const std::vector<std::uint32_t>& seeds);

/// Numbers the sheets of of_triangle in the order of their first members, so that who goes through
/// the triangles goes through the sheets; finds members, frames and balls.
void frame_sheets(Scene& scene);

}  // namespace sightline
