// Joining of positions that differ in their last bits, where that closes a seam.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scene/joined_mesh.hpp"
#include "sightline/scene.hpp"

namespace sightline {

/// Corners of triangles that shall have other positions.
struct Joins {
    struct Corner {
        std::uint64_t corner;    ///< 3 t + k: corner k of triangle t of the scene
        std::uint32_t position;  ///< in the scene
    };
    std::vector<Corner> corners;
    std::uint64_t positions = 0;  ///< that are used no longer
};

/// Appends the joins of one object, whose mesh it is; the rule is that of finish_scene().
/// `dropped`: one byte a triangle of the object, those that have no part in its surface; empty: all
/// have. `rounding`: see Scene::rounding. O(n), and O(m log m) for m positions near others.
void find_joins(const ObjectJoiner& joiner, const Object& object, const JoinedMesh& mesh,
                std::span<const std::uint8_t> dropped, double rounding, double weld, Joins& joins);

/// Gives the corners their positions.
void apply(const Joins& joins, Scene& scene);

/// Gives the corners of an object at equal positions the lowest of their indices. O(n).
void join_equal_positions(Scene& scene);

}  // namespace sightline
