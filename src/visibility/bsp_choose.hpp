// Which plane divides a cell of a BSP tree.
#pragma once

#include <optional>
#include <span>

#include "visibility/bsp_face.hpp"

namespace sightline::bsp {

struct Choice {
    TreePlane plane;
    std::uint32_t triangle = kNone;  ///< whose plane it is; kNone: a free plane
};

/// A plane of no face that divides many faces well, when there is one. It may turn out that all
/// faces are on one side of it after all. The same faces give the same plane.
[[nodiscard]] std::optional<Choice> choose_free_plane(const Surfaces& surfaces,
                                                      std::span<const Face> faces);

/// The plane of one of the faces, of which there is at least one.
[[nodiscard]] Choice choose_plane_of_face(const Surfaces& surfaces, std::span<const Face> faces);

}  // namespace sightline::bsp
