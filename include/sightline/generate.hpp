// Scenes made from other scenes or from nothing: to grow a model for measurements.
//
// New positions are rounded to float, as programs that keep their vertices in float have them, so
// that timings and pictures can be compared with theirs triangle by triangle.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "sightline/error.hpp"
#include "sightline/scene.hpp"

namespace sightline {

/// Most triangles that a generated scene may have.
inline constexpr std::uint64_t kMaxGeneratedTriangles = std::uint64_t{1} << 30;

/// Splits every triangle into four, `times` times. The middles of sides are shared, so there are no
/// cracks; the children of triangle t are 4t .. 4t + 3 (at the three corners, then the middle) and
/// belong to t's polygon. Normals and colours are interpolated. The result is finished.
/// Error (bad_option): `times` < 0, or more than kMaxGeneratedTriangles. O(n log n) of the result.
[[nodiscard]] Result<Scene> subdivide(const Scene& scene, int times);

struct RepeatOptions {
    std::uint32_t copies = 1;
    glm::dvec3 step{0, 0, 0};     ///< copy i is moved by i * step
    bool farthest_first = false;  ///< the copy that is moved most comes first
};

/// Copies of a scene, one behind the other; each copy has objects and polygons of its own and
/// shares the materials. Lights and camera stay. The result is finished.
/// Error (bad_option): no copies, or more than kMaxGeneratedTriangles. O(n log n) of the result.
[[nodiscard]] Result<Scene> repeat(const Scene& scene, const RepeatOptions& options);

/// Where random triangles stand, and how many of them behind one another.
struct RandomBox {
    double complexity = 4;     ///< mean number of triangles behind a point of the front face, > 0
    glm::dvec3 size{1, 1, 1};  ///< from the origin; > 0
};

/// Equal equilateral triangles of random place and direction, wholly inside of a box. They shrink
/// as their number grows, so that the depth complexity stays the same: seen along z their areas sum
/// up to box.complexity times the front face (less only where they would not fit: no corner is
/// farther than half the smallest side from its triangle's centre). The same for the same arguments
/// on every machine. The result is finished.
/// Error (bad_option): no triangles, or more than kMaxGeneratedTriangles. O(n log n).
[[nodiscard]] Result<Scene> random_triangles(std::uint32_t count, std::uint32_t seed = 1,
                                             const RandomBox& box = {});

}  // namespace sightline
