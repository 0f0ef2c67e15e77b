// `sightline plot`: functions, implicit surfaces and terrain as families of curves.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <utility>

#include "errors.hpp"
#include "plot_subject.hpp"
#include "progress.hpp"
#include "report.hpp"
#include "view_notes.hpp"

namespace sightline::cli {
namespace {

/// The surface is finer than the curves on it: where a curve goes out of sight over a fold, its end
/// is off by the root of what the surface is off.
constexpr double kSurfaceShare = 0.125;

struct Times {
    double load = 0, sample = 0, draw = 0, write = 0;
};

void warn_if_buried(const PlotCommandOptions& options, const std::vector<PlotField>& fields,
                    const PlotSubject& subject, Progress& progress) {
    if (!options.from) return;
    const double z = subject.placed ? -options.from->z : options.from->z;
    for (const PlotField& field : fields) {
        const double ground = field.make()(options.from->x, z);
        if (!(ground > options.from->y)) continue;
        Notes(options.common.quiet, progress)
            .warn(fmt::format("--from: the point is below the ground, which is at {:g} there",
                              ground));
    }
}

// -- the work -------------------------------------------------------------------------------------

void show_progress(Progress& progress, PlotOptions& plot) {
    progress.stage("finding what is visible");
    plot.progress = [&progress](double share) {
        progress.stage("finding what is visible", static_cast<unsigned>(100 * share), 100);
        return true;
    };
}

std::vector<Row> report_rows(const Times& times, const HeightGrid& grid, const Drawing& drawing,
                             const VectorCounts& written) {
    const DrawingCounts& c = drawing.counts;
    return {
        {"load_ms", "load", milliseconds(times.load), "ms"},
        {"sample_ms", "sample", milliseconds(times.sample), "ms"},
        {"draw_ms", "find what is visible", milliseconds(times.draw), "ms"},
        {"write_ms", "write", milliseconds(times.write), "ms"},
        {"columns", "columns of the grid", std::uint64_t{grid.x.size()}, ""},
        {"rows", "rows of the grid", std::uint64_t{grid.z.size()}, ""},
        {"visible_segments", "visible segments", c.visible_segments, ""},
        {"hidden_segments", "hidden segments", c.hidden_segments, ""},
        {"visible_paths", "visible paths", written.visible_paths, ""},
        {"hidden_paths", "hidden paths", written.hidden_paths, ""},
        {"visible_length", "visible length", written.visible_length, "units of the page"},
        {"hidden_length", "hidden length", written.hidden_length, "units of the page"},
        {"peak_rss_mb", "peak memory", std::round(10 * peak_memory_mib()) / 10, "MiB"},
    };
}

/// A plot that is being made, stage by stage.
class Plot {
public:
    Plot(const Arguments& arguments, PlotCommandOptions options, Progress& progress)
        : arguments_(arguments), options_(std::move(options)), progress_(progress) {}

    Result<int> run() {
        progress_.stage("loading");
        Result<PlotSubject> subject = load_subject(options_);
        if (!subject) return subject.error();
        subject_ = std::move(*subject);
        times_.load = watch_.lap();
        progress_.stage("sampling");
        const bool implicit = options_.has_implicit();
        if (Status made = implicit ? make_fields() : make_grid(); !made) return made.error();
        times_.sample = watch_.lap();
        if (Status drawn = implicit ? draw_sections() : draw(); !drawn) return drawn.error();
        times_.draw = watch_.lap();
        return write();
    }

private:
    /// A map that is drawn alone and as it is needs no fields.
    [[nodiscard]] bool is_plain_map() const {
        return options_.items.size() == 1 && subject_.maps.size() == 1 && !options_.x &&
               !options_.z && !options_.y;
    }

    Status set_camera() {
        const auto camera =
            make_camera(camera_options(options_, subject_), subject_.box(), options_.resolution);
        if (!camera) return camera.error();
        camera_ = *camera;
        const glm::dvec3 sight = camera_.view_vector(camera_.target);
        if (options_.plot.ridges &&
            (camera_.is_perspective() || std::abs(sight.x) > std::abs(sight.z))) {
            return wrong_use(
                "--style ridges is for parallel projections that look along z more than along x; "
                "choose another --direction or --projection");
        }
        const auto layout = lay_out(options_.drawing.page, camera_);
        if (!layout) return layout.error();
        layout_ = *layout;
        options_.plot.tolerance /= layout_.scale;
        return success();
    }

    Status make_grid() {
        if (is_plain_map()) return make_map_grid();
        std::vector<PlotField> fields = fields_of(options_, subject_);
        subject_.maps.clear();
        if (Status set = set_heights(options_, fields, subject_); !set) return set.error();
        if (Status set = set_camera(); !set) return set.error();
        warn_if_buried(options_, fields, subject_, progress_);
        for (PlotField& field : fields) field = stretched(std::move(field), subject_.stretch);
        grid_ = sample(fields, subject_.domain, options_.curves, camera_,
                       kSurfaceShare * options_.plot.tolerance, options_.common.threads);
        return success();
    }

    Status make_map_grid() {
        if (options_.from)
            warn_if_buried(options_, {field_of(subject_.maps.front())}, subject_, progress_);
        grid_ = grid_of(std::move(subject_.maps.front()), options_.curves);
        subject_.maps.clear();
        const Box bounds = grid_.bounds();
        subject_.domain.y = {bounds.lo.y, bounds.hi.y};
        subject_.stretch = stretch_of(options_, subject_, bounds.extent().y);
        if (subject_.stretch != 1)
            for (double& y : grid_.layers.front().y) y *= subject_.stretch;
        subject_.domain.y *= subject_.stretch;
        return set_camera();
    }

    Status make_fields() {
        fields_ = implicit_fields(options_, subject_);
        const bool has_maps = !subject_.maps.empty();
        subject_.maps.clear();
        if (Status set = set_extent(options_, fields_, has_maps, subject_); !set)
            return set.error();
        return set_camera();
    }

    Status draw_sections() {
        show_progress(progress_, options_.plot);
        const PlotAxes axes = make_axes();
        SectionOptions sections;
        const PlotCurves& curves = options_.curves;
        if (curves.along_z) sections.x_planes = curve_places(subject_.domain.x, curves.count);
        if (curves.along_x) sections.z_planes = curve_places(subject_.domain.z, curves.count);
        sections.box = subject_.box();
        sections.outline = options_.outline;
        sections.boundary = true;
        sections.hidden = options_.plot.hidden;
        sections.tolerance = options_.plot.tolerance;
        sections.threads = options_.common.threads;
        sections.progress = options_.plot.progress;
        sections.axes = axes.lines;
        Result<Drawing> drawing = trace_sections(fields_, camera_, sections);
        if (!drawing) return drawing.error();
        drawing_ = std::move(*drawing);
        drawing_.labels = axes.labels;
        return success();
    }

    [[nodiscard]] PlotAxes make_axes() const {
        if (!options_.axes) return {};
        return axes_around(subject_.box(), camera_,
                           {1, 1 / subject_.stretch, subject_.placed ? -1 : 1});
    }

    Status draw() {
        show_progress(progress_, options_.plot);
        PlotAxes axes = make_axes();
        Result<Drawing> drawing = options_.image_space
                                      ? image_space_horizon(grid_, camera_, options_.plot)
                                      : floating_horizon(grid_, camera_, options_.plot, axes.lines);
        if (!drawing) return drawing.error();
        drawing_ = std::move(*drawing);
        drawing_.labels = std::move(axes.labels);
        return success();
    }

    Result<int> write() {
        progress_.stage("writing");
        VectorCounts written;
        VectorOptions vector = vector_options(options_.drawing, layout_);
        for (const PlotItem& item : options_.items) vector.object_names.push_back(item.text);
        vector.object_names.emplace_back("axes");
        vector.counts = &written;
        const VectorOutput& file = options_.drawing.file;
        const Status done = write_drawing(file.path, file.format, drawing_, vector);
        if (!done) return done.error();
        times_.write = watch_.lap();
        progress_.clear();
        warn();
        const auto rows = report_rows(times_, grid_, drawing_, written);
        if (Status told = print_rows(rows, options_.common.stats, options_.common.json); !told)
            return told.error();
        return 0;
    }

    /// Warns of options that had no effect and of a blank plot.
    void warn() {
        const Notes notes(options_.common.quiet, progress_);
        const IdleOption own[] = {
            {"--no-outline", !options_.has_implicit(), "only implicit surfaces have outlines"},
            {"--axes", options_.image_space, "--image-space draws none"},
            {"--background", options_.drawing.file.format == VectorFormat::dxf, "a DXF has none"},
        };
        notes.warn_of_options(arguments_, own);
        notes.warn_of_options(arguments_, idle_camera_options({{camera_.projection}}));
        if (std::ranges::any_of(drawing_.lines.kind,
                                [](EdgeKind kind) { return kind != EdgeKind::axis; }))
            return;
        const DepthRange depths = depths_of_box(subject_.box(), camera_);
        notes.warn(fmt::format(
            "the plot is blank: no curve is in view; its box lies at depths {:.4g} to {:.4g}",
            depths.nearest, depths.farthest));
    }

    const Arguments& arguments_;
    PlotCommandOptions options_;
    Progress& progress_;
    Stopwatch watch_;
    Times times_;
    PlotSubject subject_;
    Camera camera_;
    PageLayout layout_;
    HeightGrid grid_;            // of heights
    std::vector<Field> fields_;  // of implicit surfaces
    Drawing drawing_;
};

Result<int> run(const Arguments& arguments) {
    Result<PlotCommandOptions> options = read_plot_options(arguments);
    if (!options) return options.error();
    Progress progress(options->common.quiet);
    return Plot(arguments, std::move(*options), progress).run();
}

const std::array kGroups = {
    OptionGroup{"Output", kDrawingOutputOptions}, OptionGroup{"Curves", kPlotLookOptions},
    OptionGroup{"Domain", kPlotDomainOptions},    OptionGroup{"Height maps", kPlotMapOptions},
    OptionGroup{"Camera", kPlotCameraOptions},    OptionGroup{"Common", kCommonOptions}};

constexpr std::array kExamples = {
    Example{"sightline plot \"y = 8 * sin(hypot(x,z)) / hypot(x,z)\" --lines both -o ripple.svg",
            "a function of two variables"},
    Example{"sightline plot \"x^2 + y^2 + z^2 = 25\" --x -6:6 -o sphere.svg",
            "curves of constant z on an implicit surface"},
    Example{"sightline plot \"y = x*z/10\" \"y = 2 - x\" --lines both -o crossing.pdf --page a4 "
            "--stroke 0.2",
            "two surfaces that cross, on paper"},
    Example{"sightline plot dem.tif --count 120 --stretch 3 -o terrain.svg",
            "terrain, three times as steep"},
    Example{"sightline plot signals.csv --style ridges -o ridges.svg", "a table as ridges"},
    Example{"sightline plot dem.tif --from 431200,2450,5171800 --count 400 --resolution 2000x600 "
            "-o panorama.svg",
            "what is seen from a summit"},
};

}  // namespace

const Command kPlot = {"plot",
                       "curves on functions, implicit surfaces and terrain",
                       "WHAT...",
                       "Draws functions y = f(x, z), equations in x, y and z, and height maps as "
                       "curves of constant z\nor x, as far as they can be seen, exactly. Several "
                       "are drawn together, crossing ones rightly.\nWHAT is a formula or the path "
                       "of a height map (PNG, CSV, NPY, or what GDAL reads).",
                       kGroups,
                       kExamples,
                       run};

}  // namespace sightline::cli
