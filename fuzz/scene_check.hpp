// What holds for every result of loading, whatever the input.
#pragma once

#include <cmath>
#include <cstdlib>
#include <string>

#include "sightline/error.hpp"
#include "sightline/scene.hpp"

namespace sightline::fuzz {

inline void require(bool condition) {
    if (!condition) std::abort();
}

inline void check_message(const Error& error) {
    require(!error.message.empty() && error.message.find('\n') == std::string::npos);
}

inline void check(const Scene& scene) {
    const std::size_t n = scene.triangles.size();
    require(scene.triangle_polygon.size() == n && scene.polygon_edges.size() == n);
    require(scene.degenerate.empty() || scene.degenerate.size() == n);
    require(scene.triangle_normals.empty() || scene.triangle_normals.size() == n);
    require(scene.triangle_colors.empty() || scene.triangle_colors.size() == n);
    for (std::size_t t = 0; t < n; ++t) {
        for (int k = 0; k < 3; ++k) {
            require(scene.triangles[t][k] < scene.positions.size());
            if (!scene.triangle_normals.empty()) {
                const std::uint32_t normal = scene.triangle_normals[t][k];
                require(normal == kNone || normal < scene.normals.size());
            }
            if (!scene.triangle_colors.empty()) {
                const std::uint32_t color = scene.triangle_colors[t][k];
                require(color == kNone || color < scene.colors.size());
            }
        }
    }
    for (const glm::dvec3& p : scene.positions) {
        require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    }
    std::uint32_t next = 0;
    for (const Object& object : scene.objects) {
        require(object.first_triangle == next && object.material < scene.materials.size());
        next += object.triangle_count;
    }
    require(next == n);
    require(scene.quadrics.size() <= scene.objects.size());
    for (const Quadric& quadric : scene.quadrics) require(is_regular(quadric));
}

inline void check(const Result<Scene>& scene) {
    if (scene) {
        check(*scene);
    } else {
        check_message(scene.error());
    }
}

}  // namespace sightline::fuzz
