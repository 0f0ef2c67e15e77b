// Surfaces that are not polygons, after an algorithm has decided between the triangles.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "sightline/visibility.hpp"

namespace sightline {

/// The nearest quadric at a point of the screen; of two equally near ones the first.
struct NearestQuadric {
    std::uint32_t id = kNone;
    std::int32_t z = 0;
};
/// Asks all of them. O(quadrics).
[[nodiscard]] std::optional<NearestQuadric> nearest_quadric(const ScreenScene& screen,
                                                            std::int32_t x, std::int32_t y);

/// Whether a quadric's z lies before a triangle's exact depth at a point. At a tie the triangle
/// wins: its id is lower.
[[nodiscard]] bool is_before_triangle(std::int32_t z, const Plane& triangle, std::int32_t x,
                                      std::int32_t y);

/// Offers every quadric at every sample of its part of the picture to an answer about the
/// triangles, which becomes the answer about both. Precondition: `out` is complete.
void offer_quadrics(const ScreenScene& screen, const ResolveOptions& options, Visibility& out);

/// The same for an answer that is made in bands.
[[nodiscard]] std::unique_ptr<RowSource> offer_quadrics(const ScreenScene& screen,
                                                        const SampleGrid& grid,
                                                        const ResolveOptions& options,
                                                        std::unique_ptr<RowSource> triangles);

}  // namespace sightline
