// Pictures of scenes that don't fit into memory: one part after the other goes into one z-buffer,
// for polygons may come in any order.
#pragma once

#include <memory>
#include <span>

#include "sightline/camera.hpp"
#include "sightline/screen_scene.hpp"
#include "sightline/shading.hpp"

namespace sightline {

/// What has to be known of all parts of a picture before the first is drawn, so that together they
/// give the picture of the whole. In this order:
///
///     for each part:  survey(part)                          // in the order of their numbers
///     finish_survey()
///     for each part that is_shared(): compare(k, part)
///     finish_comparison(); make the camera, from frame()
///     set_view(camera, options of project())
///     for each part:  adopt(k, part); project(); adopt(k, screen); StreamedPicture::add(screen)
///
/// Parts may come and go: nothing of them stays but 16 bytes for each plane of a part until
/// finish_comparison(), and the faces that lie in one plane with faces of other parts (about 100
/// bytes each, 8 once the view is set). They are finished scenes, each loaded by itself the same
/// way every time, best with LoadOptions::find_sheets off, and with one LoadOptions::offset:
/// offset_for() the box of all, which a first survey without an offset finds.
class StreamPlan {
public:
    StreamPlan();
    ~StreamPlan();
    StreamPlan(const StreamPlan&) = delete;
    StreamPlan& operator=(const StreamPlan&) = delete;

    /// Takes in the next part. O(n log n) for its triangles.
    void survey(const Scene& part);
    void finish_survey();

    /// An empty scene with the box of all parts, for cameras, and all of their lights. Its camera
    /// is that of the first part that has one.
    [[nodiscard]] const Scene& frame() const;
    [[nodiscard]] bool has_file_normals() const;

    /// Whether faces of part k may lie in a plane with faces of others: it is to be compared.
    [[nodiscard]] bool is_shared(std::uint32_t k) const;
    /// Takes such a part, whose sheets it replaces. Any order. O(n log n).
    void compare(std::uint32_t k, Scene& part);
    void finish_comparison();

    /// Finds the planes that parts share, as project() has them. Once. Errors as those of
    /// project().
    [[nodiscard]] Status set_view(const Camera& camera, const ProjectOptions& options);

    /// Makes of a part what it is in the whole: its sheets and lights. O(n log n).
    void adopt(std::uint32_t k, Scene& part) const;
    /// The same of its projection, after set_view().
    void adopt(std::uint32_t k, ScreenScene& screen) const;

private:
    friend class StreamedPicture;
    struct State;
    std::unique_ptr<State> state_;
};

/// A picture that grows part by part. It keeps, for every sample, what is seen of the parts so far:
/// the exact depth (20 bytes), the colour, and what the files need beside it, so memory does not
/// grow with the parts. With a plan the files are those that draw() makes of the whole scene with
/// the z-buffer, byte for byte. Without one, faces of different parts that lie in one plane are
/// snapped on their own, and the quadrics of a part are numbered after its own triangles.
/// Translucent faces are opaque.
///
/// Triangles, objects and polygons are numbered on from part to part.
class StreamedPicture {
public:
    /// options.samples_per_axis and .shading are used. The files and the plan must outlive it.
    StreamedPicture(const Camera& camera, const DrawOptions& options,
                    std::span<const PictureFile> files, const StreamPlan* plan = nullptr);
    ~StreamedPicture();
    StreamedPicture(const StreamedPicture&) = delete;
    StreamedPicture& operator=(const StreamedPicture&) = delete;

    /// Takes a part, which may go afterwards, with its scene. Precondition: it is projected with
    /// the camera, adopted by the plan, and has the offset of all others (LoadOptions::offset).
    /// Parts come in the order of their numbers. O(triangles + samples), on all cores. Errors: as
    /// of resolve().
    [[nodiscard]] Status add(const ScreenScene& part);

    /// Whether a surface of the parts so far covers a sample.
    [[nodiscard]] bool anything_seen() const;

    /// Writes the files, in their order. Errors: as of the write_* functions; bad_option for a mask
    /// in an EXR and for a deep file.
    [[nodiscard]] Status write() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace sightline
