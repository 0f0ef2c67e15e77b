// The table of growing scenes. I. Sutherland, R. Sproull, R. Schumacker, A Characterization of Ten
// Hidden-Surface Algorithms, 1974, estimated how the work of the algorithms grows with the number
// of polygons while the depth complexity stays the same; J. Foley and A. van Dam quote it. Theirs
// are estimates of the work, ours are times: the same canonical scene for every algorithm, resolve
// only, the projection stated apart.
#include "bench_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "affordable.hpp"
#include "errors.hpp"
#include "image/atomic_file.hpp"
#include "report.hpp"
#include "sightline/generate.hpp"
#include "streams.hpp"

namespace sightline::cli {
namespace {

/// A run that is longer warms itself up; no further frames are timed once so much time has passed.
constexpr double kLongRunMs = 1000, kEnoughMs = 10000;
/// Longest time that an algorithm that is not named may be expected to take for one frame.
constexpr double kPatienceMs = 60000;
/// Growth is counted from here on, as below the fixed cost of a picture hides it.
constexpr std::uint32_t kGrowthFrom = 2500;
/// Depth of the box, in heights of the page: triangles stand behind rather than in one another.
constexpr double kBoxDepth = 4;

/// One algorithm on one scene: milliseconds, or why it was not run.
struct Cell {
    std::optional<double> ms;
    std::string reason;
};

/// The whole front of the box fills the picture.
Result<Camera> table_camera(const Scene& scene, const glm::dvec3 box, Resolution resolution) {
    CameraOptions options;
    options.projection = Projection::orthographic;
    options.ortho_height = box.y;
    options.eye = glm::dvec3(0.5 * box.x, 0.5 * box.y, box.z + 1);
    options.target = glm::dvec3(0.5 * box.x, 0.5 * box.y, 0);
    return make_camera(options, scene, resolution);
}

Result<double> time_resolve(const Algorithm& algorithm, const ScreenScene& screen,
                            const TableOptions& options, Visibility& out) {
    std::vector<double> times;
    double total = 0;
    while (times.size() < options.frames && total < kEnoughMs) {
        const Stopwatch watch;
        const Status done = resolve(algorithm, screen, {1, options.common.threads}, out);
        if (!done) return done.error();
        const double ms = watch.ms();
        const bool warm_up = total == 0 && ms < kLongRunMs;
        total += ms;
        if (!warm_up) times.push_back(ms);
    }
    return median(times);
}

/// The time to expect on the next scene from the last two, or from the last in proportion.
double expected_ms(const std::vector<TableScene>& scenes, const TableRow& row) {
    const std::size_t i = row.ms.size();
    if (i == 0 || !row.ms[i - 1]) return i == 0 ? 0 : kPatienceMs + 1;
    const double step = double{1} * scenes[i].triangles / scenes[i - 1].triangles;
    double exponent = 1;
    if (i > 1 && row.ms[i - 2]) {
        exponent = std::log(*row.ms[i - 1] / *row.ms[i - 2]) /
                   std::log(double{1} * scenes[i - 1].triangles / scenes[i - 2].triangles);
    }
    return *row.ms[i - 1] * std::pow(step, std::max(exponent, 0.0));
}

/// Runs the algorithm on the last of the scenes, where the work allows it or it is named.
Result<Cell> measure(const TableOptions& options, const Algorithm& algorithm,
                     const std::vector<TableScene>& scenes, const TableRow& row,
                     const ScreenScene& screen, Visibility& out) {
    if (options.named.empty()) {
        if (!is_affordable(algorithm, screen)) {
            return Cell{{}, "more than 2^38 samples times triangles"};
        }
        if (expected_ms(scenes, row) > kPatienceMs) return Cell{{}, "over a minute a frame"};
    }
    const auto ms = time_resolve(algorithm, screen, options, out);
    if (!ms) return ms.error();
    return Cell{*ms, ""};
}

/// Generates and projects; `out` refers to `scene`.
Result<TableScene> make_scene(const TableOptions& options, std::uint32_t triangles, Scene& scene,
                              ScreenScene& out) {
    const double aspect = double{1} * options.resolution.width / options.resolution.height;
    const glm::dvec3 box(aspect, 1, kBoxDepth);
    auto generated = random_triangles(triangles, 1, {options.complexity, box});
    if (!generated) return generated.error();
    scene = std::move(*generated);
    const auto camera = table_camera(scene, box, options.resolution);
    if (!camera) return camera.error();
    TableScene made;
    made.triangles = triangles;
    std::vector<double> times;
    for (unsigned i = 0; i < options.frames + 1; ++i) {
        const Stopwatch watch;
        const Status done = project(scene, *camera, {Cull::none, options.common.threads}, out);
        if (!done) return done.error();
        if (i > 0) times.push_back(watch.ms());
    }
    made.project_ms = median(times);
    made.complexity = depth_complexity(out);
    return made;
}

double covered_share(const Visibility& visibility) {
    const auto empty = std::count(visibility.ids.begin(), visibility.ids.end(), kNone);
    return 1 - static_cast<double>(empty) / static_cast<double>(visibility.ids.size());
}

/// The unit comes first: its time on the first scene divides all others.
std::vector<const Algorithm*> choose(const TableOptions& options) {
    std::vector<const Algorithm*> chosen = {&default_algorithm()};
    const auto add = [&](const Algorithm* algorithm) {
        if (algorithm != chosen.front()) chosen.push_back(algorithm);
    };
    for (const Algorithm* algorithm : options.named) add(algorithm);
    if (options.named.empty()) {
        for (const Algorithm& algorithm : algorithms()) add(&algorithm);
    }
    return chosen;
}

/// Exponent of the time from scene `from` to the last one that was run.
std::optional<double> growth(const Table& table, const TableRow& row, std::size_t from) {
    std::size_t end = row.ratios.size();
    while (end > 0 && !row.ratios[end - 1]) --end;
    if (end < from + 2 || !row.ratios[from]) return std::nullopt;
    return std::log(*row.ratios[end - 1] / *row.ratios[from]) /
           std::log(double{1} * table.scenes[end - 1].triangles / table.scenes[from].triangles);
}

/// Fills in what follows from the times: ratios, the historical rows, growth.
void derive(Table& table) {
    table.unit_ms = table.rows.front().ms.front().value_or(1);
    for (TableRow& row : table.rows) {
        for (const auto& ms : row.ms) {
            row.ratios.push_back(ms ? std::optional(*ms / table.unit_ms) : std::nullopt);
        }
    }
    for (TableRow& row : historical_rows(table.scenes)) table.rows.push_back(std::move(row));
    const auto& scenes = table.scenes;
    std::size_t from = 0;
    while (from < scenes.size() && scenes[from].triangles < kGrowthFrom) ++from;
    if (from + 1 >= scenes.size()) from = 0;  // nothing larger to compare with
    table.growth_from = scenes[from].triangles;
    for (TableRow& row : table.rows) row.growth = growth(table, row, from);
}

void describe(const TableOptions& options, Table& table) {
    table.unit = default_algorithm().name;
    table.title = fmt::format("Time to resolve visibility, {} at {} triangles = 1", table.unit,
                              grouped(table.scenes.front().triangles));
    table.caption = fmt::format(
        "{}, {} threads, depth complexity {:.2f}, median of {} frames; {} at {} "
        "triangles: {:.2f} ms",
        size_name(options.resolution), thread_count(options.common), table.scenes.back().complexity,
        options.frames, table.unit, grouped(table.scenes.front().triangles), table.unit_ms);
}

Result<Table> measure_all(const TableOptions& options, Progress& progress) {
    Table table;
    const auto chosen = choose(options);
    for (const Algorithm* algorithm : chosen) table.rows.emplace_back().name = algorithm->name;
    for (const std::uint32_t triangles : options.sizes) {
        progress.stage(fmt::format("{} triangles", triangles));
        Scene scene;
        ScreenScene screen;
        const auto made = make_scene(options, triangles, scene, screen);
        if (!made) return made.error();
        table.scenes.push_back(*made);
        for (std::size_t i = 0; i < chosen.size(); ++i) {
            TableRow& row = table.rows[i];
            progress.stage(fmt::format("{}, {} triangles", row.name, triangles));
            Visibility answer;
            const auto cell = measure(options, *chosen[i], table.scenes, row, screen, answer);
            if (!cell) return cell.error();
            row.ms.push_back(cell->ms);
            if (i == 0) table.scenes.back().covered = covered_share(answer);
            if (cell->ms) continue;
            table.notes.push_back(fmt::format("- {} at {}: {}; runs when named by --algorithms",
                                              row.name, grouped(triangles), cell->reason));
        }
    }
    derive(table);
    describe(options, table);
    return table;
}

Status write_svg(const Output& output, const Table& table) {
    auto file = AtomicFile::create(output.path, AtomicFile::Access::sequential);
    if (!file) return file.error();
    const std::string svg = table_as_svg(table);
    if (Status done = file->write(svg.data(), svg.size()); !done) return done;
    return file->commit();
}

Value optional_ms(const std::optional<double>& ms) { return ms ? milliseconds(*ms) : Value(); }

Value optional_number(const std::optional<double>& x) { return x ? Value(*x) : Value(); }

std::string as_json(const TableOptions& options, const Table& table) {
    Value::List scenes, rows, historical;
    for (const TableScene& scene : table.scenes) {
        scenes.emplace_back(Value::Object{{"triangles", scene.triangles},
                                          {"project_ms", milliseconds(scene.project_ms)},
                                          {"depth_complexity", scene.complexity},
                                          {"covered", scene.covered}});
    }
    for (const TableRow& row : table.rows) {
        Value::List ms, ratios;
        for (const auto& value : row.ms) ms.push_back(optional_ms(value));
        for (const auto& value : row.ratios) ratios.push_back(optional_number(value));
        Value::Object object = {{row.historical ? "name" : "algorithm", row.name}};
        if (!row.historical) object.emplace_back("resolve_ms", ms);
        object.emplace_back("relative", ratios);
        object.emplace_back("growth", optional_number(row.growth));
        (row.historical ? historical : rows).emplace_back(std::move(object));
    }
    return to_json(Value::Object{{"size", size_name(options.resolution)},
                                 {"threads", thread_count(options.common)},
                                 {"frames", options.frames},
                                 {"unit", table.unit},
                                 {"unit_ms", milliseconds(table.unit_ms)},
                                 {"growth_from", table.growth_from},
                                 {"scenes", scenes},
                                 {"rows", rows},
                                 {"historical", historical}}) +
           "\n";
}

std::string as_text(const Table& table) {
    using Cells = std::vector<std::string>;
    Cells heading = {"triangles"}, project = {"project, ms"}, complexity = {"depth complexity"};
    Cells covered = {"covered"};
    for (const TableScene& scene : table.scenes) {
        heading.push_back(fmt::to_string(scene.triangles));
        project.push_back(three_digits(scene.project_ms));
        complexity.push_back(fmt::format("{:.2f}", scene.complexity));
        covered.push_back(fmt::format("{:.1f}%", 100 * scene.covered));
    }
    std::vector<Cells> relative = {heading}, times = {heading, complexity, covered, project};
    relative.front().push_back("growth");
    for (const TableRow& row : table.rows) {
        Cells& ratios = relative.emplace_back(Cells{row.name});
        for (const auto& ratio : row.ratios) ratios.push_back(three_digits(ratio));
        ratios.push_back(row.growth ? fmt::format("{:.2f}", *row.growth) : "-");
        if (row.historical) continue;
        Cells& ms = times.emplace_back(Cells{row.name + ", ms"});
        for (const auto& value : row.ms) ms.push_back(three_digits(value));
    }
    std::string text = fmt::format("{}\n{}\n\n{}\n{}\n", table.title, table.caption,
                                   to_grid(relative), to_grid(times));
    for (const std::string& note : footnotes(table)) text += note + "\n";
    return text;
}

}  // namespace

Result<int> run_table(const TableOptions& options) {
    Progress progress(options.common.quiet);
    const auto table = measure_all(options, progress);
    if (!table) return table.error();
    progress.clear();
    if (options.svg) {
        if (Status done = write_svg(*options.svg, *table); !done) return done.error();
    }
    if (options.common.stats) tell(as_text(*table));
    Status done = print(options.common.json ? as_json(options, *table) : as_text(*table));
    if (!done) return done.error();
    return 0;
}

}  // namespace sightline::cli
