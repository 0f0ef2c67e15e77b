// `sightline draw`: an exact vector drawing of a model.
#include <algorithm>
#include <array>
#include <cmath>

#include "errors.hpp"
#include "outputs.hpp"
#include "progress.hpp"
#include "report.hpp"
#include "sightline/sightline.hpp"
#include "tessellate.hpp"
#include "trace_options.hpp"

namespace sightline::cli {
namespace {

constexpr std::array kFormats = {VectorFormat::svg, VectorFormat::pdf, VectorFormat::eps,
                                 VectorFormat::dxf, VectorFormat::png};

struct DrawCommandOptions {
    CommonOptions common;
    Models models;
    CameraOptions camera;
    Resolution resolution;
    std::optional<Cull> cull;
    TraceOptions trace;
    bool dashed = true;
    bool guides = false;  ///< --vanishing-points
    PageOptions page;
    double stroke = 1;
    bool sorted = false;
    glm::u8vec4 background{0, 0, 0, 0};
    VectorOutput output;
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
    constexpr std::array<std::string_view, 3> kHidden = {"none", "dashed", "solid"};
    constexpr std::array<std::string_view, 4> kFills = {"none", "flat", "material", "lambert"};
    read_edges(reader, options.trace);
    options.trace.crease_angle =
        reader.number("--crease-angle", {0, 180}, "an angle from 0 to 180 degrees").value_or(30);
    if (const auto hidden = reader.choice("--hidden", kHidden)) {
        options.trace.hidden = *hidden != 0;
        options.dashed = *hidden == 1;
    }
    if (const auto fill = reader.choice("--fill", kFills)) {
        options.trace.fill = static_cast<FillStyle>(*fill);
    }
    options.trace.method = read_method(reader);
    options.stroke = reader.number("--stroke", {0, 1e6, true}, "a width above 0").value_or(1);
    options.background = reader.color("--background").value_or(options.background);
    options.guides = reader.arguments().has("--vanishing-points");
    options.sorted = reader.arguments().has("--sort");
    if (reader.arguments().has("--cull")) options.cull = read_cull(reader, Cull::automatic);
}

/// "a4", "letter" or "WxHmm"; a4 and letter lie or stand as the picture does.
std::optional<glm::dvec2> parse_page(std::string_view text, Resolution resolution) {
    const auto turned = [&](double small, double large) {
        return resolution.width > resolution.height ? glm::dvec2(large, small)
                                                    : glm::dvec2(small, large);
    };
    if (text == "a4") return turned(210, 297);
    if (text == "letter") return turned(215.9, 279.4);
    const std::size_t x = text.find('x');
    if (!text.ends_with("mm") || x == std::string_view::npos) return std::nullopt;
    text.remove_suffix(2);
    const auto width = parse_number(text.substr(0, x)), height = parse_number(text.substr(x + 1));
    if (!width || !height || !(*width > 0 && *height > 0 && *width <= 1e5 && *height <= 1e5))
        return std::nullopt;
    return glm::dvec2(*width, *height);
}

/// "1:50" or "20:1".
std::optional<double> parse_scale(std::string_view text) {
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) return std::nullopt;
    const auto paper = parse_number(text.substr(0, colon)),
               scene = parse_number(text.substr(colon + 1));
    if (!paper || !scene || !(*paper > 0 && *scene > 0)) return std::nullopt;
    const double scale = *paper / *scene;
    return std::isfinite(scale) && scale > 0 ? std::optional(scale) : std::nullopt;
}

void read_page(OptionReader& reader, DrawCommandOptions& options) {
    const Arguments& arguments = reader.arguments();
    if (const auto text = arguments.value("--page")) {
        options.page.size = parse_page(*text, options.resolution);
        if (!options.page.size) {
            reader.fail(
                wrong_use("--page: '{}' is no page; give a4, letter or a size up to 100 m as in "
                          "--page 420x297mm",
                          *text));
        }
    }
    if (const auto text = arguments.value("--scale")) {
        options.page.scale = parse_scale(*text);
        if (!options.page.scale) {
            reader.fail(wrong_use("--scale: '{}' is no scale, as in --scale 1:50", *text));
        }
    }
    const auto margin = reader.number("--margin", {0, 1e5}, "a number of millimetres from 0 on");
    options.page.margin = margin.value_or(options.page.margin);
    if (margin && !options.page.size) {
        reader.fail(wrong_use("--margin needs a page, as in --page a4"));
    }
}

void read_file(OptionReader& reader, DrawCommandOptions& options) {
    auto output = read_output<VectorFormat>(reader, "--output", kFormats);
    if (output) {
        options.output = std::move(*output);
        check_output(reader, options.output, options.models.paths);
    } else {
        reader.fail(wrong_use("nothing to write; name a file, as in -o drawing.svg"));
    }
    if (options.output.path == "-" && options.common.json) {
        reader.fail(
            wrong_use("--json would mix with the drawing on standard output; write the drawing to "
                      "a file"));
    }
}

Result<DrawCommandOptions> read_options(const Arguments& arguments) {
    OptionReader reader(arguments);
    DrawCommandOptions options;
    options.models = read_models(reader);
    options.camera = read_camera(reader);
    options.resolution = read_resolution(reader, Resolution{}, kAnyNumberOfPixels);
    read_look(reader, options);
    read_page(reader, options);
    options.common = read_common(reader);
    options.trace.threads = options.common.threads;
    read_file(reader, options);
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

VectorOptions vector_options(const DrawCommandOptions& options, const Scene& scene,
                             const PageLayout& layout) {
    VectorOptions vector;
    vector.layout = layout;
    vector.stroke = options.stroke;
    vector.dashed_hidden = options.dashed;
    vector.sorted = options.sorted;
    const glm::u8vec4 b = options.background;
    vector.background = {from_srgb8(b.r), from_srgb8(b.g), from_srgb8(b.b),
                         static_cast<float>(b.a) / 255.0f};
    for (const Object& object : scene.objects) vector.object_names.push_back(object.name);
    return vector;
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
    const auto layout = lay_out(options.page, *camera);
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
    VectorOptions vector = vector_options(options, *scene, *layout);
    vector.counts = &written;
    const Status done = write_drawing(options.output.path, options.output.format, *drawing, vector);
    if (!done) return done.error();
    times.write = watch.lap();
    progress.clear();
    const auto rows = report_rows(times, *drawing, written);
    if (Status told = print_rows(rows, options.common.stats, options.common.json); !told)
        return told.error();
    return 0;
}

constexpr std::array kOutputRows = {
    Option{"--output", "FILE",
           "the drawing: .svg, .pdf, .eps, .dxf or .png; '-' is standard output", "-o"},
    Option{"--output-format", "NAME",
           "svg, pdf, eps, dxf or png, whatever the extension; needed for '-'"},
    Option{"--page", "SIZE",
           "a4, letter or WxHmm (default: one unit of the drawing is one pixel of --resolution)"},
    Option{"--margin", "MM", "kept free around the drawing on its page (default: 10)"},
    Option{"--scale", "A:B",
           "A mm on paper for B units of the scene; parallel projections (default: fill the page)"},
    Option{"--stroke", "WIDTH", "of the lines, in units of the drawing: mm on a page (default: 1)"},
    Option{"--background", "COLOUR", "R,G,B[,A] in 0..255, '#rrggbb[aa]' or none (default: none)"},
    Option{"--sort", "", "put lines in an order that is short for a plotter's pen"},
};

const std::array kLookRows = {
    Option{"--edges", "LIST",
           "silhouette, boundary, crease, border, intersection; all of these (default); mesh: "
           "every polygon edge of the file; none"},
    Option{"--crease-angle", "DEG",
           "edges between faces that meet at more are drawn (default: 30)"},
    Option{"--hidden", "none|dashed|solid", "how hidden lines are drawn (default: none)"},
    Option{"--fill", "none|flat|material|lambert",
           "fill what is visible of each face: grey, its colour, its colour in the light"},
    Option{"--vanishing-points", "", "lines from the model's box to its vanishing points"},
    kMethodOption,
    kCullOption,
};

const std::array kGroups = {OptionGroup{"Output", kOutputRows}, OptionGroup{"Drawing", kLookRows},
                            OptionGroup{"Camera", kCameraOptions},
                            OptionGroup{"Input", kModelOptions},
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
