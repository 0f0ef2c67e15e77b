// Light reflected towards the viewer: B. T. Phong, "Illumination for computer generated pictures",
// 1975: ambient light, Lambert's law, and a highlight that falls off with a power of the cosine
// between the mirrored light and the viewer. Light does not weaken with distance and nothing casts
// a shadow.
#include "shading/lighting.hpp"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "math/elementary.hpp"
#include "shading/unit.hpp"

namespace sightline {

Lighting::Lighting(const Scene& scene, const Camera& camera)
    : camera_(camera), to_viewer_(unit_or(-camera.view_vector(camera.target), camera.back)) {
    const std::vector<Light> headlight(1);
    for (const Light& light : scene.lights.empty() ? headlight : scene.lights) {
        Source source;
        source.color = light.color * light.intensity;
        switch (light.kind) {
            case LightKind::headlight:
                break;
            case LightKind::directional:
                source.place = Place::infinity;
                source.vector = unit_or(-light.direction, to_viewer_);
                break;
            case LightKind::point:
                source.place = Place::point;
                source.vector = light.position;
                break;
        }
        sources_.push_back(source);
    }
}

Reflection Lighting::reflect(glm::dvec3 position, glm::dvec3 normal,
                             const Material& material) const {
    const glm::dvec3 viewer =
        camera_.is_perspective() ? unit_or(camera_.eye - position, to_viewer_) : to_viewer_;
    Reflection result;
    result.diffuse = glm::vec3(kAmbient);
    for (const Source& source : sources_) {
        const glm::dvec3 light = source.place == Place::viewer ? viewer
                                 : source.place == Place::point
                                     ? unit_or(source.vector - position, normal)
                                     : source.vector;
        const double cosine = glm::dot(normal, light);
        if (!(cosine > 0)) continue;
        result.diffuse += source.color * (kDiffuse * static_cast<float>(std::min(cosine, 1.0)));
        if (!(material.specular > 0)) continue;
        const double mirrored = 2 * cosine * glm::dot(normal, viewer) - glm::dot(light, viewer);
        if (!(mirrored > 0)) continue;
        const float base = std::min(static_cast<float>(mirrored), 1.0f);
        const float power = math::pow_positive(base, std::max(material.shininess, 1.0f));
        result.specular += source.color * (material.specular * power);
    }
    return result;
}

}  // namespace sightline
