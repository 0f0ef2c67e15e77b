// The scene: triangles in world space with where they came from, and how they look.
//
// Conventions (the whole library shares them): the world is right-handed; front faces are
// counter-clockwise; lengths are in the file's unit; colours are linear-light RGB with straight
// (not premultiplied) opacity. A triangle's id is its index in `triangles`, which is its number in
// the order of the files after triangulation. Triangles that can't be drawn keep their number.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sightline/camera.hpp"

namespace sightline {

/// No triangle, no sheet, no attribute: also the background in id pictures.
inline constexpr std::uint32_t kNone = 0xFFFFFFFFu;

/// Corners of a triangle: three indices, counter-clockwise seen from the front.
using Corners = glm::uvec3;

/// How a surface looks. Colours are linear light.
struct Material {
    std::string name;
    glm::vec3 base_color{0.6f, 0.6f, 0.6f};  ///< diffuse reflectance, 0..1 a channel, linear
    float opacity = 1.0f;                    ///< 1 opaque .. 0 invisible
    float specular = 0.2f;                   ///< Phong's k_s, 0..1
    float shininess = 32.0f;                 ///< Phong's exponent, >= 1
};

enum class LightKind { headlight, directional, point };

/// A light. A scene without lights is lit by one headlight of intensity 1.
struct Light {
    LightKind kind = LightKind::headlight;
    glm::dvec3 direction{0, 0, -1};  ///< directional: the way the light travels, in the world
    glm::dvec3 position{0, 0, 0};    ///< point: where it stands, in the world
    glm::vec3 color{1, 1, 1};        ///< linear
    float intensity = 1.0f;          ///< factor on color; no falloff with distance
};

/// One object of the scene (a mesh at a node): a contiguous range of triangles and polygons.
struct Object {
    std::string name;
    std::uint32_t first_triangle = 0, triangle_count = 0;
    std::uint32_t first_polygon = 0, polygon_count = 0;
    std::uint32_t material = 0;  ///< index into Scene::materials
    bool has_file_normals = false;
    /// Every edge is shared by exactly two faces that run along it in opposite directions, and
    /// every connected part encloses a positive volume: only then may back faces be removed.
    bool closed = false;
};

/// Axis-aligned box. Empty when lo > hi.
struct Box {
    glm::dvec3 lo{1, 1, 1};
    glm::dvec3 hi{-1, -1, -1};
    [[nodiscard]] bool empty() const { return !(lo.x <= hi.x); }
    [[nodiscard]] glm::dvec3 centre() const { return 0.5 * (lo + hi); }
    [[nodiscard]] glm::dvec3 extent() const { return hi - lo; }
    friend bool operator==(const Box&, const Box&) = default;
};

/// Faces that are coplanar in the world, clustered once when the scene is finished. The
/// triangles of a sheet share one plane on every screen, so that walls, decals and the halves of a
/// quad never fight: where they meet in depth they tie exactly, and the lower id wins.
struct Sheets {
    std::vector<std::uint32_t> of_triangle;  ///< sheet of each triangle, or kNone; may be empty
    /// Triangles of sheet s: members[first[s]] .. members[first[s + 1] - 1], in ascending order.
    std::vector<std::uint32_t> first;
    std::vector<std::uint32_t> members;
    /// Three widely separated corners (indices of positions) that determine each sheet's plane.
    std::vector<Corners> frame;
    /// Centre and radius of a ball around the sheet.
    std::vector<glm::dvec4> ball;

    [[nodiscard]] std::size_t count() const { return frame.size(); }
    [[nodiscard]] std::uint32_t of(std::uint32_t triangle) const {
        return of_triangle.empty() ? kNone : of_triangle[triangle];
    }
};

/// What loading found out; printed by `--stats`.
struct SceneCounts {
    std::uint64_t degenerate_triangles = 0;  ///< dropped: two corners equal, or no area
    std::uint64_t polygons = 0;
    std::uint64_t concave_polygons = 0;
    std::uint64_t ignored_primitives = 0;  ///< points and lines
};

/// A whole scene. Plain data, structure of arrays; filled by a loader or by hand, then made ready
/// by finish_scene(). Read-only from then on, so any number of threads may use it.
struct Scene {
    std::vector<glm::dvec3> positions;  ///< world space; equal positions of an object are joined
    std::vector<Corners> triangles;     ///< indices into positions

    std::vector<std::uint32_t> triangle_polygon;  ///< source polygon of each triangle
    /// Bit k set: side k (from corner k to corner k+1) is an edge of the source polygon, not a
    /// diagonal of its triangulation. One byte a triangle.
    std::vector<std::uint8_t> polygon_edges;

    /// Unit vertex normals and their indices per corner. triangle_normals is empty when no object
    /// has normals (they are then made on demand by make_normals()).
    std::vector<glm::vec3> normals;
    std::vector<Corners> triangle_normals;

    /// Vertex colours (linear, straight alpha) and their indices per corner; a triangle of an
    /// object without colours has kNone in its corners. Empty when there are none at all.
    std::vector<glm::vec4> colors;
    std::vector<Corners> triangle_colors;

    std::vector<Object> objects;  ///< in ascending order of first_triangle, without gaps
    std::vector<Material> materials;
    std::vector<Light> lights;            ///< empty: one headlight
    std::optional<CameraOptions> camera;  ///< from scene.json

    // Derived by finish_scene().
    Box bounds;                            ///< of the positions that triangles use
    std::vector<std::uint8_t> degenerate;  ///< one byte a triangle; empty when none is
    Sheets sheets;
    SceneCounts counts;

    [[nodiscard]] std::uint32_t triangle_count() const {
        return static_cast<std::uint32_t>(triangles.size());
    }
    /// Index of the object that owns a triangle. O(log objects).
    [[nodiscard]] std::uint32_t object_of(std::uint32_t triangle) const;
};

/// Computes what is derived (bounds, degenerate triangles, sheets, closed objects).
/// Precondition: indices are in range and positions finite. O(n log n), on all cores; the result
/// does not depend on the number of threads.
void finish_scene(Scene& scene);

/// Fills in vertex normals for every triangle whose object has none from its file: the
/// angle-weighted mean over the faces around a vertex, split where two neighbouring faces meet at
/// more than `crease_angle_degrees`. With `replace`, normals from files are made anew as well.
void make_normals(Scene& scene, double crease_angle_degrees, bool replace = false);

}  // namespace sightline
