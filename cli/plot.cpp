// `sightline plot`: functions, implicit surfaces and terrain as families of curves.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <utility>

#include "errors.hpp"
#include "plot_options.hpp"
#include "progress.hpp"
#include "report.hpp"
#include "sightline/sightline.hpp"

namespace sightline::cli {
namespace {

constexpr glm::dvec2 kDefaultRange(-10, 10);
constexpr double kAutomaticHeight = 0.4;  // of the longer side of the domain
const glm::dvec3 kRidgeDirection(0, -0.8, -1);

struct Times {
    double load = 0, sample = 0, draw = 0, write = 0;
};

/// What is to be plotted, in the coordinates in which it is drawn.
struct Subject {
    std::vector<HeightMap> maps;  // in the order of the items; moved from where one is drawn alone
    PlotDomain domain;
    double stretch = 1;
    bool placed = false;  // z is minus the northing

    [[nodiscard]] Box box() const {
        return {{domain.x.x, domain.y.x, domain.z.x}, {domain.x.y, domain.y.y, domain.z.y}};
    }
};

Error nothing_there(const PlotCommandOptions& options, const PlotDomain& domain) {
    return {
        ErrorKind::bad_input,
        fmt::format("{}: no height anywhere over x {:g}:{:g}, z {:g}:{:g}; choose another --x, "
                    "--z or --y",
                    options.items.front().text, domain.x.x, domain.x.y, domain.z.x, domain.z.y)};
}

Result<std::vector<HeightMap>> load_maps(const PlotCommandOptions& options) {
    std::vector<HeightMap> maps;
    for (const PlotItem& item : options.items) {
        if (item.formula) continue;
        Result<HeightMap> map = load_height_map(item.text, options.map);
        if (!map) return map.error();
        maps.push_back(std::move(*map));
    }
    return maps;
}

/// Ranges of x and z: as asked for, else those of the maps.
void set_domain(const PlotCommandOptions& options, Subject& subject) {
    const auto range = [&](const std::optional<glm::dvec2>& asked, auto nodes, glm::dvec2 other) {
        if (asked) return *asked;
        if (subject.maps.empty()) return other;
        glm::dvec2 all(INFINITY, -INFINITY);
        for (const HeightMap& map : subject.maps) {
            all.x = std::min(all.x, (map.*nodes).front());
            all.y = std::max(all.y, (map.*nodes).back());
        }
        return all;
    };
    subject.domain.x = range(options.x, &HeightMap::x, kDefaultRange);
    subject.domain.z = range(options.z, &HeightMap::z, options.x.value_or(kDefaultRange));
    if (options.y) subject.domain.y = *options.y;
    for (const HeightMap& map : subject.maps) subject.placed = subject.placed || map.placed;
}

/// The same things as surfaces on which a field is 0.
std::vector<Field> implicit_fields(const PlotCommandOptions& options, const Subject& subject) {
    std::vector<Field> fields;
    std::size_t next_map = 0;
    for (const PlotItem& item : options.items) {
        if (item.formula && item.formula->kind == Formula::Kind::implicit) {
            fields.push_back(field_of(item.formula->value, item.text));
            continue;
        }
        const PlotField height =
            item.formula ? field_of(*item.formula) : field_of(subject.maps[next_map++]);
        fields.push_back({[height]() -> Evaluator {
                              return [own = height.make()](glm::dvec3 at) {
                                  return at.y - own(at.x, at.z);
                              };
                          },
                          item.text});
    }
    return fields;
}

std::vector<PlotField> fields_of(const PlotCommandOptions& options, const Subject& subject) {
    std::vector<PlotField> fields;
    std::size_t next_map = 0;
    for (const PlotItem& item : options.items) {
        PlotField field =
            item.formula ? field_of(*item.formula) : field_of(subject.maps[next_map++]);
        fields.push_back(std::move(field));
    }
    return fields;
}

PlotField stretched(PlotField field, double factor) {
    if (factor == 1) return field;
    field.make = [make = std::move(field.make), factor] {
        return std::function<double(double, double)>(
            [own = make(), factor](double x, double z) { return factor * own(x, z); });
    };
    return field;
}

/// Limits of the heights, then how much taller they are drawn.
Status set_heights(const PlotCommandOptions& options, const std::vector<PlotField>& fields,
                   Subject& subject) {
    const auto found = height_range(fields, subject.domain);
    if (!found) return nothing_there(options, subject.domain);
    if (!options.y) subject.domain.y = *found;
    const double height = subject.domain.y.y - subject.domain.y.x;
    const double side =
        std::max(subject.domain.x.y - subject.domain.x.x, subject.domain.z.y - subject.domain.z.x);
    subject.stretch = options.stretch.value_or(height > 0 ? kAutomaticHeight * side / height : 1);
    subject.domain.y *= subject.stretch;
    return success();
}

// -- the camera -----------------------------------------------------------------------------------

CameraOptions camera_options(const PlotCommandOptions& options, const Subject& subject) {
    CameraOptions camera = options.camera;
    const bool aimed = camera.eye || camera.target || camera.direction || camera.view;
    if (options.plot.ridges && !options.from) {
        if (!aimed) camera.direction = kRidgeDirection;
        if (!camera.projection) camera.projection = Projection::orthographic;
    }
    if (!options.from) return camera;
    camera.eye = *options.from * glm::dvec3(1, subject.stretch, subject.placed ? -1 : 1);
    camera.projection = Projection::perspective;
    if (camera.target || camera.direction || camera.view) return camera;
    const glm::dvec3 middle = subject.box().centre();
    const glm::dvec3 level(middle.x - camera.eye->x, 0, middle.z - camera.eye->z);
    const bool at_middle =
        std::hypot(level.x, level.z) < 1e-3 * glm::length(subject.box().extent());
    camera.direction = at_middle ? glm::dvec3(0, 0, -1) : level;
    return camera;
}

void warn_if_buried(const PlotCommandOptions& options, const std::vector<PlotField>& fields,
                    const Subject& subject, Progress& progress) {
    if (!options.from || options.common.quiet) return;
    const double z = subject.placed ? -options.from->z : options.from->z;
    for (const PlotField& field : fields) {
        const double ground = field.make()(options.from->x, z);
        if (!(ground > options.from->y)) continue;
        progress.clear();
        fmt::print(stderr,
                   "sightline: warning: --from: the point is below the ground, which is at {:g} "
                   "there\n",
                   ground);
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
    Plot(PlotCommandOptions options, Progress& progress)
        : options_(std::move(options)), progress_(progress) {}

    Result<int> run() {
        progress_.stage("loading");
        Result<std::vector<HeightMap>> maps = load_maps(options_);
        if (!maps) return maps.error();
        subject_.maps = std::move(*maps);
        set_domain(options_, subject_);
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
               !options_.z && !options_.y && !options_.from;
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
        grid_ = sample(fields, subject_.domain, options_.curves, camera_, options_.plot.tolerance,
                       options_.common.threads);
        return success();
    }

    Status make_map_grid() {
        grid_ = grid_of(std::move(subject_.maps.front()), options_.curves);
        subject_.maps.clear();
        const Box bounds = grid_.bounds();
        subject_.domain.y = {bounds.lo.y, bounds.hi.y};
        const double side = std::max(bounds.extent().x, bounds.extent().z);
        const double height = bounds.extent().y;
        subject_.stretch =
            options_.stretch.value_or(height > 0 ? kAutomaticHeight * side / height : 1);
        if (subject_.stretch != 1)
            for (double& y : grid_.layers.front().y) y *= subject_.stretch;
        subject_.domain.y *= subject_.stretch;
        return set_camera();
    }

    /// Ranges that nobody gave are those in which there is something.
    Status make_fields() {
        fields_ = implicit_fields(options_, subject_);
        const bool has_maps = !subject_.maps.empty();
        subject_.maps.clear();
        PlotDomain& domain = subject_.domain;
        if (!options_.y) {
            domain.y = {INFINITY, -INFINITY};
            for (const Field& field : fields_) {
                const auto range = find_y_range(field, domain.x, domain.z);
                if (!range) return range.error();
                domain.y = {std::min(domain.y.x, range->x), std::max(domain.y.y, range->y)};
            }
        }
        if (!options_.x && !options_.z && !has_maps) shrink_domain();
        return set_camera();
    }

    void shrink_domain() {
        PlotDomain& domain = subject_.domain;
        for (int round = 0; round < 2; ++round) {
            Box all = find_extent(fields_.front(), subject_.box());
            for (std::size_t k = 1; k < fields_.size(); ++k) {
                const Box part = find_extent(fields_[k], subject_.box());
                all = {glm::min(all.lo, part.lo), glm::max(all.hi, part.hi)};
            }
            domain.x = {all.lo.x, all.hi.x};
            domain.z = {all.lo.z, all.hi.z};
            if (!options_.y) domain.y = {all.lo.y, all.hi.y};
        }
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
        const auto rows = report_rows(times_, grid_, drawing_, written);
        if (Status told = print_rows(rows, options_.common.stats, options_.common.json); !told)
            return told.error();
        return 0;
    }

    PlotCommandOptions options_;
    Progress& progress_;
    Stopwatch watch_;
    Times times_;
    Subject subject_;
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
    return Plot(std::move(*options), progress).run();
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
