// Polygon soups become a scene: checked, placed in the world, joined, triangulated.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/joined_mesh.hpp"
#include "scene/load/soup.hpp"
#include "scene/load/triangulate.hpp"
#include "sightline/error.hpp"
#include "sightline/scene.hpp"

namespace sightline::load {

/// What a scene description says about how a model looks, instead of what its file says.
struct MaterialOverride {
    std::optional<glm::vec3> base_color;  ///< linear
    std::optional<float> opacity, specular, shininess;
};

/// Where a model stands and what it is called.
struct Placement {
    std::string file;                 ///< in messages
    std::string default_name;         ///< of objects that the file does not name
    std::optional<std::string> name;  ///< instead of the file's names
    glm::dmat4 transform{1.0};        ///< after the file's own transforms; affine
    MaterialOverride material;
};

/// Coordinates beyond this are refused: their cubes would overflow in later stages.
inline constexpr double kLargestCoordinate = 1e30;

/// Collects soups into one scene, in the order given. Not thread-safe.
class SceneBuilder {
public:
    /// The scene is not allowed to take (much) more than `memory_limit_bytes`.
    explicit SceneBuilder(std::size_t memory_limit_bytes) : memory_limit_(memory_limit_bytes) {}

    /// Adds a file's objects. Errors (bad_input): no triangles, too many, coordinates that are not
    /// finite or too large, indices out of range, a polygon that cannot be triangulated in time.
    /// O(corners), plus triangulation. After an error the builder is of no more use.
    [[nodiscard]] Status append(const Soup& soup, const Placement& placement);

    /// The scene so far, not finished; the builder is empty afterwards.
    [[nodiscard]] Scene take() { return std::move(scene_); }

private:
    /// What a mesh's vertex has become in the object at hand.
    struct Vertex {
        std::uint32_t position = kNone, normal = kNone, color = kNone;
    };
    struct Instance;  ///< an object while it is added

    [[nodiscard]] Status check_size(const Soup& soup, const Placement& placement) const;
    void append_materials(const Soup& soup, const Placement& placement);
    [[nodiscard]] std::uint32_t material_of(const SoupMesh& mesh, const Placement& placement);
    [[nodiscard]] Status append_object(const Instance& instance);
    [[nodiscard]] Status append_polygon(const Instance& instance,
                                        std::span<const std::uint32_t> corners,
                                        PositionJoiner& joiner);
    [[nodiscard]] Status place_vertex(const Instance& instance, std::uint32_t vertex,
                                      PositionJoiner& joiner);
    void append_triangle(const PolygonTriangle& triangle, std::uint32_t corners);
    void append_attributes(const Instance& instance, const PolygonTriangle& triangle);
    void fill_attributes(const Instance& instance);

    Scene scene_;
    std::size_t memory_limit_;
    std::uint32_t polygons_ = 0;
    std::uint32_t first_material_ = 0;  ///< of the soup at hand
    Triangulator triangulator_;
    // Scratch.
    std::vector<Vertex> vertices_;        ///< of the mesh at hand; untouched ones are all kNone
    std::vector<std::uint32_t> polygon_;  ///< vertices of the polygon at hand, in front-face order
    std::vector<glm::dvec3> polygon_positions_;
    std::vector<PolygonTriangle> triangles_;
};

}  // namespace sightline::load
