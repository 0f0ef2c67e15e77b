// Polygon soups become a scene: checked, placed in the world, joined, triangulated.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/joined_mesh.hpp"
#include "scene/load/polygon_edges.hpp"
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

void apply(const MaterialOverride& what, Material& material);

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
/// A scene whose largest extent is below this is refused: there they would underflow.
inline constexpr double kLeastSize = 1e-30;

/// Collects soups into one scene, in the order given. Not thread-safe.
class SceneBuilder {
public:
    /// The scene is not allowed to take (much) more than `memory_limit_bytes`.
    explicit SceneBuilder(std::size_t memory_limit_bytes) : memory_limit_(memory_limit_bytes) {}

    /// Adds a file's objects. Errors (bad_input): no triangles, too many, coordinates that are not
    /// finite or too large, indices out of range, a polygon that cannot be triangulated in time.
    /// O(corners), plus triangulation. After an error the builder is of no more use.
    [[nodiscard]] Status append(const Soup& soup, const Placement& placement);

    [[nodiscard]] std::uint32_t object_count() const {
        return static_cast<std::uint32_t>(scene_.objects.size());
    }
    /// The scene so far, not finished; the builder is empty afterwards.
    [[nodiscard]] Scene take();

private:
    struct Instance;  ///< an object while it is added
    /// A polygon of the mesh at hand: some of SoupMesh::corners.
    struct Polygon {
        std::size_t first_corner;
        std::uint32_t size, number;
    };

    [[nodiscard]] Status check_size(const Soup& soup, const Placement& placement) const;
    [[nodiscard]] Status check_memory(std::uint64_t more_triangles,
                                      const Placement& placement) const;
    void append_materials(const Soup& soup, const Placement& placement);
    void append_notes(const Soup& soup, const Placement& placement);
    [[nodiscard]] std::uint32_t material_of(const SoupMesh& mesh, const Placement& placement);
    [[nodiscard]] Status append_object(const Instance& instance);
    [[nodiscard]] Status append_polygons(const Instance& instance);
    void expect_vertices(const Instance& instance, const Polygon& coming,
                         const PositionJoiner& joiner) const;
    [[nodiscard]] Status append_polygon(const Instance& instance, const Polygon& polygon,
                                        PositionJoiner& joiner);
    [[nodiscard]] Status place_vertex(const Instance& instance, std::uint32_t vertex,
                                      PositionJoiner& joiner);
    [[nodiscard]] std::uint32_t place_normal(const Instance& instance, std::uint32_t normal);
    [[nodiscard]] std::uint32_t place_color(const Instance& instance, std::uint32_t vertex);
    void append_triangle(const Instance& instance, const Polygon& polygon,
                         const PolygonTriangle& triangle, std::uint8_t edge_bits);
    void fill_attributes(const SoupMesh& mesh);

    Scene scene_;
    std::size_t memory_limit_;
    std::uint32_t polygons_ = 0;
    std::uint32_t first_material_ = 0;  ///< of the soup at hand
    Triangulator triangulator_;
    double largest_float_ = 0;  ///< coordinate of the mesh at hand, if it holds floats
    // What the vertices and normals of the mesh at hand have become in the scene, or kNone.
    std::vector<std::uint32_t> placed_positions_, placed_normals_, placed_colors_;
    // Scratch.
    std::vector<glm::dvec3> polygon_positions_;
    std::vector<PolygonTriangle> triangles_;
    std::vector<std::uint8_t> edge_bits_;
};

}  // namespace sightline::load
