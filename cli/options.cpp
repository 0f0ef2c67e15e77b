// Shared options: their rows in the help, and how a group of them becomes a struct.
#include "options.hpp"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <system_error>

#include "errors.hpp"
#include "outputs.hpp"
#include "signals.hpp"
#include "suggest.hpp"

namespace sightline::cli {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Range kAnyNumber{-kInfinity, kInfinity};
constexpr Range kPositive{0, kInfinity, true, true};
/// The largest value of --weld: with a larger one, shapes that can be seen would change.
constexpr double kLargestWeld = 0.01;
/// Names the file that standard output goes into, if it is one.
constexpr const char* kStandardOutput = "/proc/self/fd/1";

constexpr std::array kCameraRows = {
    Option{"--eye", "X,Y,Z", "where the camera stands"},
    Option{"--target", "X,Y,Z", "the point it looks at (default: the model's centre)"},
    Option{"--up", "X,Y,Z", "what is upwards (default: 0,1,0)"},
    Option{"--direction", "X,Y,Z", "direction of gaze, from the eye into the scene"},
    Option{"--view", "NAME",
           "front, back, left, right, top, bottom, isometric (default), dimetric, trimetric"},
    Option{"--projection", "NAME", "perspective (default), orthographic, cavalier, cabinet"},
    Option{"--fov", "DEG", "vertical field of view of a perspective (default: 40)"},
    Option{"--ortho-height", "H", "height of a parallel view, in the scene's unit"},
    Option{"--oblique-angle", "DEG",
           "direction of receding axes, counter-clockwise from +x (default: 45)"},
    Option{"--zoom", "F", "enlarge about the centre (default: 1)"},
    Option{"--near", "N", "distance of the near plane (default: fitted to the scene)"},
    Option{"--far", "F", "distance of the far plane (default: fitted to the scene)"},
    Option{"--resolution", "WxH", "size of the picture in pixels (default: 1024x768)"},
};

constexpr std::array kModelRows = {
    Option{"--format", "NAME", "format of the models (obj, ply, ...); needed for '-'"},
    Option{"--weld", "FRACTION",
           "join corners on open edges no further apart than this part of their object's size "
           "(default: 2^-20, about 9.5e-7; 0: only equal ones)"},
    Option{
        "--allow-path", "DIR",
        "a folder in which files that a model names may lie, besides the model's own folder, what "
        "is below it, and the folder textures beside it; may be repeated"},
};

constexpr std::array kCommonRows = {
    Option{"--threads", "N", "number of threads (default: all cores)"},
    Option{"--time-limit", "SECONDS", "give up after this time, leaving nothing behind"},
    Option{"--stats", "", "a table of stages and counts on standard error"},
    Option{"--json", "", "one JSON object, the last line of standard output"},
    Option{"--quiet", "", "no warnings and no progress", "-q"},
    Option{"--help", "", "this text", "-h"},
};

constexpr std::array<std::string_view, 4> kCullNames = {"auto", "none", "back", "front"};
constexpr std::array kCulls = {Cull::automatic, Cull::none, Cull::back, Cull::front};

/// Every value of an enumeration with a name, found by counting up from 0.
template <class E, std::size_t N>
std::array<std::string_view, N> enum_names() {
    std::array<std::string_view, N> names;
    for (std::size_t i = 0; i < N; ++i) names[i] = name_of(static_cast<E>(i));
    return names;
}

/// Lets make_camera() judge what does not depend on the model: what is missing is filled in so
/// that it can't be wrong. A scene file may bring a camera, so then nothing can be said yet.
void check_camera(OptionReader& reader, const CameraOptions& options) {
    const auto& models = reader.arguments().models();
    const bool has_scene_file = std::any_of(
        models.begin(), models.end(), [](const auto& path) { return path.ends_with(".json"); });
    if (has_scene_file || reader.error()) return;
    CameraOptions probe = options;
    if (!probe.near_plane || !probe.far_plane) probe.near_plane = probe.far_plane = std::nullopt;
    // A box beside the eye, in a direction that nobody would call up.
    const glm::dvec3 centre = probe.eye.value_or(glm::dvec3(0)) + glm::dvec3(3.1, -5.3, 7.7);
    const Box box{centre - 1.0, centre + 1.0};
    if (auto camera = make_camera(probe, box, Resolution{}); !camera) reader.fail(camera.error());
}

}  // namespace

constinit const std::span<const Option> kCameraOptions = kCameraRows;
constinit const std::span<const Option> kModelOptions = kModelRows;
constinit const std::span<const Option> kCommonOptions = kCommonRows;
constinit const Option kCullOption = {"--cull", "auto|none|back|front",
                                      "which sides to leave out; auto: the back of what is closed"};

// -- the reader --------------------------------------------------------------------------------

void OptionReader::reject(std::string_view option, std::string_view value,
                          std::string_view expected) {
    fail(wrong_use("{}: '{}' is not {}", option, value, expected));
}

std::optional<double> OptionReader::number(std::string_view option, Range range,
                                           std::string_view expected) {
    const auto text = arguments_.value(option);
    if (!text) return std::nullopt;
    const auto number = parse_number(*text);
    if (number && range.contains(*number)) return number;
    reject(option, *text, expected);
    return std::nullopt;
}

std::optional<std::uint64_t> OptionReader::count(std::string_view option, std::uint64_t low,
                                                 std::uint64_t high, std::string_view expected) {
    const auto text = arguments_.value(option);
    if (!text) return std::nullopt;
    const auto number = parse_count(*text);
    if (number && *number >= low && *number <= high) return number;
    reject(option, *text, expected);
    return std::nullopt;
}

std::optional<glm::dvec3> OptionReader::point(std::string_view option) {
    const auto text = arguments_.value(option);
    if (!text) return std::nullopt;
    const auto point = parse_point(*text);
    if (!point)
        reject(option, *text, fmt::format("three numbers x,y,z, as in {} 1,-2,0.5", option));
    return point;
}

std::optional<glm::u8vec4> OptionReader::color(std::string_view option) {
    const auto text = arguments_.value(option);
    if (!text) return std::nullopt;
    const auto color = parse_color(*text);
    if (!color) {
        reject(option, *text,
               "a colour: R,G,B or R,G,B,A in 0..255, '#rrggbb', '#rrggbbaa' or none");
    }
    return color;
}

std::optional<std::size_t> OptionReader::choice(std::string_view option,
                                                std::span<const std::string_view> names) {
    const auto text = arguments_.value(option);
    if (!text) return std::nullopt;
    const auto found = std::find(names.begin(), names.end(), *text);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    const auto near = closest(*text, names);
    fail(wrong_use("{}: '{}' is unknown; {}choose from {}", option, *text,
                   near ? fmt::format("did you mean '{}'? Or ", *near) : "", join(names)));
    return std::nullopt;
}

std::vector<const Algorithm*> OptionReader::algorithms(std::string_view option) {
    std::vector<const Algorithm*> chosen;
    const auto text = arguments_.value(option);
    if (!text) return chosen;
    std::vector<std::string_view> names;
    for (const Algorithm& algorithm : sightline::algorithms()) names.push_back(algorithm.name);
    for (const std::string_view name : split_list(*text)) {
        const Algorithm* algorithm = find_algorithm(name);
        if (algorithm == nullptr) {
            fail(wrong_use("{}: the algorithm '{}' is unknown; {}", option, name,
                           did_you_mean(name, names, fmt::format("choose from {}", join(names)))));
        } else if (std::find(chosen.begin(), chosen.end(), algorithm) == chosen.end()) {
            chosen.push_back(algorithm);
        }
    }
    return chosen;
}

// -- groups ------------------------------------------------------------------------------------

int all_threads() { return tbb::this_task_arena::max_concurrency(); }

CommonOptions read_common(OptionReader& reader) {
    CommonOptions common;
    const Arguments& arguments = reader.arguments();
    common.quiet = arguments.has("--quiet");
    common.stats = arguments.has("--stats");
    common.json = arguments.has("--json");
    const auto threads = reader.count("--threads", 1, 1024, "a number of threads from 1 to 1024");
    const auto limit = reader.number("--time-limit", {0, 1e9, true},
                                     "a number of seconds above 0, as in --time-limit 60");
    if (threads) {
        common.threads = static_cast<int>(*threads);
        // Holds for the whole run, the stages of the library that take no number included. It is
        // never destroyed: that would start threads, when all is done and where none may be left.
        static const tbb::global_control* const control =
            std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(*threads))
                .release();
        static_cast<void>(control);
    }
    if (limit && !reader.error()) start_time_limit(*limit);
    return common;
}

CameraOptions read_camera(OptionReader& reader) {
    static const auto views = enum_names<NamedView, 9>();
    static const auto projections = enum_names<Projection, 4>();
    CameraOptions camera;
    camera.eye = reader.point("--eye");
    camera.target = reader.point("--target");
    camera.up = reader.point("--up");
    camera.direction = reader.point("--direction");
    if (const auto view = reader.choice("--view", views)) {
        camera.view = static_cast<NamedView>(*view);
    }
    if (const auto projection = reader.choice("--projection", projections)) {
        camera.projection = static_cast<Projection>(*projection);
    }
    camera.fov = reader.number("--fov", {0, 180, true, true},
                               "an angle between 0 and 180 degrees (both excluded)");
    camera.ortho_height = reader.number("--ortho-height", kPositive, "a height above 0");
    camera.oblique_angle = reader.number("--oblique-angle", kAnyNumber, "an angle in degrees");
    camera.zoom = reader.number("--zoom", kPositive, "a factor above 0");
    camera.near_plane = reader.number("--near", kAnyNumber, "a distance");
    camera.far_plane = reader.number("--far", kAnyNumber, "a distance");
    check_camera(reader, camera);
    return camera;
}

CameraOptions merge_cameras(const CameraOptions& under, const CameraOptions& over) {
    CameraOptions merged = under;
    const bool new_gaze = over.direction || over.view;
    if (new_gaze) merged.direction = std::nullopt, merged.view = std::nullopt;
    const auto take = [](auto& to, const auto& from) {
        if (from) to = from;
    };
    take(merged.eye, over.eye);
    take(merged.target, over.target);
    take(merged.up, over.up);
    take(merged.direction, over.direction);
    take(merged.view, over.view);
    take(merged.projection, over.projection);
    take(merged.fov, over.fov);
    take(merged.ortho_height, over.ortho_height);
    take(merged.oblique_angle, over.oblique_angle);
    take(merged.zoom, over.zoom);
    take(merged.near_plane, over.near_plane);
    take(merged.far_plane, over.far_plane);
    // Eye and target leave no choice of the gaze: what is older gives way.
    if (merged.eye && merged.target && (merged.direction || merged.view)) {
        if (!new_gaze) {
            merged.direction = std::nullopt, merged.view = std::nullopt;
        } else if (!over.eye) {
            merged.eye = std::nullopt;
        } else if (!over.target) {
            merged.target = std::nullopt;
        }
    }
    return merged;
}

CameraOptions merge_cameras(const Scene& scene, const CameraOptions& asked) {
    return merge_cameras(scene.camera.value_or(CameraOptions{}), asked);
}

Result<Camera> camera_for(const Scene& scene, const CameraOptions& asked, Resolution resolution) {
    return make_camera(merge_cameras(scene, asked), scene, resolution);
}

Resolution read_resolution(OptionReader& reader, Resolution fallback, std::uint64_t max_pixels) {
    const auto text = reader.arguments().value("--resolution");
    if (!text) return fallback;
    const auto size = parse_size(*text);
    if (!size || size->x == 0 || size->y == 0) {
        reader.fail(
            wrong_use("--resolution: '{}' is not a size in pixels, as in --resolution "
                      "1920x1080",
                      *text));
    } else if (size->x > kMaxSide || size->y > kMaxSide) {
        reader.fail(wrong_use("--resolution: '{}' is over {} pixels a side; choose a smaller one",
                              *text, kMaxSide));
    } else if (size->x * size->y > max_pixels) {
        reader.fail(wrong_use("--resolution: '{}' is over 2^28 pixels in all; choose a smaller one",
                              *text));
    } else {
        return {static_cast<std::uint32_t>(size->x), static_cast<std::uint32_t>(size->y)};
    }
    return fallback;
}

std::string_view name_of(Cull cull) {
    return kCullNames[static_cast<std::size_t>(std::find(kCulls.begin(), kCulls.end(), cull) -
                                               kCulls.begin())];
}

Cull read_cull(OptionReader& reader, Cull fallback) {
    const auto index = reader.choice("--cull", kCullNames);
    return index ? kCulls[*index] : fallback;
}

Models read_models(OptionReader& reader, bool required) {
    Models models;
    const Arguments& arguments = reader.arguments();
    models.paths = arguments.models();
    if (models.paths.empty() && required) {
        reader.fail(
            wrong_use("no model given; name a file, as in bunny.obj, or '-' for standard "
                      "input"));
    }
    if (const auto format = arguments.value("--format")) {
        const std::vector<std::string> extensions = loadable_extensions();
        const std::vector<std::string_view> names(extensions.begin(), extensions.end());
        if (std::find(names.begin(), names.end(), *format) == names.end()) {
            reader.fail(wrong_use("--format: '{}' is not a format that can be read; {}", *format,
                                  did_you_mean(*format, names, "try obj, ply, stl, off or glb")));
        }
        models.options.format = *format;
    }
    models.options.weld =
        reader
            .number("--weld", {0, kLargestWeld},
                    fmt::format("a part of the size from 0 to {}, as in --weld 1e-5", kLargestWeld))
            .value_or(kWeldTolerance);
    models.options.allowed_paths = arguments.values("--allow-path");
    for (const std::string& folder : models.options.allowed_paths) {
        std::error_code error;
        if (std::filesystem::is_directory(folder, error)) continue;
        reader.fail(wrong_use("--allow-path: '{}' is not a folder; name one that exists", folder));
    }
    if (std::find(models.paths.begin(), models.paths.end(), "") != models.paths.end()) {
        reader.fail(wrong_use("the name of a model is empty; name a file, as in bunny.obj"));
    }
    const auto inputs = std::count(models.paths.begin(), models.paths.end(), "-");
    if (inputs > 1) reader.fail(wrong_use("the model '-' (standard input) can be read only once"));
    if (inputs == 1 && models.options.format.empty()) {
        reader.fail(wrong_use("the model '-' (standard input) needs --format, as in --format obj"));
    }
    check_report(reader, models.paths);
    models.options.outputs = {kStandardOutput};  // for the files that models name
    return models;
}

}  // namespace sightline::cli
