// The entry: which file, which format, which reader; everything else is done elsewhere.
#include "sightline/load.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <new>
#include <set>
#include <string_view>
#include <system_error>

#include "math/thread_failure.hpp"
#include "scene/finish.hpp"
#include "scene/load/assimp_reader.hpp"
#include "scene/load/build.hpp"
#include "scene/load/foreign_reader.hpp"
#include "scene/load/input.hpp"
#include "scene/load/reader.hpp"
#include "scene/load/scene_file.hpp"
#include "scene/load/sniff.hpp"
#include "scene/load/text.hpp"

namespace sightline {
namespace load {
namespace {

Error bad_input(std::string message) { return {ErrorKind::bad_input, std::move(message)}; }

/// An error when the bytes are a text in UTF-16, which our readers can't read. A binary STL file
/// may begin with any bytes.
Status check_encoding(std::string_view bytes, const std::string& name, std::string_view format) {
    const bool for_us = format == "json" || has_own_reader(format);
    if (!for_us || !is_utf16(bytes) || sniff_format(bytes, bytes.size()) == format) {
        return success();
    }
    return bad_input(fmt::format("{}: it {}", name, kUtf16Reason));
}

Result<Soup> read_soup(const Source& source, const LoadOptions& options) {
    if (has_own_reader(source.format)) {
        const ReadContext context(source.name, source.path, options.time_limit_seconds,
                                  options.memory_limit_bytes, options.allowed_paths);
        return read_own_format(source.format, text_of(source.bytes), context);
    }
    return read_foreign(source, options);
}

Error unknown_format(const std::string& name, const std::string& format) {
    const std::string what =
        format.empty() ? "no extension that tells its format" : "unknown format '" + format + "'";
    return bad_input(
        fmt::format("{}: {}; known ones are obj, ply, stl, off, gltf, glb, dae, fbx, 3ds, "
                    "json and more (or name it with --format)",
                    name, what));
}

/// Links followed; one spelling for one file.
std::filesystem::path whole_path(const std::string& path) {
    std::error_code ignored;
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path, ignored), ignored);
}

/// The error about a file that can't be read and looks like one of another format.
std::optional<Error> other_format(const Source& source) {
    constexpr std::size_t kLooked = 4096;
    std::size_t size = source.bytes.size();
    const std::span<const std::byte> looked = source.bytes.first(std::min(size, kLooked));
    std::vector<std::byte> beginning(looked.begin(), looked.end());
    if (beginning.empty()) {
        std::error_code error;
        size = static_cast<std::size_t>(std::filesystem::file_size(source.path, error));
        const Result<InputFile> file = InputFile::open(source.path, size);
        if (error || !file) return std::nullopt;
        Result<std::vector<std::byte>> bytes = file->read_beginning(kLooked);
        if (bytes) beginning = std::move(*bytes);
    }
    const std::string format = sniff_format(text_of(beginning), size);
    if (!is_other_format(source.format, format)) return std::nullopt;
    return bad_input(
        fmt::format("{}: not a readable {} file: it looks like {}; rename it or give "
                    "--format {}",
                    source.name, source.format, format, format));
}

/// Passes on what became of reading a source, or says that it looks like another format where that
/// explains the failure.
Status or_other_format(Status outcome, const Source& source) {
    if (outcome || outcome.error().kind != ErrorKind::bad_input) return outcome;
    return other_format(source).value_or(outcome.error());
}

/// Loads one file after another into one scene.
class Loader {
public:
    explicit Loader(const LoadOptions& options)
        : options_(options), builder_(options.memory_limit_bytes) {
        std::error_code ignored;
        for (const std::string& path : options.outputs) {
            // What does not exist is no input, and what is written to a device overwrites nothing.
            if (!std::filesystem::is_regular_file(path, ignored)) continue;
            outputs_.insert(whole_path(path));
        }
    }

    [[nodiscard]] Status add_path(const std::string& path);
    [[nodiscard]] Status add_bytes(std::span<const std::byte> bytes, const std::string& name,
                                   const std::string& format);
    /// What was added since the last call is a part by itself.
    void end_part() { parts_end_.push_back(builder_.object_count()); }
    /// The finished scene; `name` is the file to blame when all of it is one point.
    [[nodiscard]] Result<Scene> finish(const std::string& name);

private:
    [[nodiscard]] Status add_file(const std::string& path, const std::string& format,
                                  const Placement& placement);
    /// An error when the file is to be written.
    [[nodiscard]] Status check_input(const std::string& path, const std::string& model);
    /// `bytes`, if any, hold those of the source; they are freed when they have been read.
    [[nodiscard]] Status add_source(Source source, const Placement& placement,
                                    std::vector<std::byte>* bytes = nullptr);
    [[nodiscard]] Status add_scene(std::string_view text, const std::string& name,
                                   const std::filesystem::path& folder);

    const LoadOptions& options_;
    SceneBuilder builder_;
    std::vector<SurfaceEntry> surfaces_;
    std::vector<Motion> motions_;
    std::vector<Light> lights_;
    std::optional<CameraOptions> camera_;
    std::vector<std::uint32_t> parts_end_;     // one beyond the last object of each part
    std::set<std::filesystem::path> outputs_;  // LoadOptions::outputs, one spelling for one file
};

Placement placement_of(const std::string& name) {
    Placement placement;
    placement.file = name;
    placement.default_name = stem_of(name);
    return placement;
}

Status Loader::add_path(const std::string& path) {
    if (path == "-") {
        if (options_.format.empty()) {
            return Error{ErrorKind::bad_option,
                         "standard input: its format is not known; name it with --format, such as "
                         "--format obj"};
        }
        const Result<std::vector<std::byte>> bytes =
            read_descriptor(STDIN_FILENO, "standard input", options_.file_limit_bytes);
        if (!bytes) return bytes.error();
        return add_bytes(*bytes, "standard input", options_.format);
    }
    const std::string format = options_.format.empty() ? extension_of(path) : options_.format;
    return add_file(path, format, placement_of(path));
}

Status Loader::add_bytes(std::span<const std::byte> bytes, const std::string& name,
                         const std::string& format) {
    if (bytes.empty()) return bad_input(fmt::format("{}: it is empty; give it a model", name));
    if (Status fits = check_encoding(text_of(bytes), name, format); !fits) return fits;
    if (format == "json") return add_scene(text_of(bytes), name, {});
    return add_source({name, "", format, bytes, options_.allowed_paths}, placement_of(name));
}

Status Loader::add_file(const std::string& path, const std::string& format,
                        const Placement& placement) {
    if (Status free = check_input(path, path); !free) return free;
    Result<InputFile> file = InputFile::open(path, options_.file_limit_bytes);
    if (!file) return file.error();
    const bool is_scene = format == "json";
    // assimp reads regular files itself. What is none (a pipe) can be read only once.
    const bool whole = is_scene || has_own_reader(format) || !file->is_regular();
    Result<std::vector<std::byte>> bytes = whole ? file->read_all() : file->read_beginning(1);
    if (!bytes) return bytes.error();
    if (bytes->empty()) return bad_input(fmt::format("{}: it is empty; give it a model", path));
    if (Status fits = check_encoding(text_of(*bytes), path, format); !fits) return fits;
    if (is_scene) {
        Status added = add_scene(text_of(*bytes), path, std::filesystem::path(path).parent_path());
        return or_other_format(std::move(added), {path, "", format, *bytes, {}});
    }
    Source source{path, file->is_regular() ? path : "", format, {}, options_.allowed_paths};
    if (whole) source.bytes = *bytes;
    return add_source(source, placement, &*bytes);
}

Status Loader::add_source(Source source, const Placement& placement,
                          std::vector<std::byte>* bytes) {
    if (!has_own_reader(source.format) &&
        !std::ranges::binary_search(assimp_extensions(), source.format)) {
        return unknown_format(source.name, source.format);
    }
    // assimp reads a file by its content if it does not fit its name.
    if (!has_own_reader(source.format) && can_sniff(source.format)) {
        if (std::optional<Error> other = other_format(source)) return *std::move(other);
    }
    const Result<Soup> soup = read_soup(source, options_);
    if (!soup) return or_other_format(soup.error(), source);
    if (bytes != nullptr) {
        source.bytes = {};
        std::vector<std::byte>().swap(*bytes);
    }
    for (const std::string& file : soup->files)
        if (Status free = check_input(file, source.name); !free) return free;
    return or_other_format(builder_.append(*soup, placement), source);
}

Status Loader::check_input(const std::string& path, const std::string& model) {
    // Models name many files that are not there, for which the first test is enough.
    std::error_code ignored;
    if (outputs_.empty() || !std::filesystem::is_regular_file(path, ignored) ||
        !outputs_.contains(whole_path(path))) {
        return success();
    }
    return Error{ErrorKind::bad_option,
                 fmt::format("'{}' is an input{}, which would be overwritten; choose another name "
                             "for the output",
                             path, path == model ? "" : fmt::format(" of '{}'", model))};
}

Status Loader::add_scene(std::string_view text, const std::string& name,
                         const std::filesystem::path& folder) {
    Result<SceneDescription> scene = parse_scene_description(text, name);
    if (!scene) return scene.error();
    for (const ModelEntry& model : scene->models) {
        const std::string path = (folder / model.path).string();
        Placement placement = placement_of(path);
        placement.name = model.name;
        placement.transform = model.transform;
        placement.material = model.material;
        const std::uint32_t first = builder_.object_count();
        Status added = add_file(path, extension_of(path), placement);
        if (!added) return added;
        if (model.frames.empty()) continue;
        motions_.push_back({first, builder_.object_count() - first, model.frames});
    }
    surfaces_.insert(surfaces_.end(), scene->surfaces.begin(), scene->surfaces.end());
    lights_.insert(lights_.end(), scene->lights.begin(), scene->lights.end());
    if (scene->camera && camera_) {
        return bad_input(
            fmt::format("{}: camera: another scene file has one already; keep one", name));
    }
    if (scene->camera) camera_ = scene->camera;
    return success();
}

/// Whether all frames stay where later stages can compute.
bool is_moderate(const Box& reach) {
    for (int axis = 0; axis < 3; ++axis) {
        if (!(reach.lo[axis] >= -kLargestCoordinate && reach.hi[axis] <= kLargestCoordinate)) {
            return false;
        }
    }
    return true;
}

Result<Scene> Loader::finish(const std::string& name) {
    Scene scene = builder_.take();
    for (std::uint32_t part = 0, o = 0; part < parts_end_.size(); ++part)
        for (; o < parts_end_[part]; ++o) scene.objects[o].part = part;
    for (const SurfaceEntry& surface : surfaces_) {
        Material material;
        apply(surface.material, material);
        add_quadric(scene, surface.quadric, clean_text(surface.name), material);
        if (surface.frames.empty()) continue;
        motions_.push_back(
            {static_cast<std::uint32_t>(scene.objects.size()) - 1, 1, surface.frames});
    }
    scene.motions = std::move(motions_);
    scene.lights = std::move(lights_);
    scene.camera = camera_;
    finish_joined_scene(scene, {options_.offset, options_.weld,
                                options_.find_sheets ? FindSheets::yes : FindSheets::no});
    if (!is_moderate(scene.reach)) {
        return bad_input(fmt::format(
            "{}: the frames of a model take it beyond 1e30; use smaller numbers", name));
    }
    if (scene.bounds.lo == scene.bounds.hi) {
        const glm::dvec3 p = scene.bounds.lo + scene.offset;
        return bad_input(
            fmt::format("{}: a scene of one point: every corner is at ({:g}, {:g}, {:g}); "
                        "use a model that has a size",
                        name, p.x, p.y, p.z));
    }
    const glm::dvec3 extent = scene.bounds.extent();
    const double size = std::max({extent.x, extent.y, extent.z});
    if (size < kLeastSize) {
        return bad_input(
            fmt::format("{}: a scene of size {:g}, and none below {:g} can be drawn; "
                        "use larger numbers",
                        name, size, kLeastSize));
    }
    return scene;
}

/// Runs `load` and turns what it throws into an error: nothing leaves the library but values.
template <class Load>
auto guarded(const std::string& name, const Load& load) -> decltype(load()) {
    try {
        return load();
    } catch (const std::bad_alloc&) {
        return Error{ErrorKind::io,
                     fmt::format("{}: not enough memory; free some or use a smaller model", name)};
    } catch (const std::exception& exception) {
        if (const auto text = thread_failure(exception)) return Error{ErrorKind::io, *text};
        return Error{ErrorKind::io, fmt::format("{}: {}; try again or report it", name,
                                                one_line(exception.what()))};
    }
}

/// Millions of cameras.
constexpr std::size_t kCameraPathLimit = std::size_t{1} << 30;

}  // namespace
}  // namespace load

Result<Scene> load_scene(std::span<const std::string> paths, const LoadOptions& options) {
    if (paths.empty())
        return Error{ErrorKind::bad_option, "no model given; name at least one file"};
    return load::guarded(paths[0], [&]() -> Result<Scene> {
        load::Loader loader(options);
        for (const std::string& path : paths) {
            if (Status added = loader.add_path(path); !added) return added.error();
            loader.end_part();
        }
        return loader.finish(paths[0]);
    });
}

Result<Scene> load_scene_from_memory(std::span<const std::byte> bytes, const std::string& name,
                                     const LoadOptions& options) {
    return load::guarded(name, [&]() -> Result<Scene> {
        load::Loader loader(options);
        if (Status added = loader.add_bytes(bytes, name, options.format); !added) {
            return added.error();
        }
        return loader.finish(name);
    });
}

Result<std::vector<CameraOptions>> load_camera_path(const std::string& path) {
    return load::guarded(path, [&]() -> Result<std::vector<CameraOptions>> {
        Result<load::InputFile> file = load::InputFile::open(path, load::kCameraPathLimit);
        if (!file) return file.error();
        const Result<std::vector<std::byte>> bytes = file->read_all();
        if (!bytes) return bytes.error();
        return load::parse_camera_path(load::text_of(*bytes), path);
    });
}

std::vector<std::string> loadable_extensions() {
    std::vector<std::string> extensions = load::assimp_extensions();
    extensions.insert(std::ranges::upper_bound(extensions, "json"), "json");
    return extensions;
}

}  // namespace sightline
