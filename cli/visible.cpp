// `sightline visible`: which faces can be seen, and exactly how much of each.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "directions.hpp"
#include "errors.hpp"
#include "math/moderate.hpp"
#include "outputs.hpp"
#include "progress.hpp"
#include "report.hpp"
#include "sightline/sightline.hpp"
#include "streams.hpp"
#include "trace_options.hpp"
#include "view_notes.hpp"

namespace sightline::cli {
namespace {

enum class By { triangle, polygon, object };
constexpr std::array<std::string_view, 3> kByNames = {"triangle", "polygon", "object"};

struct VisibleOptions {
    CommonOptions common;
    Models models;
    CameraOptions camera;
    Resolution resolution;
    TraceOptions trace;
    By by = By::triangle;
    std::vector<glm::dvec3> directions;  ///< of --from-directions
};

// -- options -----------------------------------------------------------------------------------

Result<VisibleOptions> read_options(const Arguments& arguments) {
    OptionReader reader(arguments);
    VisibleOptions options;
    options.models = read_models(reader);
    options.camera = read_camera(reader);
    options.resolution = read_resolution(reader, Resolution{}, kAnyNumberOfPixels);
    if (const auto by = reader.choice("--by", kByNames)) options.by = static_cast<By>(*by);
    options.trace.method = read_method(reader);
    options.common = read_common(reader);
    options.trace.threads = options.common.threads;
    if (options.common.json && arguments.has("--csv")) {
        reader.fail(wrong_use("--csv and --json: choose one"));
    }
    if (const auto path = arguments.value("--from-directions")) {
        for (const std::string_view other : {"--eye", "--target", "--direction", "--view"})
            if (arguments.has(other))
                reader.fail(
                    wrong_use("{} would be one more direction; put it into the file of "
                              "--from-directions",
                              other));
        check_report(reader, {&*path, 1});
        if (!reader.error()) {
            auto directions = read_directions(*path);
            if (!directions) return directions.error();
            options.directions = std::move(*directions);
        }
    }
    if (reader.error()) return *reader.error();
    return options;
}

// -- one view ----------------------------------------------------------------------------------

/// One row: a triangle, a polygon or an object.
struct Group {
    std::uint32_t object = 0, polygon = 0, triangle = 0;
    FaceArea area;
};

struct View {
    Camera camera;
    ProjectCounts counts;
    std::vector<FaceArea> areas;  ///< of every triangle, in pixels^2

    /// Scene units^2 a pixel^2; 0 in perspective, where they mean nothing.
    [[nodiscard]] double unit() const {
        const double pixels = camera.pixels_per_unit();
        return camera.is_perspective() ? 0 : 1 / (pixels * pixels);
    }
};

Result<View> look(const Scene& scene, const Camera& camera, const VisibleOptions& options) {
    const auto page = page_of(scene, camera, {Cull::automatic, options.common.threads});
    if (!page) return page.error();
    auto areas = visible_areas(*page, options.trace);
    if (!areas) return areas.error();
    return View{camera, page->counts(), std::move(*areas)};
}

std::vector<Group> group(const Scene& scene, const View& view, By by) {
    std::vector<Group> groups;
    for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
        const Object& object = scene.objects[o];
        for (std::uint32_t i = 0; i < object.triangle_count; ++i) {
            const std::uint32_t t = object.first_triangle + i;
            const std::uint32_t polygon = scene.triangle_polygon[t];
            const bool same =
                !groups.empty() && groups.back().object == o &&
                (by == By::object || (by == By::polygon && groups.back().polygon == polygon));
            if (!same) groups.push_back({o, polygon, t, {}});
            Group& own = groups.back();
            own.area.front = own.area.front || view.areas[t].front;
            own.area.projected += view.areas[t].projected;
            own.area.visible += view.areas[t].visible;
        }
    }
    return groups;
}

double fraction_of(const FaceArea& area) {
    return area.projected > 0 ? std::clamp(area.visible / area.projected, 0.0, 1.0) : 0;
}

/// A name that begins like a formula would be computed by a spreadsheet; an apostrophe tells it
/// that this is text.
std::string csv_name(const std::string& name) {
    const std::size_t first = name.find_first_not_of(' ');
    const bool is_formula = first != std::string::npos &&
                            std::string_view("=+-@").find(name[first]) != std::string_view::npos &&
                            !parse_number(name);
    if (!is_formula && name.find_first_of(",\"\r\n") == std::string::npos) return name;
    std::string quoted = is_formula ? "\"'" : "\"";
    for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + '"';
}

std::string as_csv(const Scene& scene, const View& view, const std::vector<Group>& groups, By by) {
    constexpr std::array<std::string_view, 3> kKeys = {"object,polygon,triangle,",
                                                       "object,polygon,", "object,name,"};
    std::string text = fmt::format("{}front_facing,visible,area_projected,area_visible,fraction\n",
                                   kKeys[static_cast<std::size_t>(by)]);
    const double unit = view.unit() > 0 ? view.unit() : 1;
    for (const Group& g : groups) {
        auto out = std::back_inserter(text);
        if (by == By::object)
            fmt::format_to(out, "{},{},", g.object, csv_name(scene.objects[g.object].name));
        else if (by == By::polygon)
            fmt::format_to(out, "{},{},", g.object, g.polygon);
        else
            fmt::format_to(out, "{},{},{},", g.object, g.polygon, g.triangle);
        fmt::format_to(out, "{:d},{:d},{},{},{}\n", g.area.front, g.area.visible > 0,
                       unit * g.area.projected, unit * g.area.visible, fraction_of(g.area));
    }
    return text;
}

Value::Object json_area(const View& view, const FaceArea& area) {
    const double unit = view.unit() > 0 ? view.unit() : 1;
    Value::Object object{{"area_projected", unit * area.projected},
                         {"area_visible", unit * area.visible},
                         {"fraction", fraction_of(area)}};
    if (view.unit() > 0) {
        object.emplace_back("area_projected_pixels", area.projected);
        object.emplace_back("area_visible_pixels", area.visible);
    }
    return object;
}

std::string as_json(const Scene& scene, const View& view, const std::vector<Group>& groups, By by) {
    Value::List rows;
    FaceArea all;
    for (const Group& g : groups) {
        Value::Object row{{"object", g.object}};
        if (by == By::object) row.emplace_back("name", scene.objects[g.object].name);
        if (by != By::object) row.emplace_back("polygon", g.polygon);
        if (by == By::triangle) row.emplace_back("triangle", g.triangle);
        row.emplace_back("front_facing", g.area.front);
        row.emplace_back("visible", g.area.visible > 0);
        for (auto& item : json_area(view, g.area)) row.push_back(std::move(item));
        rows.emplace_back(std::move(row));
        all.projected += g.area.projected;
        all.visible += g.area.visible;
    }
    Value::Object total = json_area(view, all);
    return to_json(Value::Object{{"by", kByNames[static_cast<std::size_t>(by)]},
                                 {"unit", view.unit() > 0 ? "scene" : "pixel"},
                                 {"total", std::move(total)},
                                 {"rows", std::move(rows)}}) +
           "\n";
}

// -- many directions ---------------------------------------------------------------------------

/// What is seen along one direction, or from at least one of them.
struct DirectionRow {
    std::optional<glm::dvec3> direction;  ///< none: the union
    std::uint64_t triangles = 0;          ///< that are seen
    double silhouette = 0;                ///< visible area, scene units^2
    double seen = 0;                      ///< true area of the triangles that are seen
};

double true_area(const Scene& scene, std::uint32_t t) {
    const Corners c = scene.triangles[t];
    const glm::dvec3 n = glm::cross(scene.positions[c.y] - scene.positions[c.x],
                                    scene.positions[c.z] - scene.positions[c.x]);
    return 0.5 * std::sqrt(glm::dot(n, n));
}

/// What is up does not matter for areas, but it must not be the gaze.
glm::dvec3 up_for(const glm::dvec3& direction) {
    glm::dvec3 d = math::moderate(direction);
    d /= std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    return std::abs(d.x) + std::abs(d.z) > 0.5 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1);
}

Result<std::vector<DirectionRow>> look_around(const Scene& scene, const VisibleOptions& options,
                                              Progress& progress) {
    std::vector<DirectionRow> rows;
    std::vector<bool> seen(scene.triangle_count());
    for (const glm::dvec3& direction : options.directions) {
        progress.stage("direction", static_cast<unsigned>(rows.size() + 1),
                       static_cast<unsigned>(options.directions.size()));
        CameraOptions camera_options = options.camera;
        camera_options.direction = direction;
        if (!camera_options.up) camera_options.up = up_for(direction);
        camera_options.projection = camera_options.projection.value_or(Projection::orthographic);
        const auto camera = camera_for(scene, camera_options, options.resolution);
        if (!camera) return camera.error();
        const auto view = look(scene, *camera, options);
        if (!view) return view.error();
        DirectionRow row{direction};
        for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
            if (!(view->areas[t].visible > 0)) continue;
            ++row.triangles;
            row.silhouette += (view->unit() > 0 ? view->unit() : 1) * view->areas[t].visible;
            row.seen += true_area(scene, t);
            seen[t] = true;
        }
        rows.push_back(row);
    }
    DirectionRow all;
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
        if (!seen[t]) continue;
        ++all.triangles;
        all.seen += true_area(scene, t);
    }
    rows.push_back(all);
    return rows;
}

std::string directions_as_csv(const std::vector<DirectionRow>& rows) {
    std::string text = "direction,x,y,z,triangles_visible,area_visible,surface_seen\n";
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const DirectionRow& row = rows[i];
        if (row.direction)
            text += fmt::format("{},{},{},{},{},{},{}\n", i, row.direction->x, row.direction->y,
                                row.direction->z, row.triangles, row.silhouette, row.seen);
        else
            text += fmt::format("union,,,,{},,{}\n", row.triangles, row.seen);
    }
    return text;
}

std::string directions_as_json(const std::vector<DirectionRow>& rows) {
    Value::List list;
    for (const DirectionRow& row : rows) {
        if (!row.direction) continue;
        list.emplace_back(Value::Object{{"direction", *row.direction},
                                        {"triangles_visible", row.triangles},
                                        {"area_visible", row.silhouette},
                                        {"surface_seen", row.seen}});
    }
    const DirectionRow& all = rows.back();
    return to_json(Value::Object{{"directions", std::move(list)},
                                 {"union", Value::Object{{"triangles_visible", all.triangles},
                                                         {"surface_seen", all.seen}}}}) +
           "\n";
}

// -- the command -------------------------------------------------------------------------------

/// Warns of what a view hides from its user.
void warn_of_view(const Notes& notes, const Scene& scene, const VisibleOptions& options,
                  const View& view) {
    ViewNotes seen;
    seen.add(
        {subject_of(scene), merge_cameras(scene, options.camera), view.camera, view.counts,
         std::ranges::none_of(view.areas, [](const FaceArea& area) { return area.visible > 0; })});
    seen.print(notes, "nothing is visible");
}

void warn_of_options(const Notes& notes, const Arguments& arguments, const VisibleOptions& options,
                     const Scene& scene) {
    const bool around = !options.directions.empty();
    const IdleOption own[] = {{"--by", around, "--from-directions has a row a direction"}};
    notes.warn_of_options(arguments, own);
    const Projection usual = around ? Projection::orthographic : Projection::perspective;
    const std::array projections{(around ? options.camera : merge_cameras(scene, options.camera))
                                     .projection.value_or(usual)};
    notes.warn_of_options(arguments, idle_camera_options(projections));
}

Result<std::string> text_of(const Scene& scene, VisibleOptions& options, const Notes& notes,
                            Progress& progress) {
    if (!options.directions.empty()) {
        const auto rows = look_around(scene, options, progress);
        if (!rows) return rows.error();
        if (rows->back().triangles == 0) {
            notes.warn("nothing is visible from any direction; change --near, --far or --zoom");
        }
        return options.common.json ? directions_as_json(*rows) : directions_as_csv(*rows);
    }
    const auto camera = camera_for(scene, options.camera, options.resolution);
    if (!camera) return camera.error();
    show_progress(progress, options.trace);
    const auto view = look(scene, *camera, options);
    if (!view) return view.error();
    warn_of_view(notes, scene, options, *view);
    const std::vector<Group> groups = group(scene, *view, options.by);
    return options.common.json ? as_json(scene, *view, groups, options.by)
                               : as_csv(scene, *view, groups, options.by);
}

Result<int> run(const Arguments& arguments) {
    Result<VisibleOptions> options = read_options(arguments);
    if (!options) return options.error();
    Progress progress(options->common.quiet);
    Stopwatch watch;
    const auto scene = load_for_drawing(options->models, options->common.quiet, progress);
    if (!scene) return scene.error();
    const double load_ms = watch.lap();
    const Notes notes(options->common.quiet, progress);
    warn_of_options(notes, arguments, *options, *scene);
    const auto text = text_of(*scene, *options, notes, progress);
    if (!text) return text.error();
    progress.clear();
    if (options->common.stats) {
        tell(to_table({{"", "load", milliseconds(load_ms), "ms"},
                       {"", "find what is visible", milliseconds(watch.ms()), "ms"},
                       {"", "peak memory", peak_memory_mib(), "MiB"}}));
    }
    if (Status done = print(*text); !done) return done.error();
    return 0;
}

const std::array kVisibleRows = {
    Option{"--by", "triangle|polygon|object", "what a row is about (default: triangle)"},
    Option{"--csv", "", "rows of commas-separated values, the default"},
    Option{"--from-directions", "FILE",
           "along every direction x,y,z of a file, one a line: a row each and one for all"},
    kMethodOption,
};

const std::array kGroups = {
    OptionGroup{"Visibility", kVisibleRows}, OptionGroup{"Camera", kCameraOptions},
    OptionGroup{"Input", kModelOptions}, OptionGroup{"Common", kCommonOptions}};

constexpr std::array kExamples = {
    Example{"sightline visible part.stl --projection orthographic --view front > faces.csv",
            "area of each triangle as it is seen, in the model's unit squared"},
    Example{"sightline visible house.obj --by object --json", "how much of each object"},
    Example{"sightline visible panel.obj --from-directions sun.txt",
            "area in the sun for each of its positions, and what it ever reaches"},
};

}  // namespace

const Command kVisible = {"visible",
                          "which faces are visible, and how much of each",
                          "MODEL...",
                          "Prints, for every triangle, polygon or object, its area in the "
                          "projection and the exact part of it\nthat can be seen: in the scene's "
                          "unit squared in parallel projections, in pixels squared in\n"
                          "perspective.",
                          kGroups,
                          kExamples,
                          run};

}  // namespace sightline::cli
