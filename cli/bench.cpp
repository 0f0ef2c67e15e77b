// `sightline bench`: how long each stage takes, on the triangles and the camera that other
// programs are measured on (the keys of --json are theirs); the comparison with those programs
// (bench_peers.hpp) and the table of growing scenes (bench_table.hpp).
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "bench_peers.hpp"
#include "bench_scene.hpp"
#include "bench_table.hpp"
#include "errors.hpp"
#include "options.hpp"
#include "outputs.hpp"
#include "progress.hpp"
#include "report.hpp"
#include "sightline/generate.hpp"
#include "sightline/sightline.hpp"
#include "streams.hpp"
#include "view_notes.hpp"

namespace sightline::cli {
namespace {

constexpr unsigned kDefaultFrames = 15, kDefaultTableFrames = 5;
constexpr std::uint32_t kDefaultTriangles = 100000;  // of a generated scene
constexpr double kDefaultComplexity = 4;
constexpr Resolution kDefaultResolution{1920, 1080};

/// What is asked for: with neither peers nor a table, the stages one by one.
struct Job {
    BenchOptions bench;
    std::optional<PeersOptions> peers;
    std::optional<TableOptions> table;
};

void read_growth(OptionReader& reader, BenchOptions& options) {
    const auto count = [&](std::string_view option, std::uint64_t low, std::uint64_t high,
                           std::uint64_t fallback) {
        return reader
            .count(option, low, high, fmt::format("a whole number from {} to {}", low, high))
            .value_or(fallback);
    };
    const bool table = reader.arguments().has("--table");
    options.frames = static_cast<unsigned>(
        count("--frames", 1, 100000, table ? kDefaultTableFrames : kDefaultFrames));
    options.generate = static_cast<std::uint32_t>(
        count("--generate", 1, kMaxGeneratedTriangles, kDefaultTriangles));
    options.subdivide = static_cast<int>(count("--subdivide", 0, 15, 0));
    options.repeat = static_cast<std::uint32_t>(count("--repeat", 1, 1000000, 1));
    options.repeat_gap =
        reader.number("--repeat-gap", {-1e6, 1e6}, "a distance in bounding radii").value_or(0.25);
    options.farthest_first = reader.arguments().has("--farthest-first");
    options.complexity = reader
                             .number("--complexity", {0, 1e6, true},
                                     "a mean number of triangles above 0, as in --complexity 4")
                             .value_or(kDefaultComplexity);
}

Result<Job> read_options(const Arguments& arguments) {
    OptionReader reader(arguments);
    Job job;
    BenchOptions& options = job.bench;
    options.models = read_models(reader, false);
    options.camera = read_camera(reader);
    options.resolution = read_resolution(reader, kDefaultResolution);
    const auto chosen = reader.algorithms("--algorithm");
    if (chosen.size() > 1) reader.fail(wrong_use("--algorithm: give one at a time"));
    options.algorithm = chosen.empty() ? &default_algorithm() : chosen.front();
    options.cull = read_cull(reader, Cull::none);
    read_growth(reader, options);
    for (const std::string_view option : {"--generate", "--complexity"}) {
        if (!arguments.has(option) || options.models.paths.empty()) continue;
        reader.fail(wrong_use("{} is for generated scenes, but '{}' is given; leave one away",
                              option, options.models.paths.front()));
    }
    job.table = read_table(reader);
    if (!job.table) job.peers = read_peers(reader, options);
    options.common = read_common(reader);
    if (reader.error()) return *reader.error();
    if (job.table) {
        job.table->common = options.common;
        job.table->resolution = options.resolution;
        job.table->frames = options.frames;
        job.table->complexity = options.complexity;
    }
    return job;
}

struct OtherTimes {
    double shade_ms = 0, write_ms = 0;
};

/// Shades the frame once and writes it as a PNG that is thrown away.
Result<OtherTimes> time_picture(const BenchOptions& options, const ScreenScene& screen,
                                const Visibility& visibility) {
    OtherTimes times;
    Stopwatch watch;
    const ColorImage picture =
        shade(screen, visibility, {Shading::flat, glm::vec4(1), options.common.threads});
    times.shade_ms = watch.lap();
    std::error_code missing;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(missing);
    if (missing) {
        return failure(
            "TMPDIR: the folder '{}' for temporary files can't be used: {}; set it to a "
            "folder that exists",
            std::getenv("TMPDIR") != nullptr ? std::getenv("TMPDIR") : "/tmp", missing.message());
    }
    const TemporaryFile file(folder.string());
    if (Status done = write_color_png(file.path(), picture); !done) return done.error();
    times.write_ms = watch.lap();
    return times;
}

std::vector<Row> report_rows(const BenchOptions& options, const BenchScene& bench,
                             const ScreenScene& screen, const FrameTimes& times,
                             const OtherTimes& others) {
    const double mid = median(times.frame), tris = bench.scene.triangle_count();
    const double pixels = double{1} * options.resolution.width * options.resolution.height;
    std::vector<Row> rows = {
        {"mesh", "mesh", mesh_name(options), ""},
        {"triangles", "triangles", bench.scene.triangle_count(), ""},
        {"vertices", "vertices", std::uint64_t{bench.scene.positions.size()}, ""},
        {"size", "size", size_name(options.resolution), ""},
        {"depth_complexity", "depth complexity", depth_complexity(screen), ""},
        {"algorithm", "algorithm", options.algorithm->name, ""},
        {"cull", "cull", name_of(options.cull), ""},
        {"subdivide", "subdivide", options.subdivide, ""},
        {"repeat", "repeat", options.repeat, ""},
        {"threads", "threads", thread_count(options.common), ""},
        {"frames", "frames", options.frames, ""},
        {"load_ms", "load", milliseconds(bench.load_ms), "ms"},
        {"prepare_ms", "prepare", milliseconds(bench.prepare_ms), "ms"},
        {"setup_ms", "set-up (= prepare)", milliseconds(bench.prepare_ms), "ms"},
        {"project_ms", "project (median)", milliseconds(median(times.project)), "ms"},
        {"resolve_ms", "resolve (median)", milliseconds(median(times.resolve)), "ms"},
        {"frame_ms_min", "frame, shortest",
         milliseconds(*std::min_element(times.frame.begin(), times.frame.end())), "ms"},
        {"frame_ms_median", "frame, median", milliseconds(mid), "ms"},
        {"shade_ms", "shade", milliseconds(others.shade_ms), "ms"},
        {"write_ms", "write", milliseconds(others.write_ms), "ms"},
        {"mtris_per_s", "triangles", tris / mid / 1e3, "million/s"},
        {"mpix_per_s", "pixels", pixels / mid / 1e3, "million/s"},
        {"peak_rss_mb", "peak memory", peak_memory_mib(), "MiB"},
    };
    if (bench.tree)
        rows.push_back({"tree_ms", "build the tree", milliseconds(bench.tree_ms), "ms"});
    if (options.algorithm->order != nullptr)
        rows.push_back(
            {"order_ms", "order alone (median)", milliseconds(median(times.order)), "ms"});
    return rows;
}

void warn_of_options(const Notes& notes, const Arguments& arguments, const BenchOptions& options,
                     Projection projection) {
    const bool single = options.repeat == 1;
    const IdleOption own[] = {{"--repeat-gap", single, "it is for --repeat 2 and more"},
                              {"--farthest-first", single, "it is for --repeat 2 and more"}};
    notes.warn_of_options(arguments, own);
    notes.warn_of_options(arguments, idle_camera_options({{projection}}));
}

Result<int> run_stages(const Arguments& arguments, const BenchOptions& options) {
    Progress progress(options.common.quiet);
    const auto bench = prepare_bench(options, progress);
    if (!bench) return bench.error();
    ScreenScene screen;
    Visibility visibility;
    const auto times = time_frames(options, *bench, progress, screen, visibility);
    if (!times) return times.error();
    progress.stage("shading and writing");
    const auto others = time_picture(options, screen, visibility);
    if (!others) return others.error();
    progress.clear();
    const Notes notes(options.common.quiet, progress);
    warn_of_options(notes, arguments, options, bench->camera.projection);
    ViewNotes view;
    view.add({subject_of(bench->scene), merge_cameras(bench->scene, options.camera), bench->camera,
              screen.counts(), !sees_anything(visibility)});
    view.print(notes, "the picture is blank");
    const auto rows = report_rows(options, *bench, screen, *times, *others);
    if (options.common.stats) tell(to_table(rows));
    Status done = print(options.common.json ? to_json(to_object(rows)) + "\n" : to_table(rows));
    if (!done) return done.error();
    return 0;
}

Result<int> run(const Arguments& arguments) {
    const Result<Job> job = read_options(arguments);
    if (!job) return job.error();
    if (job->table) return run_table(*job->table);
    if (job->peers) return run_peers(*job->peers, job->bench);
    return run_stages(arguments, job->bench);
}

const std::array kBenchRows = {
    Option{"--frames", "N", "timed frames, after 3 to warm up (default: 15, with --table 5)"},
    Option{"--algorithm", "NAME", "which algorithm (default: zbuffer)"},
    Option{"--cull", "auto|none|back|front", "which sides to leave out (default: none)"},
    Option{"--subdivide", "K", "split every triangle into four, K times"},
    Option{"--repeat", "N", "N copies behind one another"},
    Option{"--repeat-gap", "G", "their distance, in bounding radii (default: 0.25)"},
    Option{"--farthest-first", "", "the farthest copy comes first"},
    Option{"--generate", "N", "without a MODEL: this many random triangles (default: 100000)"},
    Option{"--complexity", "D", "depth complexity of generated scenes (default: 4)"},
};

const std::array kPeersRows = {
    Option{"--peers", "DIR",
           "run peer_llvmpipe, peer_embree and roofline of this folder, as far as they are there, "
           "in turn with our frames, and print the ratios"},
    Option{"--rounds", "N", "how often each (default: 5)"},
    Option{"--peer-limit", "SECONDS", "longest time for one program (default: 300)"},
};

const std::array kTableRows = {
    Option{"--table", "",
           "every algorithm on generated scenes of constant depth complexity, beside the "
           "historical table"},
    Option{"--sizes", "LIST", "numbers of triangles (default: 100,2500,60000,1000000)"},
    Option{"--algorithms", "LIST", "which algorithms (default: all that the work allows)"},
    Option{"--output", "FILE.svg", "the table and a log-log plot", "-o"},
};

const std::array kGroups = {
    OptionGroup{"Benchmark", kBenchRows}, OptionGroup{"Peers", kPeersRows},
    OptionGroup{"Table", kTableRows},     OptionGroup{"Camera", kCameraOptions},
    OptionGroup{"Input", kModelOptions},  OptionGroup{"Common", kCommonOptions}};

constexpr std::array kExamples = {
    Example{"sightline bench bunny.obj --json", "1920x1080, 15 frames"},
    Example{"sightline bench bunny.obj --subdivide 2 --threads 1", "16 times the triangles"},
    Example{"sightline bench --generate 1000000", "a million random triangles"},
    Example{"sightline bench bunny.obj --peers peers/build --subdivide 2",
            "how much faster than the peers' programs"},
    Example{"sightline bench --table -o table.svg", "how every algorithm's time grows"},
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
