// Phong's reflection model.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "sightline/camera.hpp"
#include "sightline/scene.hpp"

namespace sightline {

/// Share of a surface's base colour that is seen without any light, and with light at a right angle
/// to it: together 1, so that a surface facing one light of intensity 1 shows its base colour.
inline constexpr float kAmbient = 0.2f;
inline constexpr float kDiffuse = 1.0f - kAmbient;

/// Light that a point sends to the viewer: base colour * diffuse + specular.
struct Reflection {
    glm::vec3 diffuse{0, 0, 0};  ///< ambient part included
    glm::vec3 specular{0, 0, 0};

    [[nodiscard]] glm::vec3 on(glm::vec3 base_color) const {
        return base_color * diffuse + specular;
    }
};

/// The lights of a scene, seen from a camera. Read-only once made.
class Lighting {
public:
    Lighting(const Scene& scene, const Camera& camera);

    /// At a point of the world with a unit normal.
    [[nodiscard]] Reflection reflect(glm::dvec3 position, glm::dvec3 normal,
                                     const Material& material) const;

private:
    enum class Place { viewer, point, infinity };
    struct Source {
        Place place = Place::viewer;
        glm::dvec3 vector{0, 0, 0};  // of a point: its position; at infinity: the unit way there
        glm::vec3 color{1, 1, 1};    // times its intensity
    };
    Camera camera_;
    glm::dvec3 to_viewer_;  // of a parallel projection, unit
    std::vector<Source> sources_;
};

}  // namespace sightline
