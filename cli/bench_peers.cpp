// Rounds of our frames and the peers' programs, interleaved, so that a machine that becomes slower
// or faster meanwhile does so for all. Each program is a process of its own that loads the model,
// makes the same triangles and the same camera from the same options, times its frames, and prints
// one JSON object; the ratio is taken within a round. What a program prints is not trusted.
#include "bench_peers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <numbers>

#include "bench_child.hpp"
#include "errors.hpp"
#include "report.hpp"
#include "streams.hpp"

namespace sightline::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 3> kPrograms = {"peer_llvmpipe", "peer_embree", "roofline"};
constexpr std::string_view kOurs = "sightline";

/// One line of the report: a program, and its milliseconds in every round.
struct Series {
    std::string name, renderer;
    std::vector<double> ms;
};

/// What one run of a program said.
struct PeerFrame {
    double frame_ms = 0;
    std::optional<double> build_ms;  ///< of its acceleration structure, where it has one
    std::string renderer;
};

// -- what the programs are told ----------------------------------------------------------------

std::string point(glm::dvec3 p) { return fmt::format("{},{},{}", p.x, p.y, p.z); }

void append_camera(std::vector<std::string>& words, const BenchOptions& options,
                   const Camera& camera, glm::dvec3 offset) {
    words.push_back("--eye=" + point(camera.eye + offset));
    words.push_back("--target=" + point(camera.target + offset));
    words.push_back("--up=" + point(camera.up));
    if (camera.is_perspective()) {
        // With --zoom the angle is not that of --fov.
        const double fov = options.camera.zoom
                               ? 360 / std::numbers::pi * std::atan(0.5 * camera.view_height)
                               : camera.fov;
        words.push_back(fmt::format("--fov={}", fov));
    } else {
        words.push_back(fmt::format("--ortho={}", camera.view_height));
    }
    if (options.camera.near_plane) words.push_back(fmt::format("--near={}", camera.near_plane));
    if (options.camera.far_plane) words.push_back(fmt::format("--far={}", camera.far_plane));
}

std::vector<std::string> command_line(const std::string& program, const BenchOptions& options,
                                      const BenchScene& bench) {
    const std::string& model = options.models.paths.front();
    std::vector<std::string> words = {program, model.starts_with('-') ? "./" + model : model};
    const auto add = [&](std::string_view option, const auto& value) {
        words.push_back(fmt::format("--{}={}", option, value));
    };
    add("mode", "id");
    add("size", size_name(options.resolution));
    add("frames", options.frames);
    add("threads", thread_count(options.common));
    add("subdivide", options.subdivide);
    add("repeat", options.repeat);
    add("repeat-gap", options.repeat_gap);
    if (options.farthest_first) words.emplace_back("--farthest-first");
    if (options.cull == Cull::back) words.emplace_back("--cull");
    if (bench.own_camera) append_camera(words, options, bench.camera, bench.scene.offset);
    return words;
}

// -- what they answer --------------------------------------------------------------------------

template <class T>
const T* find(const Value::Object& object, std::string_view key) {
    for (const auto& [name, value] : object) {
        if (name == key) return std::get_if<T>(&value.data());
    }
    return nullptr;
}

/// The last line that is a JSON object.
std::optional<Value::Object> find_report(const std::string& out) {
    std::string_view rest = out;
    while (!rest.empty()) {
        const std::size_t end = rest.find_last_not_of("\r\n");
        if (end == std::string_view::npos) break;
        rest = rest.substr(0, end + 1);
        const std::size_t line = rest.rfind('\n') + 1;  // npos + 1 = 0
        if (rest[line] == '{') return parse_flat_json(rest.substr(line));
        rest = rest.substr(0, line);
    }
    return std::nullopt;
}

std::string with_excerpt(const ChildOutcome& outcome) {
    const std::string line = first_line(outcome.err.empty() ? outcome.out : outcome.err);
    return line.empty() ? "and printed nothing" : fmt::format("and printed '{}'", line);
}

/// How a program failed, as an error; nothing when it ended well.
std::optional<Error> judge(std::string_view name, const std::vector<std::string>& words,
                           const ChildOutcome& outcome, double limit) {
    const std::string way_out = fmt::format("try '{} {}' by itself", words[0], words[1]);
    if (outcome.late) {
        return failure("--peers: {} took longer than {:g} s; raise --peer-limit or give it less",
                       name, limit);
    }
    if (outcome.signal != 0) {
        return failure("--peers: {} was stopped by signal {} ({}) {}; {}", name, outcome.signal,
                       strsignal(outcome.signal), with_excerpt(outcome), way_out);
    }
    if (outcome.status != 0) {
        return failure("--peers: {} ended with status {} {}; {}", name, outcome.status,
                       with_excerpt(outcome), way_out);
    }
    return std::nullopt;
}

Result<PeerFrame> read_report(std::string_view name, const std::vector<std::string>& words,
                              const ChildOutcome& outcome, const BenchScene& bench) {
    const auto report = find_report(outcome.out);
    if (!report) {
        return failure(
            "--peers: {} ended well, but without a line of JSON, {}; try '{} {}' by "
            "itself, or build it again",
            name, with_excerpt(outcome), words[0], words[1]);
    }
    const double* ms = find<double>(*report, "frame_ms_median");
    const double* triangles = find<double>(*report, "triangles");
    if (ms == nullptr || triangles == nullptr || !std::isfinite(*ms) || *ms <= 0) {
        return failure(
            "--peers: the JSON of {} lacks a number 'triangles' or a 'frame_ms_median' "
            "above 0; build it again from the peers' raster folder",
            name);
    }
    if (*triangles != double{1} * bench.scene.triangle_count()) {
        return failure(
            "--peers: {} makes {:g} triangles of '{}', sightline {}; save the model as "
            "OBJ with triangles only, so that all read the same",
            name, *triangles, words[1], bench.scene.triangle_count());
    }
    PeerFrame frame;
    frame.frame_ms = *ms;
    const double* build = find<double>(*report, "build_ms_median");
    if (build != nullptr && std::isfinite(*build) && *build > 0) frame.build_ms = *build;
    if (const auto* renderer = find<std::string>(*report, "renderer")) {
        frame.renderer = first_line(*renderer);
    }
    return frame;
}

// -- rounds ------------------------------------------------------------------------------------

Result<std::vector<std::string>> find_programs(const std::string& folder) {
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) {
        return failure(
            "--peers: the folder '{}' does not exist; build the peers' raster programs "
            "and name the folder they are in",
            folder);
    }
    std::vector<std::string> found;
    for (const std::string_view name : kPrograms) {
        if (fs::is_regular_file(fs::path(folder) / name, ignored)) found.emplace_back(name);
    }
    if (!found.empty()) return found;
    return failure("--peers: none of {} is in '{}'; build the peers' raster programs there",
                   fmt::join(kPrograms, ", "), folder);
}

Result<PeerFrame> run_program(const PeersOptions& options, const BenchOptions& bench_options,
                              const BenchScene& bench, const std::string& name) {
    // An absolute path, so that a folder "-x" or "." is no option and no search in PATH.
    std::error_code ignored;
    const fs::path program = fs::absolute(fs::path(options.folder) / name, ignored);
    const auto words = command_line(program.lexically_normal().string(), bench_options, bench);
    const auto outcome = run_child(words, options.limit);
    if (!outcome) return outcome.error();
    if (auto error = judge(name, words, *outcome, options.limit)) return *error;
    return read_report(name, words, *outcome, bench);
}

Series& series_of(std::vector<Series>& all, const std::string& name) {
    for (Series& series : all) {
        if (series.name == name) return series;
    }
    return all.emplace_back(Series{name, "", {}});
}

Result<std::vector<Series>> run_rounds(const PeersOptions& options,
                                       const BenchOptions& bench_options, const BenchScene& bench,
                                       const std::vector<std::string>& programs,
                                       Progress& progress) {
    std::vector<Series> all;
    ScreenScene screen;
    Visibility visibility;
    for (unsigned round = 0; round < options.rounds; ++round) {
        const auto times = time_frames(bench_options, bench, progress, screen, visibility);
        if (!times) return times.error();
        series_of(all, std::string(kOurs)).ms.push_back(median(times->frame));
        for (const std::string& name : programs) {
            progress.stage(name + ", round", round + 1, options.rounds);
            const auto frame = run_program(options, bench_options, bench, name);
            if (!frame) return frame.error();
            Series& series = series_of(all, name);
            series.ms.push_back(frame->frame_ms);
            series.renderer = frame->renderer;
            // What is built before the first frame must be built again when the scene changes.
            if (!frame->build_ms) continue;
            series_of(all, name + " + build").ms.push_back(frame->frame_ms + *frame->build_ms);
        }
    }
    return all;
}

// -- report ------------------------------------------------------------------------------------

struct Spread {
    double min, median, max;
};

Spread spread(const std::vector<double>& values) {
    return {*std::min_element(values.begin(), values.end()), median(values),
            *std::max_element(values.begin(), values.end())};
}

/// Ratios to our frame of the same round.
std::vector<double> ratios(const Series& series, const Series& ours) {
    std::vector<double> result;
    // A program that did not tell its time of building in every round has fewer than we have.
    for (std::size_t i = 0; i < std::min(series.ms.size(), ours.ms.size()); ++i) {
        result.push_back(series.ms[i] / ours.ms[i]);
    }
    return result;
}

Value as_object(const Spread& s) {
    return Value::Object{{"min", milliseconds(s.min)},
                         {"median", milliseconds(s.median)},
                         {"max", milliseconds(s.max)}};
}

std::string as_json(const PeersOptions& options, const BenchOptions& bench_options,
                    const BenchScene& bench, const std::vector<Series>& all) {
    Value::List programs;
    for (const Series& series : all) {
        Value::List rounds;
        for (const double ms : series.ms) rounds.push_back(milliseconds(ms));
        Value::Object row = {{"program", series.name}};
        if (!series.renderer.empty()) row.emplace_back("renderer", series.renderer);
        row.emplace_back("frame_ms", as_object(spread(series.ms)));
        row.emplace_back("ratio", as_object(spread(ratios(series, all.front()))));
        row.emplace_back("frame_ms_rounds", rounds);
        programs.emplace_back(std::move(row));
    }
    return to_json(Value::Object{{"mesh", mesh_name(bench_options)},
                                 {"triangles", bench.scene.triangle_count()},
                                 {"size", size_name(bench_options.resolution)},
                                 {"algorithm", bench_options.algorithm->name},
                                 {"cull", name_of(bench_options.cull)},
                                 {"subdivide", bench_options.subdivide},
                                 {"repeat", bench_options.repeat},
                                 {"threads", thread_count(bench_options.common)},
                                 {"frames", bench_options.frames},
                                 {"rounds", options.rounds},
                                 {"programs", programs}}) +
           "\n";
}

std::string as_text(const PeersOptions& options, const BenchOptions& bench_options,
                    const BenchScene& bench, const std::vector<Series>& all) {
    std::vector<std::vector<std::string>> rows = {
        {"program", "ms min", "median", "max", "ratio min", "median", "max"}};
    for (const Series& series : all) {
        std::vector<std::string>& row = rows.emplace_back();
        row.push_back(series.name);
        const Spread ms = spread(series.ms), ratio = spread(ratios(series, all.front()));
        for (const double value : {ms.min, ms.median, ms.max, ratio.min, ratio.median, ratio.max}) {
            row.push_back(fmt::format("{:.2f}", value));
        }
    }
    return fmt::format(
        "{}: {} triangles, {}, {} threads, {} rounds of {} frames; ratio = program "
        "/ sightline, in the same round\n{}",
        mesh_name(bench_options), bench.scene.triangle_count(), size_name(bench_options.resolution),
        thread_count(bench_options.common), options.rounds, bench_options.frames, to_grid(rows));
}

}  // namespace

std::optional<PeersOptions> read_peers(OptionReader& reader, const BenchOptions& bench) {
    const auto folder = reader.arguments().value("--peers");
    if (!folder) {
        for (const std::string_view option : {"--rounds", "--peer-limit"}) {
            if (reader.arguments().has(option)) {
                reader.fail(
                    wrong_use("{} belongs to --peers; give the folder of the peers' "
                              "programs, as in --peers build",
                              option));
            }
        }
        return std::nullopt;
    }
    PeersOptions options;
    options.folder = *folder;
    options.rounds =
        static_cast<unsigned>(reader.count("--rounds", 1, 10000, "a whole number from 1 to 10000")
                                  .value_or(options.rounds));
    options.limit = reader.number("--peer-limit", {0, 1e6, true}, "a number of seconds above 0")
                        .value_or(options.limit);
    const auto& paths = bench.models.paths;
    if (paths.size() != 1 || paths.front() == "-") {
        reader.fail(
            wrong_use("--peers: the peers' programs read one model from a file; name one "
                      "file, as in bunny.obj"));
    }
    if (bench.cull != Cull::none && bench.cull != Cull::back) {
        reader.fail(
            wrong_use("--peers: the peers' programs can't do --cull {}; choose none or "
                      "back",
                      name_of(bench.cull)));
    }
    const auto projection = bench.camera.projection;
    if (projection == Projection::cavalier || projection == Projection::cabinet) {
        reader.fail(
            wrong_use("--peers: the peers' programs can't do --projection {}; choose "
                      "perspective or orthographic",
                      name_of(*projection)));
    }
    for (const auto& plane : {bench.camera.near_plane, bench.camera.far_plane}) {
        if (plane && *plane <= 0) {
            reader.fail(
                wrong_use("--peers: the peers' programs take --near and --far only above "
                          "0; leave them away or move the eye back"));
        }
    }
    return options;
}

Result<int> run_peers(const PeersOptions& options, const BenchOptions& bench) {
    const auto programs = find_programs(options.folder);
    if (!programs) return programs.error();
    Progress progress(bench.common.quiet);
    const auto scene = prepare_bench(bench, progress);
    if (!scene) return scene.error();
    const auto all = run_rounds(options, bench, *scene, *programs, progress);
    if (!all) return all.error();
    progress.clear();
    if (bench.common.stats) tell(as_text(options, bench, *scene, *all));
    const auto text = bench.common.json ? as_json : as_text;
    if (Status done = print(text(options, bench, *scene, *all)); !done) return done.error();
    return 0;
}

}  // namespace sightline::cli
