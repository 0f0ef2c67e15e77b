// Shading: colours for what is visible. Deferred, so each visible sample is shaded once whatever
// the depth complexity, and every visibility algorithm gets every kind of shading.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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
/// Whether normals are interpolated: gouraud and phong.
[[nodiscard]] bool is_smooth(Shading shading);

/// Whether a face, or a quadric, of the scene lets something shine through.
[[nodiscard]] bool has_translucent_faces(const Scene& scene);
/// Whether draw() blends: the algorithm has an order of surfaces, some are translucent, and it is
/// colours that are shown, not numbers.
[[nodiscard]] bool blends(const Algorithm& algorithm, Shading shading, const Scene& scene);

/// Whether draw() can weigh colours by area: the algorithm keeps fragments, and it is colours that
/// are shown.
[[nodiscard]] bool antialiases(const Algorithm& algorithm, Shading shading);

struct ShadeOptions {
    Shading shading = Shading::flat;
    glm::vec4 background{1, 1, 1, 1};  ///< linear, premultiplied
    int threads = 0;                   ///< 0 = all cores
};

// A Visibility that holds a band of a picture gives the rows of that band, with the same values as
// in the whole picture; it must hold whole rows of pixels.

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

// -- from a projected scene to files -------------------------------------------------------------

enum class PictureContent {
    color,    ///< png, exr (with depth), npy; shaded as the options say
    depth,    ///< png, exr, npy
    ids,      ///< of triangles: png, npy; of objects too: exr
    normals,  ///< png, exr, npy; interpolated where the shading does
    mask,     ///< png, npy
    matte,    ///< the alpha of the colours, 0..1: png, npy
};

/// One file that draw() writes; what is in it is said in sightline/image.hpp.
struct PictureFile {
    PictureContent content = PictureContent::color;
    std::string path;
    ImageFormat format = ImageFormat::png;
    bool add_normals = false, add_ids = false;  ///< further layers of a colour EXR
    /// A colour EXR with all surfaces of each pixel, as samples of a deep picture.
    bool deep = false;
};

/// What draw() is about to do, on the thread that called it. A PNG is shaded while it is written.
enum class DrawStage { resolve, shade, write };

struct DrawOptions {
    std::uint32_t samples_per_axis = 1;  ///< of colours; everything else is that at the centres
    /// Colours are weighed by the area that surfaces cover, where antialiases() says so; the
    /// samples don't matter then.
    bool by_area = false;
    ShadeOptions shading;
    /// Appended to, when given: what the algorithm did, for the colours if there are any.
    std::vector<Counter>* counters = nullptr;
    /// Called, when set, at every change of stage with the rows of pixels that are done.
    std::function<void(DrawStage, std::uint32_t rows_done)> on_stage;
    const BspTree* tree = nullptr;  ///< see ResolveOptions
    /// Set, when given: whether a surface covers a sample (of the colours if there are any), or a
    /// part of a pixel where they are weighed by area.
    bool* anything_seen = nullptr;
};

/// Resolves, shades and writes one or several files of a view. Where the algorithm makes its
/// answer in bands, this is done for a group of rows after another, so that memory does not grow
/// with the height: at most 65,536 pixels a side; the others keep all samples (2^28 at most), but
/// nothing else of the picture. The bytes are those of resolve(), shade(), the maps and the
/// write_* functions, whatever the algorithm and the number of threads.
///
/// Every group goes to the files in their order; after the last one each is completed before the
/// next gets its rows, so a stream that stands last is touched when the others are safe, if the
/// picture is one group. After an error files completed before stay.
/// Errors: as of resolve() and the write_* functions; bad_option for a mask in an EXR, and for a
/// deep file where colours are not weighed by area.
[[nodiscard]] Status draw(const ScreenScene& screen, const Algorithm& algorithm,
                          const DrawOptions& options, std::span<const PictureFile> files);

}  // namespace sightline
