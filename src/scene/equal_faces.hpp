// Equal faces: polygons that are there several times, the same way round or turned over.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scene/joined_mesh.hpp"
#include "sightline/scene.hpp"

namespace sightline {

/// Of the triangles of one object.
struct EqualFaces {
    std::vector<std::uint8_t> bits;  ///< of EqualFace, one byte a triangle; empty: all differ
    std::uint64_t count = 0;         ///< polygons that equal an earlier one
    bool two_sided = false;          ///< one of them is turned over
};

/// Finds the faces of an object with the same corners joined by the same sides. O(n).
[[nodiscard]] EqualFaces find_equal_faces(const Scene& scene, const Object& object,
                                          const JoinedMesh& mesh);

/// The triangles of a mesh with such faces turned as are there both ways round (kBothSides), so
/// that they run along their edges against their neighbours, and outwards where they have no
/// others. `dropped`: one byte a triangle, those that have no part in it. O(n log n).
[[nodiscard]] std::vector<Corners> turned_alike(const JoinedMesh& mesh,
                                                const std::vector<std::uint8_t>& bits,
                                                std::span<const std::uint8_t> dropped);

}  // namespace sightline
