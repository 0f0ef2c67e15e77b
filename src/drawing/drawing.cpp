#include "sightline/drawing.hpp"

#include <array>

namespace sightline {

std::string_view name_of(EdgeKind kind) {
    constexpr std::array<std::string_view, kEdgeKinds> kNames = {
        "silhouette", "boundary", "border",  "crease", "intersection", "mesh",
        "upper",      "lower",    "outline", "hatch",  "axis"};
    return kNames[static_cast<std::size_t>(kind)];
}

Result<ScreenScene> page_of(const Scene& scene, const Camera& camera,
                            const ProjectOptions& options) {
    ProjectOptions fine = options;
    fine.page = true;
    return project(scene, camera, fine);
}

}  // namespace sightline
