// From a loaded scene to the files of every frame. What frames share is kept: the scene, the memory
// of the projected one, and the BSP tree, which holds what doesn't move.
#include "render_frames.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "errors.hpp"
#include "report.hpp"

namespace sightline::cli {
namespace {

constexpr std::uint64_t kMostFrames = 1'000'000;

// -- options -----------------------------------------------------------------------------------

std::optional<Orbit> parse_orbit(std::string_view text) {
    const auto items = split_list(text);
    if (items.size() != 1 && items.size() != 3) return std::nullopt;
    constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};
    const auto axis = std::ranges::find(kAxes, items[0]);
    if (axis == kAxes.end()) return std::nullopt;
    Orbit orbit;
    orbit.axis = {0, 0, 0};
    orbit.axis[static_cast<int>(axis - kAxes.begin())] = 1;
    if (items.size() == 1) return orbit;
    const auto start = parse_number(items[1]), end = parse_number(items[2]);
    if (!start || !end || !std::isfinite(*end - *start)) return std::nullopt;
    orbit.start = *start;
    orbit.end = *end;
    return orbit;
}

void read_orbit(OptionReader& reader, FrameOptions& frames) {
    const auto text = reader.arguments().value("--orbit");
    if (!text) return;
    frames.orbit = parse_orbit(*text);
    if (!frames.orbit) {
        reader.fail(
            wrong_use("--orbit: '{}' is not an axis x, y or z, or AXIS,START,END in degrees, as in "
                      "--orbit y,0,360",
                      *text));
    } else if (frames.count == 0) {
        reader.fail(wrong_use("--orbit needs the number of pictures, as in --frames 36"));
    }
}

void read_path(OptionReader& reader, FrameOptions& frames) {
    const auto file = reader.arguments().value("--path");
    if (!file || reader.error()) return;
    if (frames.orbit) {
        reader.fail(wrong_use("--path and --orbit both move the camera; give one of them"));
        return;
    }
    auto cameras = load_camera_path(*file);
    if (!cameras) {
        reader.fail(cameras.error());
    } else if (frames.count > cameras->size()) {
        reader.fail(
            wrong_use("--frames: {} are more than the {} cameras of '{}'; ask for fewer or "
                      "list more",
                      frames.count, cameras->size(), *file));
    } else if (cameras->size() > kMostFrames) {
        reader.fail(wrong_use("--path: '{}' lists over {} cameras; split it", *file, kMostFrames));
    } else {
        frames.path = std::move(*cameras);
        if (frames.count == 0) frames.count = static_cast<std::uint32_t>(frames.path.size());
    }
}

/// Only a scene file can have moving objects.
bool may_move(const Models& models) {
    return models.options.format == "json" ||
           std::ranges::any_of(models.paths, [](std::string path) {
               std::ranges::transform(path, path.begin(), [](char c) {
                   return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
               });
               return path.ends_with(".json");
           });
}

Error nothing_moves() {
    return wrong_use(
        "--frames: nothing moves; give --orbit y or --path FILE, or a scene file with "
        "moving objects");
}

// -- names of files ----------------------------------------------------------------------------

/// Where the runs of '#' in the file's name begin, folders apart, and end.
std::vector<std::pair<std::size_t, std::size_t>> runs_of_signs(const std::string& path) {
    std::vector<std::pair<std::size_t, std::size_t>> runs;
    const std::size_t slash = path.rfind('/');
    std::size_t at = path.find('#', slash == std::string::npos ? 0 : slash);
    while (at != std::string::npos) {
        const std::size_t end = std::min(path.find_first_not_of('#', at), path.size());
        runs.emplace_back(at, end);
        at = path.find('#', end);
    }
    return runs;
}

void check_name(OptionReader& reader, const Output& output, bool frames) {
    const std::size_t runs = runs_of_signs(output.path).size();
    if (!frames && runs > 0) {
        reader.fail(
            wrong_use("{}: in '{}' a '#' stands for the number of a frame; give --frames N "
                      "or another name",
                      output.option, output.path));
    } else if (frames && output.path == "-") {
        reader.fail(wrong_use("{}: '-' can't take several frames; name files, as in frame_####.png",
                              output.option));
    } else if (frames && runs != 1) {
        reader.fail(
            wrong_use("{}: '{}' has {} '#' for the number of the frame; name it as in "
                      "frame_####.png",
                      output.option, output.path, runs == 0 ? "no" : "more than one run of"));
    }
}

// -- the work ----------------------------------------------------------------------------------

struct FrameCamera {
    CameraOptions options;
    Camera camera;
};

/// The cameras of the frames that are drawn.
Result<std::vector<FrameCamera>> find_cameras(const RenderOptions& options, const Scene& scene) {
    const FrameOptions& frames = options.frames;
    const CameraOptions own = scene.camera.value_or(CameraOptions{});
    const CameraOptions start = merge_cameras(own, options.camera);
    std::vector<FrameCamera> cameras;
    if (frames.path.empty()) {
        const auto still = make_camera(start, scene, options.resolution);
        if (!still) return still.error();
        cameras.assign(frames.end - frames.first, {start, *still});
        if (!frames.orbit) return cameras;
    }
    cameras.resize(frames.end - frames.first);
    for (std::uint32_t k = frames.first; k < frames.end; ++k) {
        FrameCamera& here = cameras[k - frames.first];
        if (frames.orbit) {
            const auto [axis, from, to] = *frames.orbit;
            here.options = orbited(start, here.camera, axis, from + (to - from) * k / frames.count);
        } else {
            here.options = merge_cameras(merge_cameras(own, frames.path[k]), options.camera);
        }
        auto made = make_camera(here.options, scene, options.resolution);
        if (!made) {
            return Error{made.error().kind,
                         fmt::format("frame {}: {}", k + 1, made.error().message)};
        }
        here.camera = *made;
    }
    return cameras;
}

Result<BspTree> load_tree(const std::string& path, const Scene& scene,
                          const std::vector<std::uint8_t>& moving) {
    auto tree = load_bsp(path, scene);
    if (!tree) return tree;
    // Whether what is in the tree stands still is not in the places of its triangles.
    const auto left_out = static_cast<std::uint64_t>(std::ranges::count(moving, 1));
    if (tree->stats().left_out == left_out) return tree;
    return Error{ErrorKind::bad_input,
                 fmt::format("--bsp-load: in '{}' other objects move than in the scene; save the "
                             "tree of the scene again",
                             path)};
}

/// The tree of what doesn't move, for the algorithm that wants one.
Result<std::optional<BspTree>> find_tree(const RenderOptions& options, const Scene& scene,
                                         Progress& progress) {
    std::optional<BspTree> tree;
    if (options.algorithm->name != kTreeAlgorithm) return tree;
    const bool loads = !options.tree.load.empty();
    progress.stage(loads ? "loading the tree" : "building the tree");
    const std::vector<std::uint8_t> moving = moving_triangles(scene);
    auto made = loads ? load_tree(options.tree.load, scene, moving)
                      : build_bsp(scene, {options.common.threads, moving});
    if (!made) return made.error();
    if (!options.tree.save.empty()) {
        if (Status saved = save_bsp(*made, options.tree.save); !saved) return saved.error();
    }
    tree = std::move(*made);
    return tree;
}

/// Adds up what the algorithm counted; what describes the tree is the same in every frame.
void add_counters(std::vector<Counter>& sum, const std::vector<Counter>& frame) {
    for (const Counter& counter : frame) {
        const auto known = std::ranges::find(sum, counter.name, &Counter::name);
        if (known == sum.end()) {
            sum.push_back(counter);
        } else if (counter.name.starts_with("bsp ")) {
            known->value = counter.value;
        } else {
            known->value += counter.value;
        }
    }
}

void add(Rendered& sum, const ProjectCounts& counts, const Drawn& drawn) {
    sum.counts.triangles = counts.triangles;
    sum.counts.degenerate = counts.degenerate;
    sum.counts.culled += counts.culled;
    sum.counts.outside += counts.outside;
    sum.counts.clipped += counts.clipped;
    sum.counts.pieces += counts.pieces;
    sum.candidates += counts.triangles - counts.degenerate;
    sum.drawn.resolve += drawn.resolve;
    sum.drawn.shade += drawn.shade;
    sum.drawn.write += drawn.write;
    add_counters(sum.drawn.counters, drawn.counters);
}

class FrameRun {
public:
    FrameRun(const RenderOptions& options, Shading shading, const Scene& scene, Progress& progress)
        : options_(options), shading_(shading), scene_(scene), progress_(progress) {
        for (const Motion& motion : scene.motions) {
            poses_ = std::max(poses_, static_cast<std::uint32_t>(motion.frames.size()));
        }
    }

    Result<Rendered> run() {
        const FrameOptions& frames = options_.frames;
        const auto cameras = find_cameras(options_, scene_);
        if (!cameras) return cameras.error();
        Stopwatch watch;
        auto tree = find_tree(options_, scene_, progress_);
        if (!tree) return tree.error();
        tree_ = std::move(*tree);
        sum_.tree = watch.ms();
        for (std::uint32_t k = frames.first; k < frames.end; ++k) {
            if (frames.count > 0) progress_.frame(k + 1, frames.count);
            Status drawn = draw(k, (*cameras)[k - frames.first]);
            if (drawn) continue;
            if (frames.count == 0) return drawn.error();
            return Error{drawn.error().kind,
                         fmt::format("frame {}: {}", k + 1, drawn.error().message)};
        }
        return std::move(sum_);
    }

private:
    /// The scene as it stands in a frame.
    const Scene& pose(std::uint32_t k) {
        if (poses_ == 0) return scene_;
        const std::uint32_t wanted = std::min(k, poses_ - 1);
        if (posed_ != wanted) {
            progress_.stage("moving");
            pose_ = {};  // not two of them at once
            pose_ = posed(scene_, wanted);
            posed_ = wanted;
        }
        return pose_;
    }

    Status draw(std::uint32_t k, const FrameCamera& from) {
        Stopwatch watch;
        const Scene& scene = pose(k);
        sum_.pose += watch.lap();
        progress_.stage("projecting");
        const ProjectOptions projecting{options_.cull, options_.common.threads};
        if (Status done = project(scene, from.camera, projecting, screen_); !done) return done;
        sum_.project += watch.lap();
        std::vector<PictureOutput> pictures = options_.outputs;
        if (options_.frames.count > 0) {
            for (PictureOutput& picture : pictures) {
                picture.output.path = numbered(picture.output.path, k + 1);
            }
        }
        const View view{screen_, shading_, tree_ ? &*tree_ : nullptr};
        const auto drawn = draw_outputs(options_, view, pictures, progress_);
        if (!drawn) return drawn.error();
        add(sum_, screen_.counts(), *drawn);
        sum_.views.add(
            {subject_of(scene), from.options, from.camera, screen_.counts(), !drawn->anything_seen},
            options_.frames.count > 0 ? k + 1 : 0);
        if (options_.common.stats || options_.common.json) {
            sum_.back_facing += count_back_facing(scene, from.camera, options_.common.threads);
        }
        return success();
    }

    const RenderOptions& options_;
    Shading shading_;
    const Scene& scene_;  // at rest
    Progress& progress_;
    std::optional<BspTree> tree_;
    std::uint32_t poses_ = 0;  // after these frames nothing moves any more
    Scene pose_;
    std::optional<std::uint32_t> posed_;  // the frame of pose_
    ScreenScene screen_;
    Rendered sum_;
};

}  // namespace

void read_frames(OptionReader& reader, RenderOptions& options) {
    FrameOptions& frames = options.frames;
    const auto count = reader.count("--frames", 1, kMostFrames,
                                    fmt::format("a number of frames from 1 to {}", kMostFrames));
    frames.count = static_cast<std::uint32_t>(count.value_or(0));
    read_orbit(reader, frames);
    read_path(reader, frames);
    if (frames.count == 0) {
        if (reader.arguments().has("--frame")) {
            reader.fail(wrong_use("--frame needs the number of all frames, as in --frames 36"));
        }
        return;
    }
    if (!frames.orbit && frames.path.empty() && !may_move(options.models)) {
        reader.fail(nothing_moves());
    }
    frames.end = frames.count;
    const auto only =
        reader.count("--frame", 1, frames.count, fmt::format("a frame from 1 to {}", frames.count));
    if (!only) return;
    frames.end = static_cast<std::uint32_t>(*only);
    frames.first = frames.end - 1;
}

void read_tree_files(OptionReader& reader, RenderOptions& options) {
    const auto read = [&](const char* option, std::string& path) {
        const auto text = reader.arguments().value(option);
        if (!text) return;
        path = *text;
        if (options.algorithm->name != kTreeAlgorithm) {
            reader.fail(wrong_use("{} is for --algorithm {} only", option, kTreeAlgorithm));
        } else if (path.empty() || path == "-") {
            reader.fail(wrong_use("{}: '{}' is not the name of a file", option, path));
        }
    };
    read("--bsp-load", options.tree.load);
    read("--bsp-save", options.tree.save);
    if (!options.tree.load.empty() && !options.tree.save.empty()) {
        reader.fail(
            wrong_use("--bsp-load and --bsp-save: a tree that is loaded is in a file "
                      "already; give one of them"));
    }
}

std::string numbered(const std::string& path, std::uint32_t number) {
    const auto runs = runs_of_signs(path);
    if (runs.empty()) return path;
    const auto [first, end] = runs.front();
    return fmt::format("{}{:0{}}{}", path.substr(0, first), number, end - first, path.substr(end));
}

void check_frame_outputs(OptionReader& reader, RenderOptions& options,
                         std::span<const Output> outputs) {
    const bool frames = options.frames.count > 0;
    for (const Output& output : outputs) check_name(reader, output, frames);
    std::vector<std::string> inputs = options.models.paths;
    if (const auto path = reader.arguments().value("--path")) inputs.push_back(*path);
    if (!options.tree.load.empty()) inputs.push_back(options.tree.load);
    for (std::uint32_t k = options.frames.first; k < options.frames.end && !reader.error(); ++k) {
        std::vector<Output> files(outputs.begin(), outputs.end());
        if (frames) {
            for (Output& file : files) file.path = numbered(file.path, k + 1);
        }
        if (!options.tree.save.empty()) files.push_back({{"--bsp-save", options.tree.save}});
        check_outputs(reader, files, inputs);
        for (const Output& file : files) options.models.options.outputs.push_back(file.path);
    }
}

Result<Rendered> render_frames(const RenderOptions& options, Shading shading, const Scene& scene,
                               Progress& progress) {
    const FrameOptions& frames = options.frames;
    if (frames.count > 0 && !frames.orbit && frames.path.empty() && scene.motions.empty()) {
        return nothing_moves();
    }
    return FrameRun(options, shading, scene, progress).run();
}

}  // namespace sightline::cli
