#include "tessellate.hpp"

#include <fmt/format.h>

#include "notes.hpp"

namespace sightline::cli {

void tessellate_for(std::string_view who, Scene& scene, bool quiet, Progress& progress) {
    if (scene.quadrics.empty()) return;
    const std::size_t surfaces = scene.quadrics.size();
    const std::uint32_t before = scene.triangle_count();
    scene = tessellate_quadrics(scene);
    Notes(quiet, progress)
        .note(fmt::format("{}: {} {} tessellated into {} triangles, {} around", who, surfaces,
                          surfaces == 1 ? "surface is" : "surfaces are",
                          scene.triangle_count() - before, kQuadricSegments));
}

}  // namespace sightline::cli
