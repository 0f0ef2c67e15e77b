// What a view does not show: planes that cut or waste, pictures that are blank, what was dropped.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "notes.hpp"
#include "sightline/camera.hpp"
#include "sightline/screen_scene.hpp"

namespace sightline::cli {

/// What is looked at: a scene, or one that is not in memory as a whole.
struct Subject {
    Box reach;
    /// As depths_in_view(); called only where something is to be told.
    std::function<DepthRange(const Camera&, EdgeOn)> depths;
};

/// The scene must outlive it.
[[nodiscard]] Subject subject_of(const Scene& scene);

/// The depths of a box along the gaze; empty if it is.
[[nodiscard]] DepthRange depths_of_box(const Box& box, const Camera& camera);

/// A view that was drawn.
struct SeenView {
    const Subject& subject;
    const CameraOptions& options;  ///< what the user said of the camera
    const Camera& camera;
    const ProjectCounts& counts;
    bool blank = false;
};

/// Collects what is to be told of the views of a run, and tells it in a line a kind.
class ViewNotes {
public:
    /// `frame` counts from 1; 0: it is the only one. Of several frames the first of a kind is told.
    void add(const SeenView& view, std::uint32_t frame = 0);
    /// `blank` begins a sentence: "the picture is blank".
    void print(const Notes& notes, std::string_view blank) const;

private:
    std::string planes_, dropped_, blank_;  // empty: nothing to tell
    std::uint32_t blank_frames_ = 0;
};

/// The options of cameras that change nothing in any of the projections that are in use.
[[nodiscard]] std::vector<IdleOption> idle_camera_options(std::span<const Projection> projections);

}  // namespace sightline::cli
