// The colour of one sample.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "shading/lighting.hpp"
#include "shading/surface.hpp"
#include "sightline/shading.hpp"

namespace sightline {

/// A triangle prepared for one kind of shading.
struct ShadedFace {
    std::uint32_t id = kNone;
    bool constant = false;            ///< every sample has `color`
    glm::vec4 color{0, 0, 0, 0};      ///< premultiplied
    std::array<Reflection, 3> light;  ///< flat: the first; gouraud: at the corners
    Surface surface;
    Plane plane;  ///< depth only
};

/// Shades samples of a screen. Read-only once made, so any number of threads may use it.
class SampleShader {
public:
    SampleShader(const ScreenScene& screen, Shading shading);

    void prepare(std::uint32_t id, ShadedFace& face) const;
    /// At a point in units of the screen; premultiplied.
    [[nodiscard]] glm::vec4 color(const ShadedFace& face, std::int32_t x, std::int32_t y) const {
        return face.constant ? face.color : varying_color(face, x, y);
    }

private:
    [[nodiscard]] glm::vec4 varying_color(const ShadedFace& face, std::int32_t x,
                                          std::int32_t y) const;
    [[nodiscard]] glm::vec3 base_color(const Surface& surface, glm::dvec3 barycentrics) const;
    [[nodiscard]] glm::vec3 depth_color(const ShadedFace& face, std::int32_t x,
                                        std::int32_t y) const;
    void prepare_lit(std::uint32_t id, ShadedFace& face) const;

    const ScreenScene& screen_;
    Shading shading_;
    Lighting lighting_;
    double pixels_per_unit_of_screen_;
};

/// Prepared triangles by the last bits of their ids: neighbouring samples mostly share one. What a
/// face holds depends on its id alone, so it does not matter who filled the cache.
class FaceCache {
public:
    explicit FaceCache(const SampleShader& shader) : shader_(&shader), faces_(kSize) {}

    [[nodiscard]] const ShadedFace& face(std::uint32_t id) {
        ShadedFace& face = faces_[id % kSize];
        if (face.id != id) shader_->prepare(id, face);
        return face;
    }

private:
    static constexpr std::uint32_t kSize = 2048;
    const SampleShader* shader_;
    std::vector<ShadedFace> faces_;
};

}  // namespace sightline
