// The scene: triangles in world space with where they came from, and how they look.
//
// Conventions (the whole library shares them): the world is right-handed; front faces are
// counter-clockwise; lengths are in the file's unit; colours are linear-light RGB with straight
// (not premultiplied) opacity. A triangle's id is its index in `triangles`, which is its number in
// the order of the files after triangulation. Triangles that can't be drawn keep their number.
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sightline/aligned_vector.hpp"
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
    /// For compositing: what has it hides what lies behind, and is itself a hole in the picture
    /// (colour and alpha 0). Depth and ids are as always.
    bool holdout = false;
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
    /// Number of the file it came from, among those that were loaded together; see Sheets.
    std::uint32_t part = 0;
    bool has_file_normals = false;
    /// Every edge is shared by exactly two faces that run along it in opposite directions, and
    /// every connected part encloses a positive volume: only then may back faces be removed. Equal
    /// faces count as one, which may run either way when it is there both ways round.
    bool closed = false;
    /// Some face of it is there both ways round, so both its sides can be seen: its back faces
    /// stay.
    bool two_sided = false;
    /// One of its vertex colours lets something shine through.
    bool translucent_vertices = false;
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

/// What is known of a quadric beside its equation; decides how it is tessellated.
enum class QuadricKind { general, sphere, cylinder, cone };

/// A surface of the second degree, cut off by a box: the points of the box with value_at() = 0.
/// Both of its sides can be seen. It has coordinates of its own, in which it is simple.
struct Quadric {
    QuadricKind kind = QuadricKind::general;
    /// From its own coordinates (u, v, w) to the world: affine, not singular.
    glm::dmat4 frame{1.0};
    /// Factors of u^2, v^2, w^2, uv, uw, vw, u, v, w and 1.
    std::array<double, 10> coefficients{};
    /// In its own coordinates.
    Box clip{{-1, -1, -1}, {1, 1, 1}};

    [[nodiscard]] double value_at(glm::dvec3 own) const;
    [[nodiscard]] glm::dvec3 gradient_at(glm::dvec3 own) const;
};

/// The unit sphere of its own coordinates. Precondition: radius > 0.
[[nodiscard]] Quadric make_sphere(glm::dvec3 centre, double radius);
/// Open at both ends; w runs from -1 to 1. Preconditions: radius > 0, from != to.
[[nodiscard]] Quadric make_cylinder(glm::dvec3 from, glm::dvec3 to, double radius);
/// From the apex to the rim, open there; w runs from 0 to 1. Preconditions: radius > 0, apex !=
/// base.
[[nodiscard]] Quadric make_cone(glm::dvec3 apex, glm::dvec3 base, double radius);
/// Factors of x^2, y^2, z^2, xy, xz, yz, x, y, z and 1, and the box in which the surface stands.
/// The box becomes the cube -1..1 of its own coordinates and the largest factor 1.
/// Preconditions: a factor other than the last is not 0, box.lo < box.hi.
[[nodiscard]] Quadric make_quadric(const std::array<double, 10>& coefficients, const Box& box);
/// `by` must be affine.
[[nodiscard]] Quadric transformed(Quadric quadric, const glm::dmat4& by);
/// Whether all numbers are finite and of a moderate size, and the frame is not singular.
[[nodiscard]] bool is_regular(const Quadric& quadric);
/// A box of the world around it; the smallest one but for QuadricKind::general.
[[nodiscard]] Box bounds_of(const Quadric& quadric);

/// Faces that are coplanar in the world, clustered once when the scene is finished. The
/// triangles of a sheet share one plane on every screen, so that walls, decals and the halves of a
/// quad never fight: where they meet in depth they tie exactly, and the lower id wins. They are
/// found part by part (Object::part) and then joined as wholes, so that who has one part at a time
/// finds the same ones; see StreamPlan.
struct Sheets {
    AlignedVector<std::uint32_t> of_triangle;  ///< sheet of each triangle, or kNone; may be empty
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

/// A face that is there several times: polygons of one object with the same corners joined by the
/// same sides, run through in whatever direction. They are one face with two sides; the first one
/// stands for it. Bits of Scene::equal_faces.
enum EqualFace : std::uint8_t {
    kRepeated = 1,    ///< an earlier one is there the same way round: it is never seen
    kTurnedOver = 2,  ///< the first one the other way round, which is seen if that one is culled
    kBothSides = 4,   ///< the first of them; one is turned over
};

/// What loading found out; printed by `--stats`.
struct SceneCounts {
    std::uint64_t degenerate_triangles = 0;  ///< dropped: two corners equal, or no area
    std::uint64_t polygons = 0;
    std::uint64_t concave_polygons = 0;
    std::uint64_t ignored_primitives = 0;  ///< points and lines
    std::uint64_t joined_positions = 0;    ///< that differed, but by no more than the tolerance
    std::uint64_t equal_faces = 0;         ///< polygons that equal an earlier one
};

/// Objects that move as one. Their positions and quadrics in the scene are those at rest; see
/// posed().
struct Motion {
    std::uint32_t first_object = 0, object_count = 0;
    /// From rest to each frame: affine. After the last one they stay where they are; without any
    /// they rest.
    std::vector<glm::dmat4> frames;
};

/// A whole scene. Plain data, structure of arrays; filled by a loader or by hand, then made ready
/// by finish_scene(). Read-only from then on, so any number of threads may use it.
struct Scene {
    AlignedVector<glm::dvec3> positions;  ///< world space; equal positions of an object are joined
    AlignedVector<Corners> triangles;     ///< indices into positions

    std::vector<std::uint32_t> triangle_polygon;  ///< source polygon of each triangle
    /// Bit k set: side k (from corner k to corner k+1) is an edge of the source polygon, not a
    /// diagonal of its triangulation. One byte a triangle.
    std::vector<std::uint8_t> polygon_edges;

    /// Unit vertex normals and their indices per corner. triangle_normals is empty when no object
    /// has normals (they are then made on demand by make_normals()).
    AlignedVector<glm::vec3> normals;
    AlignedVector<Corners> triangle_normals;

    /// Vertex colours (linear, straight alpha) and their indices per corner; a triangle of an
    /// object without colours has kNone in its corners. Empty when there are none at all.
    AlignedVector<glm::vec4> colors;
    AlignedVector<Corners> triangle_colors;

    std::vector<Object> objects;  ///< in ascending order of first_triangle, without gaps
    /// Surfaces that are not polygons. The id of quadric k is triangle_count() + k. Each is an
    /// object of its own: the last ones of `objects`, in the same order, have no triangles. See
    /// add_quadric().
    std::vector<Quadric> quadrics;
    std::vector<Material> materials;
    std::vector<Light> lights;  ///< empty: one headlight
    /// From scene.json: in the coordinates of the files, whatever the offset.
    std::optional<CameraOptions> camera;
    /// A point of the scene stands at point + offset in the coordinates of its files or arrays.
    /// finish_scene() chooses it by offset_for() and makes relative to it all that has a place in
    /// the scene: positions, quadrics, lights, motions (not `camera`). If it isn't 0 before, all of
    /// that is relative to it already.
    glm::dvec3 offset{0, 0, 0};
    /// By how much a coordinate may differ from what was meant, because a file holds 32-bit floats:
    /// 2^-24 of the largest; 0 for texts and doubles, whose digits are taken as they are.
    double rounding = 0;
    /// What files hold that has no effect, a line each, for people: textures, material libraries
    /// that are missing, points and lines.
    std::vector<std::string> notes;
    /// Of objects that share no position and no normal with others; each object is in one at most.
    std::vector<Motion> motions;

    // Derived by finish_scene().
    Box bounds;  ///< of the positions that triangles use, and of the quadrics
    Box reach;   ///< of all frames of the motions, to fit cameras to; the bounds if nothing moves
    std::vector<std::uint8_t> degenerate;  ///< one byte a triangle; empty when none is
    /// Bits of EqualFace, one byte a triangle; empty when no two faces are equal.
    std::vector<std::uint8_t> equal_faces;
    Sheets sheets;
    SceneCounts counts;

    [[nodiscard]] std::uint32_t triangle_count() const {
        return static_cast<std::uint32_t>(triangles.size());
    }
    [[nodiscard]] bool is_quadric(std::uint32_t id) const { return id >= triangles.size(); }
    /// Index of the object that owns a triangle or a quadric. O(log objects).
    [[nodiscard]] std::uint32_t object_of(std::uint32_t id) const;
};

/// The offset of a scene that fills a box: 0 unless the scene lies so far from the origin, compared
/// with its size, that this would be felt. Subtracting it from the coordinates of any point of the
/// box is exact. O(1).
[[nodiscard]] glm::dvec3 offset_for(const Box& box);

/// Positions of an object on its open edges are joined when they are no further apart than this
/// part of the object's size: 2^-20, the precision of coordinates of six digits. See
/// finish_scene().
inline constexpr double kWeldTolerance = 0x1p-20;

/// Chooses the offset, joins positions and computes what is derived (bounds, degenerate triangles,
/// equal faces, sheets, closed objects).
///
/// Triangles of an object get the lowest index of those with equal positions (-0 equals 0). Then,
/// where an object is not closed, each corner on an open edge (a side of one face alone) gets the
/// lowest index of those on other open edges that are no further away than `weld` times the
/// object's size (half the diagonal of its box, or a quarter of its largest coordinate if that is
/// more) and than a sixteenth of the shortest open edge at either; never of one that another corner
/// of the same triangle has. No position moves, and triangles keep their numbers. With weld = 0
/// only equal positions are joined.
///
/// Precondition: indices are in range and positions finite; 0 <= weld < 1. O(n log n), on all
/// cores; the result does not depend on the number of threads.
void finish_scene(Scene& scene, double weld = kWeldTolerance);

/// The finished scene as it stands in a frame, numbered from 0, without motions: triangles and
/// objects keep their numbers, and `reach` remains that of all frames, so that a camera fitted to
/// it stands still. A mirrored frame keeps fronts in front. Preconditions: the scene is finished;
/// frames of objects with quadrics leave those regular. O(n log n), as finish_scene().
[[nodiscard]] Scene posed(const Scene& scene, std::uint32_t frame);

/// One byte a triangle, not 0: it moves. Empty when the scene has no motions.
[[nodiscard]] std::vector<std::uint8_t> moving_triangles(const Scene& scene);

/// Whether something shines through an object: its material, or one of its vertex colours, is not
/// opaque.
[[nodiscard]] bool is_translucent(const Scene& scene, const Object& object);

/// One byte a triangle, not 0: something shines through it. Empty when nothing does.
[[nodiscard]] std::vector<std::uint8_t> translucent_triangles(const Scene& scene);

/// Appends a quadric with an object and a material of its own. Precondition: all triangles are in
/// the scene. finish_scene() is due afterwards.
void add_quadric(Scene& scene, const Quadric& quadric, const std::string& name,
                 const Material& material);

/// Segments around a sphere, cylinder or cone in a tessellation.
inline constexpr std::uint32_t kQuadricSegments = 64;

/// The finished scene with triangles in place of its quadrics; objects and triangles that were
/// there keep their numbers. All new vertices lie on the surfaces and have their normals. Spheres
/// get segments / 2 rings; cylinders and cones as many as make about square faces, at most
/// `segments`. General quadrics are followed by tetrahedra through a lattice of (3/4 segments)^3
/// cells of their box, so parts thinner than a cell are lost. Precondition: segments >= 4.
/// O(segments^2) for each special quadric, O(segments^3) for each general one.
[[nodiscard]] Scene tessellate_quadrics(const Scene& scene,
                                        std::uint32_t segments = kQuadricSegments);

/// Fills in vertex normals for every triangle whose object has none from its file: the
/// angle-weighted mean over the faces around a vertex, split where two neighbouring faces meet at
/// more than `crease_angle_degrees`. With `replace`, normals from files are made anew as well.
void make_normals(Scene& scene, double crease_angle_degrees, bool replace = false);

}  // namespace sightline
