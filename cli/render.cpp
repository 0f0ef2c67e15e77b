// `sightline render`: a picture of a model, with maps of depth, ids, normals and coverage.
#include <algorithm>
#include <array>
#include <cmath>

#include "errors.hpp"
#include "progress.hpp"
#include "render_frames.hpp"
#include "render_stream.hpp"
#include "report.hpp"
#include "sightline/sightline.hpp"
#include "suggest.hpp"
#include "tessellate.hpp"

namespace sightline::cli {
namespace {

constexpr std::array kPictureFormats = {ImageFormat::png, ImageFormat::exr, ImageFormat::npy};
constexpr std::string_view kTreePieces = "bsp pieces";  // what the algorithm counts
constexpr std::array kMaskFormats = {ImageFormat::npy, ImageFormat::png};

// -- options -----------------------------------------------------------------------------------

void read_shading(OptionReader& reader, RenderOptions& options) {
    std::array<std::string_view, 7> names;
    for (std::size_t i = 0; i < names.size(); ++i) names[i] = name_of(static_cast<Shading>(i));
    if (const auto index = reader.choice("--shading", names)) {
        options.shading = static_cast<Shading>(*index);
    }
    options.crease_angle =
        reader.number("--crease-angle", {0, 180}, "an angle from 0 to 180 degrees")
            .value_or(options.crease_angle);
    options.background = reader.color("--background").value_or(options.background);
    options.opacity = read_opacity(reader);
    for (const std::string& name : reader.arguments().values("--holdout")) {
        if (name.empty())
            reader.fail(wrong_use("--holdout: the name is empty; name a material or an object"));
        options.holdouts.push_back(name);
    }
}

void read_layers(OptionReader& reader, RenderOptions& options) {
    const auto text = reader.arguments().value("--aov");
    if (!text) return;
    for (const std::string_view name : split_list(*text)) {
        if (name == "normals") {
            options.layers.normals = true;
        } else if (name == "ids") {
            options.layers.ids = true;
        } else {
            reader.fail(wrong_use("--aov: '{}' is unknown; choose from normals, ids", name));
        }
    }
    const bool has_exr =
        std::any_of(options.outputs.begin(), options.outputs.end(), [](const PictureOutput& p) {
            return p.content == PictureContent::color && p.output.format == ImageFormat::exr;
        });
    if (!has_exr) {
        reader.fail(wrong_use("--aov needs an EXR picture; write to a name like -o picture.exr"));
    }
}

/// After the outputs, the algorithm and --samples.
void read_deep(OptionReader& reader, RenderOptions& options) {
    options.deep = reader.arguments().has("--deep");
    if (!options.deep) return;
    const auto color = std::ranges::find_if(
        options.outputs, [](const PictureOutput& p) { return p.content == PictureContent::color; });
    if (color == options.outputs.end() || color->output.format != ImageFormat::exr) {
        reader.fail(wrong_use("--deep needs an EXR picture; write to a name like -o picture.exr"));
    } else if (options.algorithm->open_fragments == nullptr) {
        reader.fail(wrong_use("--deep: '{}' keeps one surface a sample; take --algorithm abuffer",
                              options.algorithm->name));
    } else if (!options.by_area) {
        reader.fail(
            wrong_use("--deep: deep pictures hold areas, not samples; leave out --samples"));
    } else if (options.shading && !antialiases(*options.algorithm, *options.shading)) {
        reader.fail(
            wrong_use("--deep: --shading {} shows numbers, which have no layers; take "
                      "another shading",
                      name_of(*options.shading)));
    } else if (options.layers.normals || options.layers.ids) {
        reader.fail(wrong_use("--aov: a deep picture has ids and no normals; leave it out"));
    }
}

void read_outputs(OptionReader& reader, RenderOptions& options) {
    std::vector<Output> outputs;
    const auto read = [&](PictureContent content, std::string_view option, auto formats) {
        auto output = read_output<ImageFormat>(reader, option, formats);
        if (!output) return;
        outputs.push_back(*output);
        options.outputs.push_back({content, std::move(*output)});
    };
    read(PictureContent::color, "--output", std::span(kPictureFormats));
    read(PictureContent::depth, "--depth", std::span(kPictureFormats));
    read(PictureContent::ids, "--ids", std::span(kPictureFormats));
    read(PictureContent::normals, "--normals", std::span(kPictureFormats));
    read(PictureContent::mask, "--mask", std::span(kMaskFormats));
    read(PictureContent::matte, "--matte", std::span(kMaskFormats));
    if (outputs.empty()) {
        reader.fail(
            wrong_use("nothing to write; name a file, as in -o picture.png (or --depth, "
                      "--ids, --normals, --mask, --matte)"));
    }
    check_frame_outputs(reader, options, outputs);
    const bool to_stdout = std::any_of(outputs.begin(), outputs.end(),
                                       [](const Output& output) { return output.path == "-"; });
    if (to_stdout && options.common.json) {
        reader.fail(
            wrong_use("--json would mix with the picture on standard output; write the "
                      "picture to a file"));
    }
    read_layers(reader, options);
    read_deep(reader, options);
}

Result<RenderOptions> read_options(const Arguments& arguments) {
    OptionReader reader(arguments);
    RenderOptions options;
    options.models = read_models(reader);
    options.camera = read_camera(reader);
    const auto chosen = reader.algorithms("--algorithm");
    if (chosen.size() > 1) reader.fail(wrong_use("--algorithm: give one; `compare` takes several"));
    options.algorithm = chosen.empty() ? &default_algorithm() : chosen.front();
    options.cull = read_cull(reader, Cull::automatic);
    read_size(reader, options);
    read_shading(reader, options);
    options.common = read_common(reader);
    read_frames(reader, options);
    read_tree_files(reader, options);
    read_outputs(reader, options);
    read_stream(reader, options);
    if (reader.error()) return *reader.error();
    return options;
}

// -- the work ----------------------------------------------------------------------------------

Result<Scene> load(const RenderOptions& options, Progress& progress) {
    Result<Scene> scene = load_scene(options.models.paths, options.models.options);
    if (!scene) return scene;
    if (Status done = apply_opacity(*scene, options.opacity); !done) return done.error();
    if (Status done = apply_holdouts(*scene, options.holdouts); !done) return done.error();
    if (!options.algorithm->quadrics) {
        tessellate_for(fmt::format("'{}' takes triangles only", options.algorithm->name), *scene,
                       options.common.quiet, progress);
    }
    if (options.shading && is_smooth(*options.shading)) make_normals(*scene, options.crease_angle);
    return scene;
}

// -- what is reported --------------------------------------------------------------------------

std::vector<Row> time_rows(const RenderOptions& options, const Scene& scene, double load_ms,
                           const Rendered& rendered) {
    std::vector<Row> rows = {{"load_ms", "load", milliseconds(load_ms), "ms"}};
    if (options.algorithm->name == kTreeAlgorithm) {
        rows.push_back({"tree_ms", "build or load the tree", milliseconds(rendered.tree), "ms"});
    }
    if (!scene.motions.empty()) {
        rows.push_back({"pose_ms", "move objects", milliseconds(rendered.pose), "ms"});
    }
    rows.push_back({"project_ms", "project", milliseconds(rendered.project), "ms"});
    rows.push_back({"resolve_ms", "resolve", milliseconds(rendered.drawn.resolve), "ms"});
    rows.push_back({"shade_ms", "shade", milliseconds(rendered.drawn.shade), "ms"});
    rows.push_back({"write_ms", "write", milliseconds(rendered.drawn.write), "ms"});
    if (options.frames.count > 0) {
        rows.push_back({"frames", "frames", options.frames.end - options.frames.first, ""});
    }
    return rows;
}

std::vector<Row> report_rows(const RenderOptions& options, Shading shading, const Scene& scene,
                             double load_ms, const Rendered& rendered) {
    const ProjectCounts& counts = rendered.counts;
    const double culled = rendered.candidates > 0 ? 100 * static_cast<double>(counts.culled) /
                                                        static_cast<double>(rendered.candidates)
                                                  : 0;
    std::vector<Row> rows = time_rows(options, scene, load_ms, rendered);
    const Row more[] = {
        {"algorithm", "algorithm", options.algorithm->name, ""},
        {"shading", "shading", name_of(shading), ""},
        {"width", "width", options.resolution.width, "pixels"},
        {"height", "height", options.resolution.height, "pixels"},
        {"samples", "samples a pixel", options.by_area ? 0 : options.per_axis * options.per_axis,
         ""},
        {"objects", "objects", std::uint64_t{scene.objects.size()}, ""},
        {"polygons", "polygons", scene.counts.polygons, ""},
        {"concave_polygons", "concave polygons", scene.counts.concave_polygons, ""},
        {"ignored_primitives", "points and lines ignored", scene.counts.ignored_primitives, ""},
        {"triangles", "triangles", counts.triangles, ""},
        {"quadrics", "surfaces that are not polygons", std::uint64_t{scene.quadrics.size()}, ""},
        {"degenerate_triangles", "degenerate triangles dropped", counts.degenerate, ""},
        {"back_facing", "triangles that face away", rendered.back_facing, ""},
        {"culled", "triangles culled by side", counts.culled, ""},
        {"culled_percent", "share culled", std::round(100 * culled) / 100, "%"},
        {"outside", "triangles outside of the view", counts.outside, ""},
        {"clipped", "triangles clipped", counts.clipped, ""},
        {"pieces", "pieces they left", counts.pieces, ""},
    };
    rows.insert(rows.end(), std::begin(more), std::end(more));
    for (const Counter& counter : rendered.drawn.counters) {
        std::string key = counter.name;
        std::replace(key.begin(), key.end(), ' ', '_');
        rows.push_back({key, counter.name, counter.value, ""});
        if (counter.name == kTreePieces && scene.triangle_count() > 0) {
            const double share = static_cast<double>(counter.value) / scene.triangle_count();
            rows.push_back({"bsp_pieces_per_triangle", "bsp pieces a triangle",
                            std::round(100 * share) / 100, ""});
        }
    }
    rows.push_back({"peak_rss_mb", "peak memory", std::round(10 * peak_memory_mib()) / 10, "MiB"});
    return rows;
}

// -- what a user should know -------------------------------------------------------------------

void warn_about_translucency(const Notes& notes, const RenderOptions& options, const Scene& scene) {
    if (!has_translucent_faces(scene) || options.algorithm->open_layers != nullptr) return;
    const auto* blending = std::ranges::find_if(algorithms(), [](const Algorithm& a) {
                               return a.open_layers != nullptr;
                           }).base();
    notes.warn(
        fmt::format("'{}' can't blend: translucent faces are drawn opaque; take --algorithm {}",
                    options.algorithm->name, blending->name));
}

/// Those of all frames. `own` is the camera of the scene's file.
std::vector<Projection> projections_of(const RenderOptions& options,
                                       const std::optional<CameraOptions>& own) {
    std::vector<Projection> projections;
    const auto add = [&](const CameraOptions& camera) {
        projections.push_back(
            merge_cameras(merge_cameras(own.value_or(CameraOptions{}), camera), options.camera)
                .projection.value_or(Projection::perspective));
    };
    if (options.frames.path.empty()) add({});
    for (const CameraOptions& camera : options.frames.path) add(camera);
    return projections;
}

void warn_of_options(const Notes& notes, const Arguments& arguments, const RenderOptions& options,
                     const std::optional<CameraOptions>& own_camera) {
    const auto writes = [&](auto... contents) {
        return std::ranges::any_of(options.outputs, [&](const PictureOutput& p) {
            return ((p.content == contents) || ...);
        });
    };
    using enum PictureContent;
    const bool shades = writes(color, normals);
    const bool makes_normals = options.shading && is_smooth(*options.shading) && shades;
    const IdleOption own[] = {
        {"--crease-angle", !makes_normals, "normals are made for --shading gouraud and phong only"},
        {"--samples", !writes(color, matte), "maps show what is at the pixels' centres"},
        {"--background", !writes(color) || options.deep,
         options.deep ? "a deep picture has none" : "only a picture has one"},
        {"--shading", !shades, "only a picture is shaded"},
        {"--opacity", !writes(color, matte), "maps show the nearest face"},
        {"--holdout", !writes(color, matte), "maps show all faces"},
    };
    notes.warn_of_options(arguments, own);
    notes.warn_of_options(arguments, idle_camera_options(projections_of(options, own_camera)));
}

Result<int> run(const Arguments& arguments) {
    const Result<RenderOptions> parsed = read_options(arguments);
    if (!parsed) return parsed.error();
    const RenderOptions& options = *parsed;
    Progress progress(options.common.quiet);
    const Notes notes(options.common.quiet, progress);
    const Stopwatch watch;

    if (options.stream) {
        const auto streamed = render_stream(options, notes, progress);
        if (!streamed) return streamed.error();
        warn_of_options(notes, arguments, options, streamed->own_camera);
        if (Status told = print_rows(streamed->rows, options.common.stats, options.common.json);
            !told)
            return told.error();
        return 0;
    }
    progress.stage("loading");
    const Result<Scene> scene = load(options, progress);
    if (!scene) return scene.error();
    const Shading shading = shading_for(options, has_file_normals(*scene));
    notes.warn_of_files(*scene);
    warn_of_options(notes, arguments, options, scene->camera);
    warn_about_translucency(notes, options, *scene);
    const double load_ms = watch.ms();

    const auto rendered = render_frames(options, shading, *scene, progress);
    if (!rendered) return rendered.error();
    progress.clear();
    rendered->views.print(notes, "the picture is blank");
    const auto rows = report_rows(options, shading, *scene, load_ms, *rendered);
    if (Status done = print_rows(rows, options.common.stats, options.common.json); !done)
        return done.error();
    return 0;
}

constexpr std::array kOutputRows = {
    Option{"--output", "FILE", "the picture: .png, .exr or .npy; '-' is standard output", "-o"},
    Option{"--output-format", "NAME", "png, exr or npy, whatever the extension; needed for '-'"},
    Option{"--depth", "FILE", "distance along the gaze: .png (16 bit), .exr or .npy"},
    Option{"--ids", "FILE", "number of the visible triangle: .npy, .exr or .png"},
    Option{"--normals", "FILE", "normals in the world: .npy, .exr or .png"},
    Option{"--mask", "FILE", "where something is seen: .npy or .png"},
    Option{"--matte", "FILE", "how much of each pixel is covered (its alpha): .npy or .png"},
    Option{"--deep", "", "an EXR with all surfaces of each pixel, not only what they make"},
    Option{"--aov", "LIST", "more channels of an EXR picture: normals,ids"},
};

const std::array kLookRows = {
    Option{"--algorithm", "NAME", "how visibility is decided ('sightline algorithms' lists them)"},
    kCullOption,
    Option{"--samples", "N",
           "samples a pixel: 1, 4, 16 or 64 (default: 1; abuffer weighs areas instead)"},
    Option{"--shading", "NAME",
           "flat, gouraud, phong, unlit, depth, normals, ids (default: phong where the file has "
           "normals, else flat)"},
    Option{"--crease-angle", "DEG", "sharper edges split the normals that are made (default: 30)"},
    Option{"--background", "COLOUR", "R,G,B[,A] in 0..255, '#rrggbb[aa]' or none (default: white)"},
    Option{"--holdout", "NAME",
           "a material or object that hides others and leaves a hole; repeatable"},
    Option{"--opacity", "[NAME=]F", "0..1, of everything or of one material or object; repeatable"},
};

constexpr std::array kFrameRows = {
    Option{"--frames", "N", "draw N pictures; '####' in each output's name becomes 0001 to N"},
    Option{"--orbit", "AXIS[,START,END]",
           "turn the camera about x, y or z through its target, in degrees (default: 0,360)"},
    Option{"--path", "FILE", "a JSON list of cameras, one a frame, keys as the options' names"},
    Option{"--frame", "K", "draw only frame K of --frames N"},
};

constexpr std::array kTreeRows = {
    Option{"--bsp-save", "FILE", "keep the tree of --algorithm bsp in a file"},
    Option{"--bsp-load", "FILE", "take the tree from a file, made of the same scene"},
};

constexpr std::array kStreamRows = {
    Option{"--stream", "", "load and draw one model after the other, to save memory"},
};

const std::array kGroups = {
    OptionGroup{"Output", kOutputRows},    OptionGroup{"Picture", kLookRows},
    OptionGroup{"Camera", kCameraOptions}, OptionGroup{"Frames", kFrameRows},
    OptionGroup{"BSP tree", kTreeRows},    OptionGroup{"Input", kModelOptions},
    OptionGroup{"Memory", kStreamRows},    OptionGroup{"Common", kCommonOptions}};

constexpr std::array kExamples = {
    Example{"sightline render bunny.obj -o bunny.png", "the whole model, isometric"},
    Example{"sightline render house.glb --view front --projection orthographic --samples 16 -o "
            "front.png",
            "an antialiased elevation"},
    Example{"sightline render bunny.obj --direction -1,-1,-1 --depth d.npy --ids i.npy",
            "maps for a data set, without a picture"},
    Example{"sightline render glass.obj --opacity 0.4 --algorithm abuffer -o glass.png",
            "transparent, with smooth edges"},
    Example{"sightline render fg.obj --algorithm abuffer --deep -o fg.exr",
            "a deep picture, for sightline composite"},
    Example{"cat bunny.ply | sightline render - --format ply -o - --output-format png > b.png",
            "in a pipe"},
    Example{"sightline render bunny.obj --frames 36 --orbit y -o frame_####.png",
            "a turntable: frame_0001.png to frame_0036.png"},
};

}  // namespace

const Command kRender = {"render",
                         "picture of a model",
                         "MODEL...",
                         "Draws one or several models (or a scene.json) as seen by a camera. "
                         "Without camera options the\n"
                         "whole model is in view.",
                         kGroups,
                         kExamples,
                         run};

}  // namespace sightline::cli
