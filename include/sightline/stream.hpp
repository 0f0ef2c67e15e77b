// Pictures of scenes that don't fit into memory: one part after the other goes into one z-buffer,
// for polygons may come in any order.
#pragma once

#include <memory>
#include <span>

#include "sightline/camera.hpp"
#include "sightline/screen_scene.hpp"
#include "sightline/shading.hpp"

namespace sightline {

/// A picture that grows part by part. It keeps, for every sample, what is seen of the parts so far:
/// the exact depth (20 bytes), the colour, and what the files need beside it, so memory does not
/// grow with the parts. The files are those that draw() makes of the whole scene with the z-buffer,
/// byte for byte, except where faces of different parts lie in one plane: what shares an exact
/// plane in a scene that is loaded as a whole is snapped on its own here. Translucent faces are
/// opaque.
///
/// Triangles, objects and polygons are numbered on from part to part; the quadrics of a part come
/// after its own triangles.
class StreamedPicture {
public:
    /// options.samples_per_axis and .shading are used. The files must outlive it.
    StreamedPicture(const Camera& camera, const DrawOptions& options,
                    std::span<const PictureFile> files);
    ~StreamedPicture();
    StreamedPicture(const StreamedPicture&) = delete;
    StreamedPicture& operator=(const StreamedPicture&) = delete;

    /// Takes a part, which may go afterwards, with its scene. Precondition: it is projected with
    /// the camera, and all parts have one offset (see LoadOptions::offset). The order of the parts
    /// matters only to the numbers. O(triangles + samples), on all cores. Errors: as of resolve().
    [[nodiscard]] Status add(const ScreenScene& part);

    /// Writes the files, in their order. Errors: as of the write_* functions; bad_option for a mask
    /// in an EXR and for a deep file.
    [[nodiscard]] Status write() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace sightline
