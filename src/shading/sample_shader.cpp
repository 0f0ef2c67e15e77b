// The kinds of shading: flat, H. Gouraud, "Continuous shading of curved surfaces", 1971, and
// B. T. Phong, "Illumination for computer generated pictures", 1975. We differ from both in that we
// interpolate in the world instead of along scan lines, so that the result is right in perspective
// and does not depend on how a polygon is turned.
#include "shading/sample_shader.hpp"

#include <algorithm>

#include "shading/id_colors.hpp"
#include "shading/quadric_surface.hpp"
#include "sightline/visibility.hpp"

namespace sightline {
namespace {

/// A number in 0..1 as a colour component whose byte in a PNG is 255 times it: pictures of numbers
/// are read off their bytes.
float component_of(double value) {
    return from_srgb8(static_cast<std::uint8_t>(std::clamp(value, 0.0, 1.0) * 255.0 + 0.5));
}

glm::vec3 color_of_id(std::uint32_t id) {
    const std::array<std::uint8_t, 3> bytes = id_color(id);
    return {from_srgb8(bytes[0]), from_srgb8(bytes[1]), from_srgb8(bytes[2])};
}

glm::vec3 color_of_normal(glm::dvec3 n) {
    return {component_of(0.5 * (n.x + 1)), component_of(0.5 * (n.y + 1)),
            component_of(0.5 * (n.z + 1))};
}

glm::vec3 color_of_depth(const Camera& camera, double depth) {
    const double range = camera.far_plane - camera.near_plane;
    return glm::vec3(component_of((depth - camera.near_plane) / range));
}

Reflection mix(const std::array<Reflection, 3>& light, glm::vec3 b) {
    return {b.x * light[0].diffuse + b.y * light[1].diffuse + b.z * light[2].diffuse,
            b.x * light[0].specular + b.y * light[1].specular + b.z * light[2].specular};
}

}  // namespace

SampleShader::SampleShader(const ScreenScene& screen, Shading shading)
    : screen_(screen),
      shading_(shading),
      lighting_(screen.scene(), screen.camera()),
      pixels_per_unit_of_screen_(1.0 / static_cast<double>(1 << screen.subpixel_bits())) {}

void SampleShader::prepare(std::uint32_t id, ShadedFace& face) const {
    face.id = id;
    face.constant = false;
    if (screen_.is_quadric(id) && shading_ != Shading::ids) {
        prepare_quadric(id, face);
        return;
    }
    switch (shading_) {
        case Shading::ids:
            face.constant = true;
            face.color = glm::vec4(color_of_id(id), 1.0f);
            return;
        case Shading::depth:
            face.plane = screen_.plane(id);
            return;
        case Shading::normals:
            face.surface = make_surface(screen_, id);
            face.constant = !face.surface.smooth;
            if (!face.constant) add_attributes(screen_, id, face.surface);
            if (face.constant) face.color = glm::vec4(color_of_normal(face.surface.normal), 1.0f);
            return;
        case Shading::flat:
        case Shading::gouraud:
        case Shading::phong:
        case Shading::unlit:
            face.surface = make_surface(screen_, id);
            if (!prepare_holdout(face)) prepare_lit(id, face);
            return;
    }
}

bool SampleShader::prepare_holdout(ShadedFace& face) {
    if (!face.surface.material->holdout) return false;
    face.constant = true;
    face.color = glm::vec4(0);
    return true;
}

void SampleShader::prepare_lit(std::uint32_t id, ShadedFace& face) const {
    Surface& surface = face.surface;
    const bool flat = shading_ == Shading::flat || !surface.smooth;
    face.constant = !surface.colored && (flat || shading_ == Shading::unlit);
    if (!face.constant) add_attributes(screen_, id, surface);
    if (shading_ == Shading::unlit) {
        face.light.fill({glm::vec3(1.0f), glm::vec3(0.0f)});
    } else if (flat) {
        const glm::dvec3 point = polygon_point(screen_.scene(), id);
        face.light.fill(lighting_.reflect(point, surface.normal, *surface.material));
    } else if (shading_ == Shading::gouraud) {
        for (std::size_t k = 0; k < 3; ++k) {
            face.light[k] =
                lighting_.reflect(surface.corners[k], surface.normals[k], *surface.material);
        }
    }
    if (face.constant) face.color = glm::vec4(face.light[0].on(surface.material->base_color), 1.0f);
}

void SampleShader::prepare_quadric(std::uint32_t id, ShadedFace& face) const {
    face.surface.material = &material_of(screen_.scene(), id);
    const bool shows_numbers = shading_ == Shading::depth || shading_ == Shading::normals;
    if (!shows_numbers && prepare_holdout(face)) return;
    face.constant = shading_ == Shading::unlit;
    if (face.constant) face.color = glm::vec4(face.surface.material->base_color, 1.0f);
}

/// With the exact normal of the point, whatever the kind of shading.
glm::vec3 SampleShader::quadric_color(const ShadedFace& face, std::int32_t x,
                                      std::int32_t y) const {
    const QuadricPoint point = quadric_point(screen_, face.id, x, y);
    if (shading_ == Shading::depth) return color_of_depth(screen_.camera(), point.depth);
    if (shading_ == Shading::normals) return color_of_normal(point.normal);
    const Material& material = *face.surface.material;
    return lighting_.reflect(point.position, point.normal, material).on(material.base_color);
}

glm::vec3 SampleShader::base_color(const Surface& surface, glm::dvec3 barycentrics) const {
    if (!surface.colored) return surface.material->base_color;
    const glm::vec3 b(barycentrics);
    const std::array<glm::vec4, 3>& c = surface.colors;
    return surface.material->base_color *
           (b.x * glm::vec3(c[0]) + b.y * glm::vec3(c[1]) + b.z * glm::vec3(c[2]));
}

glm::vec3 SampleShader::depth_color(const ShadedFace& face, std::int32_t x, std::int32_t y) const {
    return color_of_depth(screen_.camera(), screen_.metric_depth(evaluate_depth(face.plane, x, y)));
}

float SampleShader::opacity(const ShadedFace& face, std::int32_t x, std::int32_t y) const {
    const Surface& surface = face.surface;
    const float own = surface.material->opacity;
    if (!surface.colored) return own;
    const std::array<glm::vec4, 3>& c = surface.colors;
    if (c[0].a >= 1 && c[1].a >= 1 && c[2].a >= 1) return own;
    const glm::vec3 b(surface.barycentrics.at(glm::dvec2(x, y) * pixels_per_unit_of_screen_));
    return own * std::clamp(b.x * c[0].a + b.y * c[1].a + b.z * c[2].a, 0.0f, 1.0f);
}

glm::vec4 SampleShader::varying_color(const ShadedFace& face, std::int32_t x,
                                      std::int32_t y) const {
    if (screen_.is_quadric(face.id)) return {quadric_color(face, x, y), 1.0f};
    if (shading_ == Shading::depth) return {depth_color(face, x, y), 1.0f};
    const Surface& surface = face.surface;
    const glm::dvec3 b = surface.barycentrics.at(glm::dvec2(x, y) * pixels_per_unit_of_screen_);
    if (shading_ == Shading::normals) return {color_of_normal(normal_at(surface, b)), 1.0f};
    const bool at_sample = shading_ == Shading::phong && surface.smooth;
    const Reflection light = at_sample ? lighting_.reflect(position_at(surface, b),
                                                           normal_at(surface, b), *surface.material)
                                       : mix(face.light, glm::vec3(b));
    return {light.on(base_color(surface, b)), 1.0f};
}

}  // namespace sightline
