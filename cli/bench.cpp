// `sightline bench`: how long each stage takes, on the triangles and the camera that other
// programs are measured on (the keys of --json are theirs).
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <glm/geometric.hpp>

#include "errors.hpp"
#include "options.hpp"
#include "outputs.hpp"
#include "progress.hpp"
#include "report.hpp"
#include "sightline/generate.hpp"
#include "sightline/sightline.hpp"

namespace sightline::cli {
namespace {

constexpr unsigned kWarmUps = 3;
constexpr unsigned kDefaultFrames = 15;
constexpr std::uint32_t kDefaultTriangles = 100000;  // of a generated scene
constexpr Resolution kDefaultResolution{1920, 1080};

struct BenchOptions {
    CommonOptions common;
    Models models;
    CameraOptions camera;
    Resolution resolution;
    const Algorithm* algorithm = nullptr;
    Cull cull = Cull::none;
    unsigned frames = kDefaultFrames;
    std::uint32_t generate = kDefaultTriangles;
    int subdivide = 0;
    std::uint32_t repeat = 1;
    double repeat_gap = 0.25;
    bool farthest_first = false;
};

Result<BenchOptions> read_options(const Arguments& arguments) {
    OptionReader reader(arguments);
    BenchOptions options;
    options.models = read_models(reader, false);
    options.camera = read_camera(reader);
    options.resolution = read_resolution(reader, kDefaultResolution);
    const auto chosen = reader.algorithms("--algorithm");
    if (chosen.size() > 1) reader.fail(wrong_use("--algorithm: give one at a time"));
    options.algorithm = chosen.empty() ? &default_algorithm() : chosen.front();
    options.cull = read_cull(reader, Cull::none);
    const auto count = [&](std::string_view option, std::uint64_t low, std::uint64_t high,
                           std::uint64_t fallback) {
        return reader
            .count(option, low, high, fmt::format("a whole number from {} to {}", low, high))
            .value_or(fallback);
    };
    options.frames = static_cast<unsigned>(count("--frames", 1, 100000, options.frames));
    options.generate = static_cast<std::uint32_t>(
        count("--generate", 1, kMaxGeneratedTriangles, options.generate));
    options.subdivide = static_cast<int>(count("--subdivide", 0, 15, 0));
    options.repeat = static_cast<std::uint32_t>(count("--repeat", 1, 1000000, 1));
    options.repeat_gap =
        reader.number("--repeat-gap", {-1e6, 1e6}, "a distance in bounding radii").value_or(0.25);
    options.farthest_first = arguments.has("--farthest-first");
    if (arguments.has("--generate") && !options.models.paths.empty()) {
        reader.fail(wrong_use("--generate stands in for a model, but '{}' is given; leave one away",
                              options.models.paths.front()));
    }
    options.common = read_common(reader);
    if (reader.error()) return *reader.error();
    return options;
}

/// The camera of the benchmarks, changed by what the scene file and the command line say.
CameraOptions camera_options(const BenchOptions& options, const Scene& scene) {
    const CameraOptions own = merge_cameras(scene.camera.value_or(CameraOptions{}), options.camera);
    CameraOptions base = bench_camera(scene.bounds);
    // Another gaze brings its own fit.
    if (own.direction || own.view) base.eye = base.target = std::nullopt;
    return merge_cameras(base, own);
}

Result<Scene> load(const BenchOptions& options) {
    if (options.models.paths.empty()) return random_triangles(options.generate);
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

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

struct Timing {
    double load = 0, prepare = 0, shade = 0, write = 0;
    std::vector<double> project, resolve, frame;
};

/// Project and resolve, again and again; keeps the last answer in memory.
Result<ScreenScene> time_frames(const BenchOptions& options, const Scene& scene,
                                const Camera& camera, Timing& timing, Visibility& visibility,
                                Progress& progress) {
    Result<ScreenScene> screen = ScreenScene{};
    for (unsigned i = 0; i < kWarmUps + options.frames; ++i) {
        progress.stage("frame", i + 1, kWarmUps + options.frames);
        Stopwatch watch;
        const Status projected =
            project(scene, camera, {options.cull, options.common.threads}, *screen);
        if (!projected) return projected.error();
        const double project_ms = watch.lap();
        const Status done =
            resolve(*options.algorithm, *screen, {1, options.common.threads}, visibility);
        if (!done) return done.error();
        const double resolve_ms = watch.lap();
        if (i < kWarmUps) continue;
        timing.project.push_back(project_ms);
        timing.resolve.push_back(resolve_ms);
        timing.frame.push_back(project_ms + resolve_ms);
    }
    return screen;
}

/// Shades the frame once and writes it as a PNG that is thrown away.
Status time_picture(const BenchOptions& options, const ScreenScene& screen,
                    const Visibility& visibility, Timing& timing) {
    Stopwatch watch;
    const ColorImage picture =
        shade(screen, visibility, {Shading::flat, glm::vec4(1), options.common.threads});
    timing.shade = watch.lap();
    const TemporaryFile file(std::filesystem::temp_directory_path(), "bench.png");
    Status done = write_color_png(file.path(), picture);
    timing.write = watch.lap();
    return done;
}

std::string mesh_name(const BenchOptions& options) {
    if (options.models.paths.empty()) return fmt::format("random-{}", options.generate);
    std::vector<std::string> names;
    for (const std::string& path : options.models.paths) {
        names.push_back(std::filesystem::path(path).filename().string());
    }
    return fmt::format("{}", fmt::join(names, "+"));
}

std::vector<Row> report_rows(const BenchOptions& options, const Scene& scene,
                             const Timing& timing) {
    const double mid = median(timing.frame), tris = scene.triangle_count();
    const double pixels = double{1} * options.resolution.width * options.resolution.height;
    const int threads = options.common.threads > 0 ? options.common.threads : all_threads();
    return {
        {"mesh", "mesh", mesh_name(options), ""},
        {"triangles", "triangles", scene.triangle_count(), ""},
        {"vertices", "vertices", std::uint64_t{scene.positions.size()}, ""},
        {"size", "size", fmt::format("{}x{}", options.resolution.width, options.resolution.height),
         ""},
        {"algorithm", "algorithm", options.algorithm->name, ""},
        {"cull", "cull", name_of(options.cull), ""},
        {"subdivide", "subdivide", options.subdivide, ""},
        {"repeat", "repeat", options.repeat, ""},
        {"threads", "threads", threads, ""},
        {"frames", "frames", options.frames, ""},
        {"load_ms", "load", milliseconds(timing.load), "ms"},
        {"prepare_ms", "prepare", milliseconds(timing.prepare), "ms"},
        {"setup_ms", "set-up (= prepare)", milliseconds(timing.prepare), "ms"},
        {"project_ms", "project (median)", milliseconds(median(timing.project)), "ms"},
        {"resolve_ms", "resolve (median)", milliseconds(median(timing.resolve)), "ms"},
        {"frame_ms_min", "frame, shortest",
         milliseconds(*std::min_element(timing.frame.begin(), timing.frame.end())), "ms"},
        {"frame_ms_median", "frame, median", milliseconds(mid), "ms"},
        {"shade_ms", "shade", milliseconds(timing.shade), "ms"},
        {"write_ms", "write", milliseconds(timing.write), "ms"},
        {"mtris_per_s", "triangles", tris / mid / 1e3, "million/s"},
        {"mpix_per_s", "pixels", pixels / mid / 1e3, "million/s"},
        {"peak_rss_mb", "peak memory", peak_memory_mib(), "MiB"},
    };
}

Result<int> run(const Arguments& arguments) {
    const Result<BenchOptions> parsed = read_options(arguments);
    if (!parsed) return parsed.error();
    const BenchOptions& options = *parsed;
    Progress progress(options.common.quiet);
    Stopwatch watch;
    Timing timing;
    progress.stage("loading");
    Result<Scene> loaded = load(options);
    if (!loaded) return loaded.error();
    timing.load = watch.lap();

    // The camera is chosen before the model grows; near and far are fitted afterwards.
    progress.stage("preparing");
    CameraOptions chosen = camera_options(options, *loaded);
    auto camera = make_camera(chosen, loaded->bounds, options.resolution);
    if (!camera) return camera.error();
    const Result<Scene> scene = grow(options, std::move(*loaded), *camera);
    if (!scene) return scene.error();
    if (options.subdivide > 0 || options.repeat > 1) {
        chosen.eye = camera->eye;
        chosen.target = camera->target;
        chosen.direction = std::nullopt;
        chosen.view = std::nullopt;
        if (!camera->is_perspective()) {
            chosen.ortho_height = camera->view_height * chosen.zoom.value_or(1);
        }
        camera = make_camera(chosen, scene->bounds, options.resolution);
        if (!camera) return camera.error();
    }
    timing.prepare = watch.lap();

    Visibility visibility;
    const auto screen = time_frames(options, *scene, *camera, timing, visibility, progress);
    if (!screen) return screen.error();
    progress.stage("shading and writing");
    if (Status done = time_picture(options, *screen, visibility, timing); !done)
        return done.error();
    progress.clear();
    const auto rows = report_rows(options, *scene, timing);
    if (options.common.stats) fmt::print(stderr, "{}", to_table(rows));
    Status done = print(options.common.json ? to_json(to_object(rows)) + "\n" : to_table(rows));
    if (!done) return done.error();
    return 0;
}

const std::array kBenchRows = {
    Option{"--frames", "N", "timed frames, after 3 to warm up (default: 15)"},
    Option{"--algorithm", "NAME", "which algorithm (default: zbuffer)"},
    Option{"--cull", "auto|none|back|front", "which sides to leave out (default: none)"},
    Option{"--subdivide", "K", "split every triangle into four, K times"},
    Option{"--repeat", "N", "N copies behind one another"},
    Option{"--repeat-gap", "G", "their distance, in bounding radii (default: 0.25)"},
    Option{"--farthest-first", "", "the farthest copy comes first"},
    Option{"--generate", "N", "without a MODEL: this many random triangles (default: 100000)"},
};

const std::array kGroups = {
    OptionGroup{"Benchmark", kBenchRows}, OptionGroup{"Camera", kCameraOptions},
    OptionGroup{"Input", kModelOptions}, OptionGroup{"Common", kCommonOptions}};

constexpr std::array kExamples = {
    Example{"sightline bench bunny.obj --json", "1920x1080, 15 frames"},
    Example{"sightline bench bunny.obj --subdivide 2 --threads 1", "16 times the triangles"},
    Example{"sightline bench --generate 1000000", "a million random triangles"},
};

}  // namespace

const Command kBench = {
    "bench",
    "timings of every stage on chosen or generated scenes",
    "[MODEL...]",
    "Times loading, preparing (subdividing, repeating), frames (project and resolve: ids and "
    "depth\n"
    "in memory), shading and writing. Default camera: the centre of the model's box seen from\n"
    "(1, 0.6, 1.2), 2.2 bounding radii away, --fov 40, at 1920x1080.",
    kGroups,
    kExamples,
    run};

}  // namespace sightline::cli
