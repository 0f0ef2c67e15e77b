// Views for tests: scenes of all sorts, and cameras as users set them and as nobody should. A seed
// means the same everywhere.
#pragma once

#include "support/scenes.hpp"

namespace sightline::testing {

/// At most 300 triangles: hostile_scene(), triangles of all sizes, small meshes in rooms, specks
/// among walls; some of it large or small, or far from the origin.
[[nodiscard]] Scene random_scene(std::uint64_t seed);

struct View {
    Camera camera;
    ProjectOptions options;  ///< on one thread, or on all cores
    std::uint32_t samples_per_axis = 1;
};

/// Any projection, from outside, from within, from close to a surface and from afar; fields of view
/// from 0.01 to 179 degrees; pictures from one pixel on, of at most `most_samples` samples, 1 to 64
/// a pixel; fitted planes and given ones, also such that cut; any culling; sometimes a page.
/// Precondition: the scene has triangles.
[[nodiscard]] View random_view(const Scene& scene, std::uint64_t seed, std::uint32_t most_samples);

}  // namespace sightline::testing
