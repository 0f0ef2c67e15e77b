// scene.json from memory; no file is touched, as the models are only listed.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "scene/load/scene_file.hpp"
#include "scene_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using sightline::fuzz::require;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const auto scene = sightline::load::parse_scene_description(text, "scene.json");
    if (!scene) {
        sightline::fuzz::check_message(scene.error());
        return 0;
    }
    require(!scene->models.empty() || !scene->surfaces.empty());
    for (const auto& surface : scene->surfaces) require(sightline::is_regular(surface.quadric));
    for (const auto& model : scene->models) {
        require(!model.path.empty());
        const auto& opacity = model.material.opacity;
        require(!opacity || (*opacity >= 0 && *opacity <= 1));
    }
    for (const auto& light : scene->lights) require(std::isfinite(light.intensity));
    return 0;
}
