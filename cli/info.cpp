// `sightline info`: what is in a file; the camera; vanishing points.
#include <algorithm>
#include <array>

#include "errors.hpp"
#include "options.hpp"
#include "progress.hpp"
#include "report.hpp"
#include "sightline/sightline.hpp"
#include "streams.hpp"
#include "view_notes.hpp"

namespace sightline::cli {
namespace {

struct InfoOptions {
    CommonOptions common;
    Models models;
    CameraOptions camera;
    Resolution resolution;
    std::vector<glm::dvec3> directions;  ///< of --vanishing-direction
};

Result<InfoOptions> read_options(const Arguments& arguments) {
    OptionReader reader(arguments);
    InfoOptions options;
    options.models = read_models(reader);
    options.camera = read_camera(reader);
    options.resolution = read_resolution(reader, Resolution{});
    for (const std::string& text : arguments.values("--vanishing-direction")) {
        const auto direction = parse_point(text);
        if (!direction || *direction == glm::dvec3(0)) {
            reader.fail(
                wrong_use("--vanishing-direction: '{}' is not a direction x,y,z other than "
                          "0,0,0",
                          text));
        } else {
            options.directions.push_back(*direction);
        }
    }
    options.common = read_common(reader);
    if (reader.error()) return *reader.error();
    return options;
}

struct Vanishing {
    std::array<VanishingPoint, 3> principal;
    std::vector<VanishingPoint> asked;  ///< one a --vanishing-direction

    [[nodiscard]] int finite() const {
        return static_cast<int>(std::count_if(principal.begin(), principal.end(),
                                              [](const auto& point) { return point.has_value(); }));
    }
    [[nodiscard]] std::string_view title() const {
        constexpr std::array<std::string_view, 4> kTitles = {
            "parallel projection", "one-point perspective", "two-point perspective",
            "three-point perspective"};
        return kTitles[static_cast<std::size_t>(finite())];
    }
};

Vanishing find_vanishing_points(const Camera& camera, const InfoOptions& options) {
    Vanishing vanishing;
    vanishing.principal = principal_vanishing_points(camera);
    for (const glm::dvec3& direction : options.directions) {
        vanishing.asked.push_back(vanishing_point(camera, direction));
    }
    return vanishing;
}

// -- JSON --------------------------------------------------------------------------------------

Value json_point(const VanishingPoint& point) { return point ? Value(*point) : Value(); }

void json_scene(const Scene& scene, Value::Object& object) {
    Value::List objects, materials;
    for (const Object& o : scene.objects) {
        objects.emplace_back(Value::Object{{"name", o.name},
                                           {"triangles", o.triangle_count},
                                           {"polygons", o.polygon_count},
                                           {"closed", o.closed},
                                           {"normals", o.has_file_normals},
                                           {"material", scene.materials[o.material].name}});
    }
    for (const Material& m : scene.materials) {
        materials.emplace_back(Value::Object{{"name", m.name},
                                             {"base_color", glm::dvec3(m.base_color)},
                                             {"opacity", double{m.opacity}}});
    }
    object.emplace_back("objects", objects);
    object.emplace_back("materials", materials);
    object.emplace_back("triangles", scene.triangle_count());
    object.emplace_back("quadrics", std::uint64_t{scene.quadrics.size()});
    object.emplace_back("polygons", scene.counts.polygons);
    object.emplace_back("vertices", std::uint64_t{scene.positions.size()});
    object.emplace_back("joined_vertices", scene.counts.joined_positions);
    object.emplace_back("equal_faces", scene.counts.equal_faces);
    object.emplace_back("degenerate_triangles", scene.counts.degenerate_triangles);
    object.emplace_back("ignored_primitives", scene.counts.ignored_primitives);
    Value::List notes;
    for (const std::string& note : scene.notes) notes.emplace_back(note);
    object.emplace_back("notes", notes);
    object.emplace_back("lights", std::uint64_t{scene.lights.size()});
    object.emplace_back("bounds", Value::Object{{"min", scene.bounds.lo + scene.offset},
                                                {"max", scene.bounds.hi + scene.offset}});
    object.emplace_back("offset", scene.offset);
}

Value json_camera(const Camera& camera, glm::dvec3 offset) {
    Value::Object object{{"projection", name_of(camera.projection)},
                         {"eye", camera.eye + offset},
                         {"target", camera.target + offset},
                         {"gaze", camera.gaze()},
                         {"right", camera.right},
                         {"up", camera.up}};
    if (camera.is_perspective()) object.emplace_back("fov", camera.fov);
    object.emplace_back("view_height", camera.view_height);
    object.emplace_back("near", camera.near_plane);
    object.emplace_back("far", camera.far_plane);
    object.emplace_back("resolution",
                        Value::List{camera.resolution.width, camera.resolution.height});
    return object;
}

std::string as_json(const InfoOptions& options, const Scene& scene, const Camera& camera) {
    const Vanishing vanishing = find_vanishing_points(camera, options);
    Value::List files, asked;
    for (const std::string& path : options.models.paths) files.emplace_back(path);
    Value::Object object{{"files", files}};
    json_scene(scene, object);
    object.emplace_back("camera", json_camera(camera, scene.offset));
    object.emplace_back("vanishing_points",
                        Value::Object{{"x", json_point(vanishing.principal[0])},
                                      {"y", json_point(vanishing.principal[1])},
                                      {"z", json_point(vanishing.principal[2])}});
    object.emplace_back("finite_vanishing_points", vanishing.finite());
    object.emplace_back("perspective", vanishing.title());
    for (std::size_t i = 0; i < vanishing.asked.size(); ++i) {
        asked.emplace_back(Value::Object{{"direction", options.directions[i]},
                                         {"point", json_point(vanishing.asked[i])}});
    }
    if (!asked.empty()) object.emplace_back("vanishing_directions", asked);
    return to_json(object) + "\n";
}

// -- text --------------------------------------------------------------------------------------

std::string text_of(glm::dvec3 v) { return fmt::format("{:.6g}, {:.6g}, {:.6g}", v.x, v.y, v.z); }

/// A point of the scene as it stands in the file: with all digits where six tell nothing.
std::string text_of_point(glm::dvec3 point, glm::dvec3 offset) {
    if (offset == glm::dvec3(0)) return text_of(point);
    const glm::dvec3 p = point + offset;
    return fmt::format("{:.15g}, {:.15g}, {:.15g}", p.x, p.y, p.z);
}

std::string text_of(const VanishingPoint& point) {
    return point ? fmt::format("{:.2f}, {:.2f}", point->x, point->y) : "at infinity";
}

std::string name_or_dash(std::string_view name) { return std::string(name.empty() ? "-" : name); }

std::string scene_text(const Scene& scene) {
    std::vector<std::vector<std::string>> rows = {
        {"object", "triangles", "polygons", "closed", "normals", "material"}};
    for (const Object& o : scene.objects) {
        rows.push_back({name_or_dash(o.name), fmt::to_string(o.triangle_count),
                        fmt::to_string(o.polygon_count), o.closed ? "yes" : "no",
                        o.has_file_normals ? "yes" : "no", scene.materials[o.material].name});
    }
    std::string text = to_grid(rows);
    rows = {{"material", "colour", "opacity"}};
    for (const Material& m : scene.materials) {
        rows.push_back({name_or_dash(m.name),
                        fmt::format("#{:02x}{:02x}{:02x}", to_srgb8(m.base_color.r),
                                    to_srgb8(m.base_color.g), to_srgb8(m.base_color.b)),
                        fmt::format("{:.2f}", m.opacity)});
    }
    text += fmt::format("\n{}\n", to_grid(rows));
    std::vector<Row> table = {
        {"", "triangles", scene.triangle_count(), ""},
        {"", "surfaces that are not polygons", std::uint64_t{scene.quadrics.size()}, ""},
        {"", "polygons", scene.counts.polygons, ""},
        {"", "vertices", std::uint64_t{scene.positions.size()}, ""},
        {"", "of them joined to others", scene.counts.joined_positions, ""},
        {"", "polygons that equal others", scene.counts.equal_faces, ""},
        {"", "degenerate triangles", scene.counts.degenerate_triangles, ""},
        {"", "points and lines ignored", scene.counts.ignored_primitives, ""},
        {"", "lights", std::uint64_t{scene.lights.size()}, ""},
        {"", "lowest corner", text_of_point(scene.bounds.lo, scene.offset), ""},
        {"", "highest corner", text_of_point(scene.bounds.hi, scene.offset), ""}};
    if (scene.offset != glm::dvec3(0))
        table.push_back({"", "offset", text_of_point(glm::dvec3(0), scene.offset), ""});
    return text + to_table(table);
}

std::string camera_text(const Camera& camera, glm::dvec3 offset) {
    std::vector<Row> rows = {{"", "projection", name_of(camera.projection), ""},
                             {"", "eye", text_of_point(camera.eye, offset), ""},
                             {"", "target", text_of_point(camera.target, offset), ""},
                             {"", "gaze", text_of(camera.gaze()), ""},
                             {"", "right", text_of(camera.right), ""},
                             {"", "up", text_of(camera.up), ""}};
    if (camera.is_perspective()) {
        rows.push_back({"", "field of view", fmt::format("{:.6g} degrees", camera.fov), ""});
    } else {
        rows.push_back({"", "height of the view", fmt::format("{:.6g}", camera.view_height), ""});
    }
    rows.push_back({"", "near", fmt::format("{:.6g}", camera.near_plane), ""});
    rows.push_back({"", "far", fmt::format("{:.6g}", camera.far_plane), ""});
    rows.push_back({"", "resolution",
                    fmt::format("{}x{}", camera.resolution.width, camera.resolution.height), ""});
    return to_table(rows);
}

std::string as_text(const InfoOptions& options, const Scene& scene, const Camera& camera) {
    const Vanishing vanishing = find_vanishing_points(camera, options);
    std::vector<Row> rows;
    for (std::size_t i = 0; i < 3; ++i) {
        rows.push_back(
            {"", fmt::format("of the {} axis", "xyz"[i]), text_of(vanishing.principal[i]), ""});
    }
    for (std::size_t i = 0; i < vanishing.asked.size(); ++i) {
        rows.push_back({"", fmt::format("of {}", text_of(options.directions[i])),
                        text_of(vanishing.asked[i]), ""});
    }
    return fmt::format("{}\nCamera\n{}\nVanishing points in pixels ({})\n{}", scene_text(scene),
                       camera_text(camera, scene.offset), vanishing.title(), to_table(rows));
}

Result<int> run(const Arguments& arguments) {
    const Result<InfoOptions> options = read_options(arguments);
    if (!options) return options.error();
    Progress progress(options->common.quiet);
    Stopwatch watch;
    progress.stage("loading");
    Result<Scene> scene = load_scene(options->models.paths, options->models.options);
    if (!scene) return scene.error();
    if (!scene->motions.empty()) *scene = posed(*scene, 0);
    const auto camera = camera_for(*scene, options->camera, options->resolution);
    if (!camera) return camera.error();
    const Notes notes(options->common.quiet, progress);
    notes.warn_of_files(*scene);
    notes.warn_of_options(arguments, idle_camera_options({{camera->projection}}));
    ViewNotes view;
    ProjectCounts counts;
    counts.triangles = scene->triangle_count();
    counts.degenerate = scene->counts.degenerate_triangles;
    const bool shows_nothing = counts.degenerate == counts.triangles && scene->quadrics.empty();
    view.add({subject_of(*scene), merge_cameras(*scene, options->camera), *camera, counts,
              shows_nothing});
    view.print(notes, "the picture is blank");
    progress.clear();
    if (options->common.stats) {
        tell(to_table({{"", "load", milliseconds(watch.ms()), "ms"},
                       {"", "peak memory", peak_memory_mib(), "MiB"}}));
    }
    const auto write = options->common.json ? as_json : as_text;
    if (Status done = print(write(*options, *scene, *camera)); !done) return done.error();
    return 0;
}

constexpr std::array kInfoRows = {
    Option{"--vanishing-direction", "X,Y,Z", "show where lines of this direction meet; repeatable"},
};

const std::array kGroups = {
    OptionGroup{"Information", kInfoRows}, OptionGroup{"Camera", kCameraOptions},
    OptionGroup{"Input", kModelOptions}, OptionGroup{"Common", kCommonOptions}};

constexpr std::array kExamples = {
    Example{"sightline info bunny.obj", "objects, sizes, materials; the camera that fits"},
    Example{"sightline info cube.obj --eye 3,0,4 --target 0,0,0 --vanishing-direction 1,1,0",
            "a two-point perspective and one more vanishing point"},
    Example{"sightline info bunny.obj --json", "the same for programs"},
};

}  // namespace

const Command kInfo = {"info",
                       "what is in a file; the camera; vanishing points",
                       "MODEL...",
                       "Prints what a model holds, the camera that the options give, and where "
                       "parallel lines meet on\nits picture, in pixels.",
                       kGroups,
                       kExamples,
                       run};

}  // namespace sightline::cli
