// The vertex stage: transforms and snaps all positions of a scene, many at a time.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "view/transform.hpp"

namespace sightline {

/// x of a position that lies outside of the view volume: it has no snapped point.
inline constexpr std::int32_t kOutside = INT32_MIN;

/// Snaps positions[i] to points[i]; one that lies outside of the volume gets x = kOutside.
/// Returns how many do. Thread-safe on disjoint ranges. The bits do not depend on the vector width.
[[nodiscard]] std::size_t snap_positions(const ScreenTransform& transform,
                                         std::span<const glm::dvec3> positions,
                                         ScreenPoint* points);

}  // namespace sightline
