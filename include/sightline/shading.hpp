// Shading: colours for what is visible. Deferred, so each visible sample is shaded once whatever
// the depth complexity, and every visibility algorithm gets every kind of shading.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec4.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "sightline/image.hpp"
#include "sightline/screen_scene.hpp"
#include "sightline/visibility.hpp"

namespace sightline {

enum class Shading {
    flat,     ///< one normal a face
    gouraud,  ///< intensity computed at the corners and interpolated (Gouraud 1971)
    phong,    ///< normal interpolated, intensity computed at the sample (Phong 1975)
    unlit,    ///< base colour
    depth,    ///< white = far, black = near; the sRGB byte is linear in metric depth
    normals,  ///< (n + 1) / 2 in the world, as the sRGB byte; n on the viewer's side of the face
    ids,      ///< a distinct colour for each triangle
};

[[nodiscard]] std::optional<Shading> parse_shading(std::string_view name);
[[nodiscard]] std::string_view name_of(Shading shading);

struct ShadeOptions {
    Shading shading = Shading::flat;
    glm::vec4 background{1, 1, 1, 1};  ///< linear, premultiplied
    int threads = 0;                   ///< 0 = all cores
};

/// Colours of the samples, averaged (box filter, linear light) over each pixel. gouraud and phong
/// need Scene::triangle_normals (see make_normals()); where an object has none its faces are flat.
/// The bytes do not depend on the number of threads or on the machine.
[[nodiscard]] ColorImage shade(const ScreenScene& screen, const Visibility& visibility,
                               const ShadeOptions& options);

/// shade() and write_color_png() in one, with the same pixels but without the picture in memory:
/// bands of rows are shaded, compressed in parallel and written in order. Errors as those of
/// write_color_png().
[[nodiscard]] Status write_shaded_png(const std::string& path, const ScreenScene& screen,
                                      const Visibility& visibility, const ShadeOptions& options);

// Maps of what is seen at the pixels' centres. Precondition: visibility.grid.per_axis == 1.

[[nodiscard]] DepthImage depth_map(const ScreenScene& screen, const Visibility& visibility);
/// On the viewer's side of the face; interpolated with `smooth` where the scene has normals.
[[nodiscard]] NormalImage normal_map(const ScreenScene& screen, const Visibility& visibility,
                                     bool smooth);
[[nodiscard]] IdImage triangle_map(const Visibility& visibility);
[[nodiscard]] IdImage object_map(const ScreenScene& screen, const Visibility& visibility);
[[nodiscard]] MaskImage mask_map(const Visibility& visibility);

}  // namespace sightline
