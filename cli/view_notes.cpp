#include "view_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

namespace sightline::cli {
namespace {

// Planes that are given waste the depth's bits when a step of z, at the far end of the scene, is
// over a ten-thousandth of the scene's range of depths: surfaces that near are in any order. So
// much is left of fitted planes at the least: far at 1e5 times near makes it 1e5 / 2^30 = 1e-4 of
// far. Ten times what fitted planes leave, so that there is something to gain; and not below what
// the single precision of most files tells apart.
constexpr double kCoarse = 1e-4, kGain = 10, kNothing = 1e-6;

constexpr double kRounding = 1e-12;

/// By how much depths differ that have neighbouring values of z.
double step_of_depth(const Camera& camera, double depth) {
    const double n = camera.near_plane, f = camera.far_plane;
    if (!camera.is_perspective()) return (f - n) / kDepthMax;
    return depth * depth * (f - n) / (f * n) / kDepthMax;
}

/// To three digits, downwards or upwards.
double rounded(double value, bool up) {
    if (value == 0 || !std::isfinite(value)) return value;
    const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 2);
    return unit * (up ? std::ceil(value / unit) : std::floor(value / unit));
}

std::optional<std::string> waste(const Subject& subject, const CameraOptions& options,
                                 const Camera& camera) {
    CameraOptions open = orbited(options, camera, {0, 1, 0}, 0);
    open.near_plane = open.far_plane = std::nullopt;
    auto fitted = make_camera(open, subject.reach, camera.resolution);
    if (!fitted || subject.reach.empty()) return std::nullopt;
    const double end = std::min(fitted->far_plane, camera.far_plane);
    if (!(end > camera.near_plane)) return std::nullopt;  // nothing is between the planes
    const double step = step_of_depth(camera, end), range = fitted->far_plane - fitted->near_plane;
    if (step <= std::max(kCoarse * range, kNothing * std::abs(end))) return std::nullopt;
    // Only now, as it takes longer.
    fitted = make_camera(open, subject.reach, camera.resolution,
                         [&](const Camera& view) { return subject.depths(view, EdgeOn::counts); });
    if (!fitted || step <= kGain * step_of_depth(*fitted, end)) return std::nullopt;
    return fmt::format(
        "with near at {:g} and far at {:g}, depths at {:.4g} are told apart in steps of {:.2g} "
        "only; leave --near and --far out, or give --near {:.4g} --far {:.4g}",
        camera.near_plane, camera.far_plane, end, step, rounded(fitted->near_plane, false),
        rounded(fitted->far_plane, true));
}

/// If a near plane that was fitted cuts what could be seen, or planes that were given waste bits.
std::optional<std::string> trouble_with_planes(const Subject& subject, const CameraOptions& options,
                                               const Camera& camera) {
    if (options.near_plane || options.far_plane) {
        if (auto text = waste(subject, options, camera)) return text;
    }
    // A fitted near plane is nearer than all that can be seen, unless it is the nearest there is.
    const bool least = camera.near_plane <= (1 + kRounding) * kLeastNear * camera.far_plane;
    if (options.near_plane || !camera.is_perspective() || !least) return std::nullopt;
    const DepthRange range = subject.depths(camera, EdgeOn::is_left_out);
    if (range.empty() || range.nearest >= camera.near_plane) return std::nullopt;
    return fmt::format(
        "the near plane, fitted at {:.4g}, cuts what is seen from depth {:.2g} on; give a smaller "
        "--near or a nearer --far",
        camera.near_plane, range.nearest);
}

/// The end of the sentence "the picture is blank: ...".
std::string why_blank(const Subject& subject, const Camera& camera, const ProjectCounts& counts) {
    const DepthRange all = depths_of_box(subject.reach, camera);
    if (all.empty()) return "the scene is empty";
    if (counts.triangles > 0 && counts.degenerate == counts.triangles) {
        return fmt::format(
            "the triangles of the scene (all {}) are degenerate, without area; repair the model",
            counts.triangles);
    }
    if (camera.is_perspective() && all.farthest <= 0) {
        return fmt::format(
            "all of the scene lies behind the eye, at depths {:.4g} to {:.4g}; look the other way",
            all.nearest, all.farthest);
    }
    const DepthRange range = subject.depths(camera, EdgeOn::counts);
    if (range.empty()) {
        return fmt::format(
            "the scene, at depths {:.4g} to {:.4g}, lies beside the view; give another --target or "
            "--zoom",
            all.nearest, all.farthest);
    }
    const std::string_view what = range.farthest < camera.near_plane ? "lies before the near plane"
                                  : range.nearest > camera.far_plane ? "lies behind the far plane"
                                                                     : "shows nothing";
    return fmt::format(
        "what is in view, at depths {:.4g} to {:.4g}, {} (near is {:.4g}, far {:.4g}); change "
        "{}",
        range.nearest, range.farthest, what, camera.near_plane, camera.far_plane,
        what == "shows nothing" ? "--near, --far, --cull or --resolution" : "--near or --far");
}

/// When more than half of the triangles were degenerate or outside.
std::optional<std::string> many_dropped(const ProjectCounts& counts, const Box& reach,
                                        const Camera& camera) {
    if (2 * (counts.degenerate + counts.outside) <= counts.triangles) return std::nullopt;
    const DepthRange all = depths_of_box(reach, camera);
    return fmt::format(
        "of {} triangles {} are degenerate and {} outside of the view; the scene lies at depths "
        "{:.4g} to {:.4g}, near is {:.4g}, far {:.4g}",
        counts.triangles, counts.degenerate, counts.outside, all.nearest, all.farthest,
        camera.near_plane, camera.far_plane);
}

}  // namespace

Subject subject_of(const Scene& scene) {
    return {scene.reach, [&scene](const Camera& camera, EdgeOn edge_on) {
                return depths_in_view(scene, camera, edge_on);
            }};
}

DepthRange depths_of_box(const Box& box, const Camera& camera) {
    DepthRange range;
    if (box.empty()) return range;
    for (unsigned k = 0; k < 8; ++k) {
        const double depth =
            camera.depth_of({(k & 1) != 0 ? box.hi.x : box.lo.x, (k & 2) != 0 ? box.hi.y : box.lo.y,
                             (k & 4) != 0 ? box.hi.z : box.lo.z});
        range.take_in({depth, depth});
    }
    return range;
}

void ViewNotes::add(const SeenView& view, std::uint32_t frame) {
    const auto keep = [frame](std::string& kept, const std::optional<std::string>& text) {
        if (kept.empty() && text)
            kept = frame > 0 ? fmt::format("frame {}: {}", frame, *text) : *text;
    };
    if (planes_.empty())
        keep(planes_, trouble_with_planes(view.subject, view.options, view.camera));
    if (view.blank) {
        if (blank_frames_++ == 0) keep(blank_, why_blank(view.subject, view.camera, view.counts));
    } else {
        keep(dropped_, many_dropped(view.counts, view.subject.reach, view.camera));
    }
}

void ViewNotes::print(const Notes& notes, std::string_view blank) const {
    if (!planes_.empty()) notes.warn(planes_);
    if (blank_frames_ > 1) {
        notes.warn(fmt::format("{} in {} frames; {}", blank, blank_frames_, blank_));
    } else if (blank_frames_ == 1) {
        notes.warn(fmt::format("{}: {}", blank, blank_));
    }
    if (!dropped_.empty()) notes.note(dropped_);
}

std::vector<IdleOption> idle_camera_options(std::span<const Projection> projections) {
    const auto none = [&](auto is) { return std::ranges::none_of(projections, is); };
    const auto perspective = [](Projection p) { return p == Projection::perspective; };
    const auto oblique = [](Projection p) {
        return p == Projection::cavalier || p == Projection::cabinet;
    };
    return {{"--fov", none(perspective), "a parallel view has --ortho-height instead"},
            {"--ortho-height", none(std::not_fn(perspective)), "a perspective has --fov instead"},
            {"--oblique-angle", none(oblique), "it is for --projection cavalier and cabinet"}};
}

}  // namespace sightline::cli
