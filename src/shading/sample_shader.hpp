// The colour of one sample.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "image/png_rows.hpp"
#include "shading/lighting.hpp"
#include "shading/surface.hpp"
#include "sightline/shading.hpp"

namespace sightline {

/// A triangle or quadric prepared for one kind of shading.
struct ShadedFace {
    std::uint32_t id = kNone;
    bool constant = false;            ///< every sample has `color`
    glm::vec4 color{0, 0, 0, 0};      ///< premultiplied
    std::array<Reflection, 3> light;  ///< flat: the first; gouraud: at the corners
    Surface surface;                  ///< of a quadric: the material only
    Plane plane;                      ///< depth only
};

/// Shades samples of a screen. Read-only once made, so any number of threads may use it.
class SampleShader {
public:
    SampleShader(const ScreenScene& screen, Shading shading);

    void prepare(std::uint32_t id, ShadedFace& face) const;
    /// At a point in units of the screen, of a face that is not constant; premultiplied.
    [[nodiscard]] glm::vec4 varying_color(const ShadedFace& face, std::int32_t x,
                                          std::int32_t y) const;
    /// At a point in units of the screen, of a lit or unlit face: that of its material times that
    /// of its vertices. 0..1.
    [[nodiscard]] float opacity(const ShadedFace& face, std::int32_t x, std::int32_t y) const;

private:
    [[nodiscard]] glm::vec3 base_color(const Surface& surface, glm::dvec3 barycentrics) const;
    [[nodiscard]] glm::vec3 depth_color(const ShadedFace& face, std::int32_t x,
                                        std::int32_t y) const;
    /// Whether the face is a hole in the picture; its colour is then known.
    static bool prepare_holdout(ShadedFace& face);
    void prepare_lit(std::uint32_t id, ShadedFace& face) const;
    void prepare_quadric(std::uint32_t id, ShadedFace& face) const;
    [[nodiscard]] glm::vec3 quadric_color(const ShadedFace& face, std::int32_t x,
                                          std::int32_t y) const;

    const ScreenScene& screen_;
    Shading shading_;
    Lighting lighting_;
    double pixels_per_unit_of_screen_;
};

/// A colour as it is summed up and as it is written.
struct PixelColor {
    PixelColor() = default;
    explicit PixelColor(glm::vec4 color) : linear(color), rgba8(color_to_rgba8(color)) {}

    glm::vec4 linear{0, 0, 0, 0};  ///< premultiplied
    std::array<std::uint8_t, 4> rgba8{};
};

/// Prepared triangles by the last bits of their ids: neighbouring samples mostly share one. What
/// the cache answers depends on the id alone, so it does not matter who filled it.
class FaceCache {
public:
    explicit FaceCache(const SampleShader& shader) : shader_(&shader), constants_(kConstants) {}

    /// The colour of a triangle that has but one, else null; valid until the next call.
    [[nodiscard]] const PixelColor* constant_color(std::uint32_t id) {
        Constant& entry = constants_[id % kConstants];
        if (entry.id != id) fill(id, entry);
        return entry.is_constant ? &entry.color : nullptr;
    }

    /// A triangle that has more than one; valid until the next call.
    [[nodiscard]] const ShadedFace& face(std::uint32_t id) {
        ShadedFace& face = faces_[id % kFaces];
        if (face.id != id) shader_->prepare(id, face);
        return face;
    }

private:
    struct Constant {
        std::uint32_t id = kNone;
        bool is_constant = false;
        PixelColor color;
    };

    void fill(std::uint32_t id, Constant& entry) {
        shader_->prepare(id, latest_);
        entry.id = id;
        entry.is_constant = latest_.constant;
        if (latest_.constant) {
            entry.color = PixelColor(latest_.color);
        } else {
            if (faces_.empty()) faces_.resize(kFaces);  // 1 MiB that flat faces do without
            faces_[id % kFaces] = latest_;
        }
    }

    static constexpr std::uint32_t kConstants = 8192, kFaces = 2048;
    const SampleShader* shader_;
    std::vector<Constant> constants_;
    std::vector<ShadedFace> faces_;
    ShadedFace latest_;
};

}  // namespace sightline
