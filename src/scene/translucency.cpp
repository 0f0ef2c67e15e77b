#include "scene/translucency.hpp"

#include <algorithm>

namespace sightline {
namespace {

bool shines_through(const glm::vec4& color) { return color.a < 1; }

bool has_translucent_corner(const Scene& scene, std::uint32_t t) {
    const Corners& c = scene.triangle_colors[t];
    if (c.x == kNone) return false;
    return shines_through(scene.colors[c.x]) || shines_through(scene.colors[c.y]) ||
           shines_through(scene.colors[c.z]);
}

bool has_translucent_material(const Scene& scene, const Object& object) {
    return object.material < scene.materials.size() && scene.materials[object.material].opacity < 1;
}

}  // namespace

void find_translucent_vertices(Scene& scene) {
    const bool any =
        !scene.triangle_colors.empty() && std::ranges::any_of(scene.colors, shines_through);
    for (Object& object : scene.objects) {
        const auto is_seen_through = [&](std::uint32_t t) {
            return has_translucent_corner(scene, object.first_triangle + t);
        };
        std::uint32_t t = 0;
        if (any)
            while (t < object.triangle_count && !is_seen_through(t)) ++t;
        object.translucent_vertices = any && t < object.triangle_count;
    }
}

bool is_translucent(const Scene& scene, const Object& object) {
    return object.translucent_vertices || has_translucent_material(scene, object);
}

std::vector<std::uint8_t> translucent_triangles(const Scene& scene) {
    std::vector<std::uint8_t> marks;
    for (const Object& object : scene.objects) {
        if (object.triangle_count == 0 || !is_translucent(scene, object)) continue;
        marks.resize(scene.triangle_count(), 0);
        const bool all = has_translucent_material(scene, object);
        for (std::uint32_t t = object.first_triangle;
             t < object.first_triangle + object.triangle_count; ++t)
            marks[t] = all || has_translucent_corner(scene, t) ? 1 : 0;
    }
    return marks;
}

}  // namespace sightline
