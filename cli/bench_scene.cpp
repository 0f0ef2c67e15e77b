// Loading, growing and timing for `sightline bench` (see the header).
#include "bench_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>

#include "notes.hpp"
#include "report.hpp"
#include "sightline/generate.hpp"
#include "tessellate.hpp"

namespace sightline::cli {
namespace {

constexpr unsigned kWarmUps = 3;

/// The camera of the benchmarks, changed by what the scene file and the command line say.
CameraOptions camera_options(const CameraOptions& own, const Box& bounds) {
    CameraOptions base = bench_camera(bounds);
    // Another gaze brings its own fit.
    if (own.direction || own.view) base.eye = base.target = std::nullopt;
    return merge_cameras(base, own);
}

bool says_nothing(const CameraOptions& own) {
    return !own.eye && !own.target && !own.up && !own.direction && !own.view && !own.projection &&
           !own.fov && !own.ortho_height && !own.oblique_angle && !own.zoom && !own.near_plane &&
           !own.far_plane;
}

Result<Scene> load(const BenchOptions& options) {
    if (options.models.paths.empty()) {
        return random_triangles(options.generate, 1, {options.complexity, {1, 1, 1}});
    }
    return load_scene(options.models.paths, options.models.options);
}

/// Subdivides and repeats; the copies stand behind one another along the gaze.
Result<Scene> grow(const BenchOptions& options, Scene scene, const Camera& camera) {
    const double radius = 0.5 * glm::length(scene.bounds.extent());
    if (options.subdivide > 0) {
        auto finer = subdivide(scene, options.subdivide);
        if (!finer) return finer.error();
        scene = std::move(*finer);
    }
    if (options.repeat == 1) return scene;
    // As in the programs that this is compared with: one division, three products.
    const glm::dvec3 gaze = camera.target - camera.eye;
    const glm::dvec3 forward = (1.0 / glm::length(gaze)) * gaze;
    return repeat(scene,
                  {options.repeat, options.repeat_gap * radius * forward, options.farthest_first});
}

/// The same camera, near and far fitted to what the scene has become.
Result<Camera> refit(const Camera& camera, CameraOptions chosen, const Scene& scene) {
    chosen.eye = camera.eye;
    chosen.target = camera.target;
    chosen.direction = std::nullopt;
    chosen.view = std::nullopt;
    if (!camera.is_perspective()) {
        chosen.ortho_height = camera.view_height * chosen.zoom.value_or(1);
    }
    return make_camera(chosen, scene, camera.resolution);
}

}  // namespace

Result<BenchScene> prepare_bench(const BenchOptions& options, Progress& progress) {
    BenchScene bench;
    Stopwatch watch;
    progress.stage("loading");
    Result<Scene> loaded = load(options);
    if (!loaded) return loaded.error();
    Notes(options.common.quiet, progress).warn_of_files(*loaded);
    if (!loaded->motions.empty()) *loaded = posed(*loaded, 0);
    if (!options.algorithm->quadrics) {
        tessellate_for(fmt::format("'{}' takes triangles only", options.algorithm->name), *loaded,
                       options.common.quiet, progress);
    }
    bench.load_ms = watch.lap();

    // The camera is chosen before the model grows; near and far are fitted afterwards.
    progress.stage("preparing");
    const CameraOptions own = relative_to(merge_cameras(*loaded, options.camera), loaded->offset);
    bench.own_camera = !says_nothing(own);
    const CameraOptions chosen = camera_options(own, loaded->bounds);
    auto camera = make_camera(chosen, *loaded, options.resolution);
    if (!camera) return camera.error();
    Result<Scene> scene = grow(options, std::move(*loaded), *camera);
    if (!scene) return scene.error();
    if (options.subdivide > 0 || options.repeat > 1) {
        camera = refit(*camera, chosen, *scene);
        if (!camera) return camera.error();
    }
    bench.scene = std::move(*scene);
    bench.camera = *camera;
    bench.prepare_ms = watch.lap();
    if (options.algorithm->name == kTreeAlgorithm) {
        progress.stage("building the tree");
        auto tree = build_bsp(bench.scene, {options.common.threads, {}});
        if (!tree) return tree.error();
        bench.tree = std::move(*tree);
        bench.tree_ms = watch.lap();
    }
    return bench;
}

Result<FrameTimes> time_frames(const BenchOptions& options, const BenchScene& bench,
                               Progress& progress, ScreenScene& screen, Visibility& visibility) {
    FrameTimes times;
    ResolveOptions resolving{1, options.common.threads};
    resolving.tree = bench.tree ? &*bench.tree : nullptr;
    for (unsigned i = 0; i < kWarmUps + options.frames; ++i) {
        progress.stage("frame", i + 1, kWarmUps + options.frames);
        Stopwatch watch;
        const Status projected =
            project(bench.scene, bench.camera, {options.cull, options.common.threads}, screen);
        if (!projected) return projected.error();
        const double project_ms = watch.lap();
        const Status done = resolve(*options.algorithm, screen, resolving, visibility);
        if (!done) return done.error();
        const double resolve_ms = watch.lap();
        double order_ms = 0;
        if (options.algorithm->order != nullptr) {
            const auto stop_at_once = [](const OrderedPiece&) { return false; };
            const Status ordered =
                for_each_back_to_front(*options.algorithm, screen, resolving, stop_at_once);
            if (!ordered) return ordered.error();
            order_ms = watch.lap();
        }
        if (i < kWarmUps) continue;
        times.order.push_back(order_ms);
        times.project.push_back(project_ms);
        times.resolve.push_back(resolve_ms);
        times.frame.push_back(project_ms + resolve_ms);
    }
    return times;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

double depth_complexity(const ScreenScene& screen) {
    double doubled = 0;  // in units of the screen's grid, squared
    for (std::uint32_t k = 0; k < screen.triangle_count(); ++k) {
        if (!screen.drawable(k)) continue;
        const Corners c = screen.corners(k);
        const ScreenPoint a = screen.point(c.x), b = screen.point(c.y), d = screen.point(c.z);
        const std::int64_t ux = b.x - a.x, uy = b.y - a.y, vx = d.x - a.x, vy = d.y - a.y;
        doubled += std::abs(static_cast<double>(ux * vy - uy * vx));
    }
    const double unit = std::ldexp(1.0, -screen.subpixel_bits());
    const Resolution size = screen.resolution();
    return 0.5 * doubled * unit * unit / (double{1} * size.width * size.height);
}

std::string mesh_name(const BenchOptions& options) {
    if (options.models.paths.empty()) return fmt::format("random-{}", options.generate);
    std::vector<std::string> names;
    for (const std::string& path : options.models.paths) {
        names.push_back(std::filesystem::path(path).filename().string());
    }
    return fmt::format("{}", fmt::join(names, "+"));
}

std::string size_name(Resolution resolution) {
    return fmt::format("{}x{}", resolution.width, resolution.height);
}

int thread_count(const CommonOptions& common) {
    return common.threads > 0 ? common.threads : all_threads();
}

}  // namespace sightline::cli
