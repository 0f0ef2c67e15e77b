#include "tessellate.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace sightline::cli {

void tessellate_for(std::string_view who, Scene& scene, bool quiet, Progress& progress) {
    if (scene.quadrics.empty()) return;
    const std::size_t surfaces = scene.quadrics.size();
    const std::uint32_t before = scene.triangle_count();
    scene = tessellate_quadrics(scene);
    if (quiet) return;
    progress.clear();
    fmt::print(stderr, "sightline: note: {}: {} {} tessellated into {} triangles, {} around\n", who,
               surfaces, surfaces == 1 ? "surface is" : "surfaces are",
               scene.triangle_count() - before, kQuadricSegments);
}

}  // namespace sightline::cli
