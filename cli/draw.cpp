// `sightline draw`: an exact vector drawing of a model.
#include <algorithm>
#include <array>
#include <cmath>

#include "drawing_output.hpp"
#include "errors.hpp"
#include "outputs.hpp"
#include "progress.hpp"
#include "report.hpp"
#include "sightline/sightline.hpp"
#include "tessellate.hpp"
#include "trace_options.hpp"
#include "view_notes.hpp"

namespace sightline::cli {
namespace {

struct DrawCommandOptions {
    CommonOptions common;
    Models models;
    CameraOptions camera;
    Resolution resolution;
    std::optional<Cull> cull;
    TraceOptions trace;
    bool guides = false;  ///< --vanishing-points
    DrawingOutput drawing;
};

// -- options -----------------------------------------------------------------------------------

void read_edges(OptionReader& reader, TraceOptions& trace) {
    const auto text = reader.arguments().value("--edges");
    if (!text) return;
    trace.edges = {};
    constexpr std::array kKinds = {EdgeKind::silhouette, EdgeKind::boundary, EdgeKind::border,
                                   EdgeKind::crease, EdgeKind::intersection};
    const auto add = [&](EdgeKinds kinds) {
        for (std::size_t k = 0; k < kEdgeKinds; ++k)
            if (kinds.has(static_cast<EdgeKind>(k))) trace.edges.add(static_cast<EdgeKind>(k));
    };
    for (const std::string_view name : split_list(*text)) {
        const auto* const kind =
            std::ranges::find(kKinds, name, [](EdgeKind k) { return name_of(k); });
        if (name == "all") {
            add(kFeatureEdges);
        } else if (name == "mesh") {
            add(kMeshEdges);
        } else if (kind != kKinds.end()) {
            trace.edges.add(*kind);
        } else if (name != "none") {
            reader.fail(
                wrong_use("--edges: '{}' is unknown; choose from all, mesh, none, silhouette, "
                          "boundary, crease, border, intersection",
                          name));
        }
    }
}

void read_look(OptionReader& reader, DrawCommandOptions& options) {
    constexpr std::array<std::string_view, 4> kFills = {"none", "flat", "material", "lambert"};
    read_edges(reader, options.trace);
    options.trace.crease_angle =
        reader.number("--crease-angle", {0, 180}, "an angle from 0 to 180 degrees").value_or(30);
    if (const auto fill = reader.choice("--fill", kFills)) {
        options.trace.fill = static_cast<FillStyle>(*fill);
    }
    options.trace.method = read_method(reader);
    options.guides = reader.arguments().has("--vanishing-points");
    if (reader.arguments().has("--cull")) options.cull = read_cull(reader, Cull::automatic);
}

Result<DrawCommandOptions> read_options(const Arguments& arguments) {
    OptionReader reader(arguments);
    DrawCommandOptions options;
    options.models = read_models(reader);
    options.camera = read_camera(reader);
    options.resolution = read_resolution(reader, Resolution{}, kAnyNumberOfPixels);
    read_look(reader, options);
    options.common = read_common(reader);
    options.trace.threads = options.common.threads;
    options.drawing =
        read_drawing_output(reader, options.resolution, options.common, options.models.paths);
    options.models.options.outputs.push_back(options.drawing.file.path);
    options.trace.hidden = options.drawing.hidden;
    if (reader.error()) return *reader.error();
    return options;
}

// -- the work ----------------------------------------------------------------------------------

struct Times {
    double load = 0, project = 0, draw = 0, write = 0;
};

/// The hidden backs of what is closed hide nothing, but their edges are wanted with hidden lines.
Cull cull_of(const DrawCommandOptions& options) {
    return options.cull.value_or(options.trace.hidden ? Cull::none : Cull::automatic);
}

std::vector<std::string> names_of(const Scene& scene) {
    std::vector<std::string> names;
    for (const Object& object : scene.objects) names.push_back(object.name);
    return names;
}

std::vector<Row> report_rows(const Times& times, const Drawing& drawing,
                             const VectorCounts& written) {
    const DrawingCounts& c = drawing.counts;
    return {
        {"load_ms", "load", milliseconds(times.load), "ms"},
        {"project_ms", "project", milliseconds(times.project), "ms"},
        {"draw_ms", "find what is visible", milliseconds(times.draw), "ms"},
        {"write_ms", "write", milliseconds(times.write), "ms"},
        {"edges", "edges tested", c.edges, ""},
        {"intersections", "edges on which surfaces cross", c.intersections, ""},
        {"occluder_tests", "edges against triangles", c.occluder_tests, ""},
        {"visible_segments", "visible segments", c.visible_segments, ""},
        {"hidden_segments", "hidden segments", c.hidden_segments, ""},
        {"visible_paths", "visible paths", written.visible_paths, ""},
        {"hidden_paths", "hidden paths", written.hidden_paths, ""},
        {"visible_length", "visible length", written.visible_length, "units of the page"},
        {"hidden_length", "hidden length", written.hidden_length, "units of the page"},
        {"regions", "regions", std::uint64_t{drawing.regions.size()}, ""},
        {"faces_whole", "triangles wholly visible", c.faces_whole, ""},
        {"faces_partly", "triangles partly visible", c.faces_partly, ""},
        {"faces_hidden", "triangles hidden", c.faces_hidden, ""},
        {"peak_rss_mb", "peak memory", std::round(10 * peak_memory_mib()) / 10, "MiB"},
    };
}

// -- what a user should know ------------------------------------------------------------------

void warn_of_options(const Notes& notes, const Arguments& arguments,
                     const DrawCommandOptions& options, const Camera& camera) {
    const bool no_lines = options.trace.edges.empty() && !options.guides;
    const IdleOption own[] = {
        {"--crease-angle", !options.trace.edges.has(EdgeKind::crease), "no creases are drawn"},
        {"--hidden", options.trace.hidden && options.trace.edges.empty(), "no edges are drawn"},
        {"--stroke", no_lines, "no lines are drawn"},
        {"--sort", no_lines, "no lines are drawn"},
        {"--vanishing-points", !camera.is_perspective(), "a parallel view has none"},
        {"--background", options.drawing.file.format == VectorFormat::dxf, "a DXF has none"},
    };
    notes.warn_of_options(arguments, own);
    notes.warn_of_options(arguments, idle_camera_options({{camera.projection}}));
}

void warn_of_view(const Notes& notes, const DrawCommandOptions& options, const Scene& scene,
                  const ScreenScene& page, bool blank) {
    if (blank && options.trace.edges.empty() && options.trace.fill == FillStyle::none) {
        notes.warn("the drawing is blank: neither --edges nor --fill are to be drawn");
        return;
    }
    ViewNotes view;
    view.add({subject_of(scene), merge_cameras(scene, options.camera), page.camera(), page.counts(),
              blank});
    view.print(notes, "the drawing is blank");
}

Result<int> run(const Arguments& arguments) {
    Result<DrawCommandOptions> parsed = read_options(arguments);
    if (!parsed) return parsed.error();
    DrawCommandOptions& options = *parsed;
    Progress progress(options.common.quiet);
    Stopwatch watch;
    Times times;

    const auto scene = load_for_drawing(options.models, options.common.quiet, progress);
    if (!scene) return scene.error();
    const auto camera = camera_for(*scene, options.camera, options.resolution);
    if (!camera) return camera.error();
    const auto layout = lay_out(options.drawing.page, *camera);
    if (!layout) return layout.error();
    times.load = watch.lap();

    progress.stage("projecting");
    const auto page = page_of(*scene, *camera, {cull_of(options), options.common.threads});
    if (!page) return page.error();
    times.project = watch.lap();

    show_progress(progress, options.trace);
    Result<Drawing> drawing = trace(*page, options.trace);
    if (!drawing) return drawing.error();
    if (options.guides) drawing->guides = vanishing_guides(*camera, scene->bounds);
    times.draw = watch.lap();

    progress.stage("writing");
    VectorCounts written;
    VectorOptions vector = vector_options(options.drawing, *layout);
    vector.object_names = names_of(*scene);
    vector.counts = &written;
    const VectorOutput& output = options.drawing.file;
    const Status done = write_drawing(output.path, output.format, *drawing, vector);
    if (!done) return done.error();
    times.write = watch.lap();
    progress.clear();
    const Notes notes(options.common.quiet, progress);
    warn_of_options(notes, arguments, options, *camera);
    warn_of_view(notes, options, *scene, *page,
                 written.visible_paths + written.hidden_paths + drawing->regions.size() +
                         drawing->guides.size() ==
                     0);
    const auto rows = report_rows(times, *drawing, written);
    if (Status told = print_rows(rows, options.common.stats, options.common.json); !told)
        return told.error();
    return 0;
}

const std::array kLookRows = {
    Option{"--edges", "LIST",
           "silhouette, boundary, crease, border, intersection; all of these (default); mesh: "
           "every polygon edge of the file; none"},
    Option{"--crease-angle", "DEG",
           "edges between faces that meet at more are drawn (default: 30)"},
    kHiddenOption,
    Option{"--fill", "none|flat|material|lambert",
           "fill what is visible of each face: grey, its colour, its colour in the light"},
    Option{"--vanishing-points", "", "lines from the model's box to its vanishing points"},
    kMethodOption,
    kCullOption,
};

const std::array kGroups = {
    OptionGroup{"Output", kDrawingOutputOptions}, OptionGroup{"Drawing", kLookRows},
    OptionGroup{"Camera", kCameraOptions}, OptionGroup{"Input", kModelOptions},
    OptionGroup{"Common", kCommonOptions}};

constexpr std::array kExamples = {
    Example{"sightline draw bunny.obj -o bunny.svg", "outlines and creases that can be seen"},
    Example{"sightline draw part.stl --hidden dashed --projection orthographic --page a4 --scale "
            "1:2 --stroke 0.35 -o part.pdf",
            "a technical drawing at half size"},
    Example{"sightline draw house.obj --fill lambert --edges all -o house.svg",
            "lines over shaded regions, one region a face"},
    Example{"sightline draw mesh.ply --edges mesh --sort -o mesh.dxf", "every edge, for a plotter"},
};

}  // namespace

const Command kDraw = {"draw",
                       "exact vector drawing of a model",
                       "MODEL...",
                       "Draws the edges of one or several models (or a scene.json) and where their "
                       "surfaces cross, as\nfar as they can be seen, exactly, whatever the size of "
                       "the drawing. It lies over the picture\nthat `render` makes with the same "
                       "camera.",
                       kGroups,
                       kExamples,
                       run};

}  // namespace sightline::cli
