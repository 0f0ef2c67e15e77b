// How opacity grows with the way through a volume that absorbs evenly.
//
// Light that goes through a depth of d is weakened to exp(-d), so the opacity of a sample is
// 1 - exp(-d), and depths add up where opacities do not. The same bytes on every machine: see
// math/elementary.hpp.
#pragma once

namespace sightline {

/// -log(1 - alpha), also for the smallest alpha, where 1 - alpha would be 1. Infinite for 1.
/// Precondition: 0 <= alpha <= 1.
[[nodiscard]] double optical_depth(float alpha);

/// 1 - exp(-depth), also for the smallest depths. Precondition: depth >= 0.
[[nodiscard]] double opacity(double depth);

}  // namespace sightline
