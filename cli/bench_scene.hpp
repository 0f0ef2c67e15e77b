// What `sightline bench` measures: the options of a scene and its camera, the scene made ready, and
// frames timed on it. The peers' programs (bench_peers.hpp) are given the same.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "options.hpp"
#include "progress.hpp"
#include "sightline/sightline.hpp"

namespace sightline::cli {

struct BenchOptions {
    CommonOptions common;
    Models models;
    CameraOptions camera;
    Resolution resolution;
    const Algorithm* algorithm = nullptr;
    Cull cull = Cull::none;
    unsigned frames = 0;
    std::uint32_t generate = 0;  ///< triangles of a generated scene, where there is no model
    double complexity = 0;       ///< depth complexity of a generated scene
    int subdivide = 0;
    std::uint32_t repeat = 1;
    double repeat_gap = 0.25;  ///< in bounding radii
    bool farthest_first = false;
};

/// A scene that has been loaded or generated, and has grown.
struct BenchScene {
    Scene scene;
    Camera camera;
    bool own_camera = false;  ///< the camera is not wholly that of the benchmarks
    double load_ms = 0, prepare_ms = 0;
    std::optional<BspTree> tree;  ///< for the algorithm that wants one
    double tree_ms = 0;
};

[[nodiscard]] Result<BenchScene> prepare_bench(const BenchOptions& options, Progress& progress);

/// Milliseconds of every timed frame.
struct FrameTimes {
    std::vector<double> project, resolve, frame;
    std::vector<double> order;  ///< what a list-priority algorithm needs before it paints
};

/// Projects and resolves into the same memory again and again: 3 frames to warm up, then
/// options.frames that are timed. The last answer stays in `screen` (which refers to bench.scene)
/// and `visibility`.
[[nodiscard]] Result<FrameTimes> time_frames(const BenchOptions& options, const BenchScene& bench,
                                             Progress& progress, ScreenScene& screen,
                                             Visibility& visibility);

/// Precondition: not empty.
[[nodiscard]] double median(std::vector<double> values);

/// Mean number of triangles over a point of the picture: the areas of the snapped triangles over
/// that of the picture. What hangs over the picture's border counts too.
[[nodiscard]] double depth_complexity(const ScreenScene& screen);

/// Names of the model files, or "random-N".
[[nodiscard]] std::string mesh_name(const BenchOptions& options);
/// "1920x1080".
[[nodiscard]] std::string size_name(Resolution resolution);
/// The threads that --threads allows, all when it is absent.
[[nodiscard]] int thread_count(const CommonOptions& common);

}  // namespace sightline::cli
