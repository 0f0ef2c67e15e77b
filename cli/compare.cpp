// `sightline compare`: every algorithm on one view, against the canonical answer.
#include <algorithm>
#include <array>
#include <bit>

#include "affordable.hpp"
#include "errors.hpp"
#include "options.hpp"
#include "outputs.hpp"
#include "progress.hpp"
#include "report.hpp"
#include "sightline/sightline.hpp"
#include "streams.hpp"
#include "tessellate.hpp"
#include "view_notes.hpp"

namespace sightline::cli {
namespace {

constexpr std::array kDifferenceFormats = {ImageFormat::png};
constexpr std::string_view kOracle = "brute";
constexpr std::string_view kExactCounter = "exact comparisons";

struct CompareOptions {
    CommonOptions common;
    Models models;
    CameraOptions camera;
    Resolution resolution;
    Cull cull = Cull::automatic;
    std::vector<const Algorithm*> named;  ///< empty: all
    std::optional<Output> difference;
};

/// What one algorithm did.
struct Run {
    const Algorithm* algorithm = nullptr;
    std::uint64_t differ = 0, samples = 0, exact = 0;
    double ms = 0, peak_mib = 0;
    std::vector<Counter> counts;
};

Result<CompareOptions> read_options(const Arguments& arguments) {
    OptionReader reader(arguments);
    CompareOptions options;
    options.models = read_models(reader);
    options.camera = read_camera(reader);
    options.resolution = read_resolution(reader, Resolution{});
    options.cull = read_cull(reader, Cull::automatic);
    options.named = reader.algorithms("--algorithms");
    options.difference = read_output<ImageFormat>(reader, "--difference", kDifferenceFormats);
    if (options.difference) {
        check_outputs(reader, {&*options.difference, 1}, options.models.paths);
        check_report(reader, {&options.difference->path, 1});
        options.models.options.outputs.push_back(options.difference->path);
    }
    if (options.difference && options.difference->path == "-") {
        reader.fail(wrong_use("--difference: standard output holds the table; name a file"));
    }
    options.common = read_common(reader);
    if (reader.error()) return *reader.error();
    return options;
}

/// The algorithms that get a row.
std::vector<const Algorithm*> choose(const CompareOptions& options, const ScreenScene& screen) {
    if (!options.named.empty()) return options.named;
    std::vector<const Algorithm*> chosen;
    for (const Algorithm& algorithm : algorithms()) {
        if (is_affordable(algorithm, screen)) chosen.push_back(&algorithm);
    }
    return chosen;
}

/// The oracle where the work allows it or it is named, else the first exact one, else the default.
const Algorithm& choose_reference(const std::vector<const Algorithm*>& chosen,
                                  const ScreenScene& screen) {
    const Algorithm* oracle = find_algorithm(kOracle);
    const bool named = std::find(chosen.begin(), chosen.end(), oracle) != chosen.end();
    if (oracle != nullptr && (named || is_affordable(*oracle, screen))) return *oracle;
    const auto exact = std::find_if(chosen.begin(), chosen.end(),
                                    [](const Algorithm* algorithm) { return algorithm->exact; });
    return exact != chosen.end() ? **exact : default_algorithm();
}

Result<Run> measure(const Algorithm& algorithm, const ScreenScene& screen, int threads,
                    Visibility& out) {
    std::vector<Counter> counters;
    reset_peak_memory();
    const Stopwatch watch;
    if (Status done = resolve(algorithm, screen, {1, threads, nullptr, &counters}, out); !done) {
        return done.error();
    }
    Run run;
    run.algorithm = &algorithm;
    run.ms = watch.ms();
    run.peak_mib = peak_memory_mib();
    run.samples = out.ids.size();
    for (const Counter& counter : counters) {
        if (counter.name == kExactCounter) run.exact += counter.value;
    }
    run.counts = std::move(counters);
    return run;
}

bool differs(const Visibility& a, const Visibility& b, std::size_t i) {
    return a.ids[i] != b.ids[i] ||
           std::bit_cast<std::uint32_t>(a.depth[i]) != std::bit_cast<std::uint32_t>(b.depth[i]);
}

/// Counts the samples that differ, and marks them.
std::uint64_t count_differences(const Visibility& reference, const Visibility& other,
                                std::vector<std::uint8_t>& marks) {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < reference.ids.size(); ++i) {
        if (!differs(reference, other, i)) continue;
        marks[i] = 1;
        ++count;
    }
    return count;
}

/// White background, grey model, red where an algorithm differs.
ColorImage difference_picture(const Visibility& reference, const std::vector<std::uint8_t>& marks) {
    const Resolution size = reference.grid.resolution;
    ColorImage picture(size.width, size.height, glm::vec4(1));
    for (std::size_t i = 0; i < marks.size(); ++i) {
        if (reference.ids[i] != kNone) picture.pixels[i] = {0.5f, 0.5f, 0.5f, 1};
        if (marks[i] != 0) picture.pixels[i] = {1, 0, 0, 1};
    }
    return picture;
}

struct Comparison {
    const Algorithm* reference = nullptr;
    std::vector<Run> rows;
    Visibility canonical;
    std::vector<std::uint8_t> marks;
};

Result<Comparison> compare(const CompareOptions& options, const ScreenScene& screen,
                           Progress& progress) {
    const auto chosen = choose(options, screen);
    Comparison comparison;
    comparison.reference = &choose_reference(chosen, screen);
    progress.stage(comparison.reference->name);
    const int threads = options.common.threads;
    auto first = measure(*comparison.reference, screen, threads, comparison.canonical);
    if (!first) return first.error();
    comparison.marks.assign(comparison.canonical.ids.size(), 0);
    for (const Algorithm* algorithm : chosen) {
        if (algorithm == comparison.reference) {
            comparison.rows.push_back(*first);
            continue;
        }
        progress.stage(algorithm->name);
        Visibility answer;
        auto run = measure(*algorithm, screen, threads, answer);
        if (!run) return run.error();
        run->differ = count_differences(comparison.canonical, answer, comparison.marks);
        comparison.rows.push_back(*run);
    }
    return comparison;
}

std::string as_json(const Comparison& comparison) {
    Value::List rows;
    for (const Run& run : comparison.rows) {
        Value::Object counts;
        for (const Counter& counter : run.counts) {
            std::string key = counter.name;
            std::replace(key.begin(), key.end(), ' ', '_');
            counts.emplace_back(key, counter.value);
        }
        rows.emplace_back(Value::Object{{"algorithm", run.algorithm->name},
                                        {"differ", run.differ},
                                        {"samples", run.samples},
                                        {"ms", milliseconds(run.ms)},
                                        {"peak_mib", milliseconds(run.peak_mib)},
                                        {"exact", run.exact},
                                        {"counts", counts}});
    }
    return to_json(Value::Object{{"reference", comparison.reference->name}, {"rows", rows}}) + "\n";
}

std::string as_text(const Comparison& comparison) {
    std::vector<std::vector<std::string>> rows = {
        {"algorithm", "differ", "samples", "ms", "peak MiB", "exact"}};
    for (const Run& run : comparison.rows) {
        rows.push_back({std::string(run.algorithm->name), fmt::to_string(run.differ),
                        fmt::to_string(run.samples), fmt::format("{:.2f}", run.ms),
                        fmt::format("{:.1f}", run.peak_mib), fmt::to_string(run.exact)});
    }
    return fmt::format("reference: {}\n{}", comparison.reference->name, to_grid(rows));
}

/// What each algorithm counted, for --stats.
std::string counts_as_text(const Comparison& comparison) {
    std::vector<std::vector<std::string>> rows;
    for (const Run& run : comparison.rows) {
        for (const Counter& counter : run.counts) {
            rows.push_back(
                {std::string(run.algorithm->name), counter.name, fmt::to_string(counter.value)});
        }
    }
    return to_grid(rows);
}

/// 1 when an algorithm broke its promise, 0 otherwise.
int judge(const Comparison& comparison) {
    int status = 0;
    for (const Run& run : comparison.rows) {
        if (run.differ == 0 || !run.algorithm->exact) continue;
        tell_line(
            "'{}' promises exactness but differs from '{}' in {} of {} samples; --difference "
            "FILE.png shows where",
            run.algorithm->name, comparison.reference->name, run.differ, run.samples);
        status = 1;
    }
    return status;
}

/// Warns of what a view hides from its user.
void warn(const Notes& notes, const Arguments& arguments, const CompareOptions& options,
          const ScreenScene& screen, const Comparison& comparison) {
    notes.warn_of_files(screen.scene());
    notes.warn_of_options(arguments, idle_camera_options({{screen.camera().projection}}));
    ViewNotes view;
    view.add({subject_of(screen.scene()), merge_cameras(screen.scene(), options.camera),
              screen.camera(), screen.counts(), !sees_anything(comparison.canonical)});
    view.print(notes, "the picture is blank");
}

Result<int> run(const Arguments& arguments) {
    const Result<CompareOptions> options = read_options(arguments);
    if (!options) return options.error();
    Progress progress(options->common.quiet);
    Stopwatch watch;
    progress.stage("loading");
    Result<Scene> scene = load_scene(options->models.paths, options->models.options);
    if (!scene) return scene.error();
    if (!scene->motions.empty()) *scene = posed(*scene, 0);
    tessellate_for("compared on triangles", *scene, options->common.quiet, progress);
    const double load_ms = watch.lap();
    const auto camera = camera_for(*scene, options->camera, options->resolution);
    if (!camera) return camera.error();
    const auto screen = project(*scene, *camera, {options->cull, options->common.threads});
    if (!screen) return screen.error();
    const double project_ms = watch.lap();
    const auto comparison = compare(*options, *screen, progress);
    if (!comparison) return comparison.error();
    warn(Notes(options->common.quiet, progress), arguments, *options, *screen, *comparison);
    if (options->difference) {
        const auto picture = difference_picture(comparison->canonical, comparison->marks);
        if (Status done = write_color_png(options->difference->path, picture); !done) {
            return done.error();
        }
    }
    progress.clear();
    if (options->common.stats) {
        tell(to_table({{"", "load", milliseconds(load_ms), "ms"},
                       {"", "project", milliseconds(project_ms), "ms"},
                       {"", "triangles", scene->triangle_count(), ""}}));
        tell(counts_as_text(*comparison));
    }
    const auto text = options->common.json ? as_json : as_text;
    if (Status done = print(text(*comparison)); !done) return done.error();
    return judge(*comparison);
}

const std::array kCompareRows = {
    Option{"--algorithms", "LIST",
           "which to compare, as in zbuffer,brute (default: all that the work allows)"},
    Option{"--difference", "FILE.png", "a picture with every sample that differs in red"},
    kCullOption,
};

const std::array kGroups = {
    OptionGroup{"Comparison", kCompareRows}, OptionGroup{"Camera", kCameraOptions},
    OptionGroup{"Input", kModelOptions}, OptionGroup{"Common", kCommonOptions}};

constexpr std::array kExamples = {
    Example{"sightline compare teapot.obj --resolution 320x240", "all algorithms"},
    Example{"sightline compare cow.obj --algorithms zbuffer,brute --view front --json",
            "two of them, for programs"},
};

}  // namespace

const Command kCompare = {
    "compare",
    "every algorithm on the same view: agreement, time, memory",
    "MODEL...",
    "Counts the samples (at the pixels' centres) whose triangle or depth differs from the\n"
    "reference: 'brute' up to 2^38 samples times triangles or when it is named, else the first\n"
    "exact algorithm. Surfaces that are not polygons are tessellated for all. Exit status 1 when "
    "an algorithm that promises exactness differs.",
    kGroups,
    kExamples,
    run};

}  // namespace sightline::cli
