// The polygon soup: what a file holds, before anything is joined, triangulated or believed.
//
// The process that parses a foreign file hands this over as bytes. Those bytes are not trusted:
// deserialising checks everything that memory safety rests on, building a scene the rest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sightline/scene.hpp"

namespace sightline::load {

/// Polygons over the file's vertices. Indices of vertices are as the file says: maybe out of range.
struct SoupMesh {
    std::string name;
    std::uint32_t material = kNone;  ///< index into Soup::materials, or kNone
    // Positions as precise as the file has them: all in one of these, the other is empty.
    std::vector<glm::vec3> positions;           ///< of files that hold floats
    std::vector<glm::dvec3> precise_positions;  ///< of texts, and of files that hold doubles
    /// One a polygon if has_polygon_normals, else one a position unless normal_corners says which.
    std::vector<glm::vec3> normals;
    std::vector<glm::vec4> colors;              ///< one a position, or empty
    std::vector<std::uint32_t> polygon_sizes;   ///< number of corners of each polygon, >= 3
    std::vector<std::uint32_t> corners;         ///< the polygons' vertices, one after another
    std::vector<std::uint32_t> normal_corners;  ///< normal of each corner (kNone: none), or empty
    bool has_polygon_normals = false;           ///< then normal_corners is empty

    [[nodiscard]] std::size_t position_count() const {
        return positions.size() + precise_positions.size();
    }
    [[nodiscard]] glm::dvec3 position(std::size_t index) const {
        return positions.empty() ? precise_positions[index] : glm::dvec3(positions[index]);
    }
};

/// A mesh at a node.
struct SoupObject {
    std::string name;
    std::uint32_t mesh = 0;     ///< index into Soup::meshes
    glm::dmat4 transform{1.0};  ///< of the mesh into the world; affine
};

struct Soup {
    bool srgb_colors = true;  ///< colours of materials and vertices are sRGB, not linear light
    std::vector<Material> materials;
    std::vector<SoupMesh> meshes;
    std::vector<SoupObject> objects;       ///< in the file's order, depth first
    std::uint64_t ignored_primitives = 0;  ///< points and lines
    std::vector<std::string> notes;        ///< see Scene::notes; without the file's name
    /// Paths of the files that were read, the model's own among them or not, and of its textures.
    std::vector<std::string> files;
};

/// Bytes for the same program on the same machine.
[[nodiscard]] std::vector<std::byte> serialise(const Soup& soup);

/// The reverse; nothing when the bytes are no soup. Whatever the bytes, it neither reads outside
/// them nor allocates more than a small multiple of their number, and the result keeps every
/// statement made on the types above.
[[nodiscard]] std::optional<Soup> deserialise(std::span<const std::byte> bytes);

}  // namespace sightline::load
