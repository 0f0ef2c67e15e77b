// Every model is loaded twice where the camera has to be fitted: once for its bounds, once for the
// picture; and once more in between where the eye is close to the scene, for the near plane is then
// fitted to what is in view. In between nothing of it stays.
#include "render_stream.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "errors.hpp"
#include "suggest.hpp"
#include "view_notes.hpp"

namespace sightline::cli {
namespace {

/// What is known of all parts before the first is drawn.
struct Survey {
    Scene frame;  ///< empty, but for the box of all parts and the camera of the first that has one
    bool has_normals = false;
};

/// Times and sizes of a run.
struct StreamTotals {
    double load = 0, project = 0, resolve = 0, write = 0;
    std::uint64_t triangles = 0, largest = 0, objects = 0;
};

Result<Scene> load_part(const RenderOptions& options, std::size_t k) {
    const std::vector<std::string> path{options.models.paths[k]};
    return load_scene(path, options.models.options);
}

void include(const Box& part, Box& whole) {
    if (part.empty()) return;
    whole = whole.empty() ? part : Box{glm::min(whole.lo, part.lo), glm::max(whole.hi, part.hi)};
}

void include(const Scene& part, Survey& survey) {
    include(part.reach, survey.frame.reach);
    if (!survey.frame.camera) survey.frame.camera = part.camera;
    survey.has_normals = survey.has_normals || has_file_normals(part);
}

Result<Survey> survey_parts(const RenderOptions& options, Progress& progress) {
    Survey survey;
    const auto count = static_cast<unsigned>(options.models.paths.size());
    for (unsigned k = 0; k < count; ++k) {
        progress.stage("looking at part", k + 1, count);
        const Result<Scene> part = load_part(options, k);
        if (!part) return part.error();
        include(*part, survey);
    }
    survey.frame.bounds = survey.frame.reach;
    return survey;
}

/// Whether the camera and the shading are said in full, so that no part need be seen before.
bool needs_no_survey(const RenderOptions& options) {
    const CameraOptions& camera = options.camera;
    const bool perspective =
        camera.projection.value_or(Projection::perspective) == Projection::perspective;
    return options.shading && camera.near_plane && camera.far_plane && camera.eye &&
           (camera.target || camera.direction) && (perspective || camera.ortho_height);
}

class StreamRun {
public:
    StreamRun(const RenderOptions& options, const Notes& notes, Progress& progress)
        : options_(options), notes_(notes), progress_(progress) {}

    Result<Streamed> run() {
        Stopwatch watch;
        Survey survey;
        survey.frame.reach = {glm::dvec3(-1), glm::dvec3(1)};
        if (!needs_no_survey(options_)) {
            survey.frame.reach = {};
            auto seen = survey_parts(options_, progress_);
            if (!seen) return seen.error();
            survey = std::move(*seen);
        }
        const CameraOptions asked = merge_cameras(survey.frame, options_.camera);
        const auto camera =
            make_camera(asked, survey.frame.reach, options_.resolution,
                        [&](const Camera& view) { return depths_of_parts(view, EdgeOn::counts); });
        if (!camera) return camera.error();
        if (failed_) return *failed_;
        totals_.load = watch.ms();
        std::vector<Output> outputs;
        for (const PictureOutput& picture : options_.outputs) outputs.push_back(picture.output);
        OutputBatch batch(std::move(outputs));
        const std::vector<PictureFile> files = files_of(options_, batch, options_.outputs);
        const Shading shading = shading_for(options_, survey.has_normals);
        DrawOptions drawing;
        drawing.samples_per_axis = options_.per_axis;
        drawing.shading = {shading, linear_color(options_.background), options_.common.threads};
        StreamedPicture picture(*camera, drawing, files);
        Status done = add_parts(picture, *camera);
        watch.lap();
        progress_.stage("writing");
        if (done) done = picture.write();
        done = batch.publish(done);
        if (!done) return done.error();
        totals_.write = watch.ms();
        progress_.clear();
        const auto depths = [&](const Camera& view, EdgeOn edge_on) {
            return depths_of_parts(view, edge_on);
        };
        ViewNotes view;
        view.add({{reach_, depths}, asked, *camera, counts_, !picture.anything_seen()});
        view.print(notes_, "the picture is blank");
        return Streamed{rows(), survey.frame.camera};
    }

private:
    /// Of all parts, which are loaded for it.
    DepthRange depths_of_parts(const Camera& camera, EdgeOn edge_on) {
        DepthRange range;
        const auto count = static_cast<unsigned>(options_.models.paths.size());
        for (unsigned k = 0; k < count && !failed_; ++k) {
            progress_.stage("measuring part", k + 1, count);
            const Result<Scene> part = load_part(options_, k);
            if (part) {
                range.take_in(depths_in_view(*part, camera, edge_on));
            } else {
                failed_ = part.error();
            }
        }
        return range;
    }

    Status add_parts(StreamedPicture& picture, const Camera& camera) {
        const auto count = static_cast<unsigned>(options_.models.paths.size());
        ScreenScene screen;
        for (unsigned k = 0; k < count; ++k) {
            progress_.stage("drawing part", k + 1, count);
            Stopwatch watch;
            Result<Scene> part = load_part(options_, k);
            if (!part) return part.error();
            if (!part->motions.empty()) {
                return wrong_use("--stream: '{}' has moving objects; leave out --stream",
                                 options_.models.paths[k]);
            }
            notes_.warn_of_files(*part);
            if (options_.shading && is_smooth(*options_.shading))
                make_normals(*part, options_.crease_angle);
            totals_.load += watch.lap();
            const ProjectOptions projecting{options_.cull, options_.common.threads};
            if (Status done = project(*part, camera, projecting, screen); !done) return done;
            totals_.project += watch.lap();
            note(*part, screen.counts());
            if (Status done = picture.add(screen); !done) return done;
            totals_.resolve += watch.lap();
            const std::uint64_t triangles = part->triangle_count();
            totals_.triangles += triangles;
            totals_.largest = std::max(totals_.largest, triangles);
            totals_.objects += part->objects.size();
        }
        return success();
    }

    void note(const Scene& part, const ProjectCounts& counts) {
        include(part.reach, reach_);
        counts_.triangles += counts.triangles;
        counts_.degenerate += counts.degenerate;
        counts_.outside += counts.outside;
    }

    [[nodiscard]] std::vector<Row> rows() const {
        return {{"load_ms", "load", milliseconds(totals_.load), "ms"},
                {"project_ms", "project", milliseconds(totals_.project), "ms"},
                {"resolve_ms", "resolve and shade", milliseconds(totals_.resolve), "ms"},
                {"write_ms", "write", milliseconds(totals_.write), "ms"},
                {"algorithm", "algorithm", options_.algorithm->name, ""},
                {"width", "width", options_.resolution.width, "pixels"},
                {"height", "height", options_.resolution.height, "pixels"},
                {"samples", "samples a pixel", options_.per_axis * options_.per_axis, ""},
                {"parts", "parts", std::uint64_t{options_.models.paths.size()}, ""},
                {"objects", "objects", totals_.objects, ""},
                {"triangles", "triangles", totals_.triangles, ""},
                {"largest_part", "triangles of the largest part", totals_.largest, ""},
                {"peak_rss_mb", "peak memory", std::round(10 * peak_memory_mib()) / 10, "MiB"}};
    }

    const RenderOptions& options_;
    const Notes& notes_;
    Progress& progress_;
    StreamTotals totals_;
    Box reach_;  // of the parts that were drawn
    ProjectCounts counts_;
    std::optional<Error> failed_;  // of a part that was looked at again
};

}  // namespace

void read_stream(OptionReader& reader, RenderOptions& options) {
    options.stream = reader.arguments().has("--stream");
    if (!options.stream) return;
    const auto refuse = [&](bool given, std::string_view what) {
        if (given) reader.fail(wrong_use("--stream: {}", what));
    };
    const std::string_view name = options.algorithm->name;
    refuse(options.algorithm->open_fragments != nullptr,
           "the lists of an A-buffer must stand in memory with the whole scene; take --algorithm "
           "zbuffer, or leave out --stream");
    refuse(options.algorithm != &default_algorithm(),
           fmt::format("'{}' needs the whole scene; take --algorithm {}", name,
                       default_algorithm().name));
    refuse(options.frames.count > 0, "frames need the scene several times; leave out --frames");
    refuse(
        !options.opacity.empty() || !options.holdouts.empty(),
        "the z-buffer of a stream keeps one surface a sample; leave out --opacity and --holdout");
    const auto matte = [](const PictureOutput& p) { return p.content == PictureContent::matte; };
    refuse(std::ranges::any_of(options.outputs, matte), "no matte is kept; leave out --matte");
    refuse(std::ranges::find(options.models.paths, "-") != options.models.paths.end(),
           "standard input can't be read twice; name files");
}

Result<Streamed> render_stream(const RenderOptions& options, const Notes& notes,
                               Progress& progress) {
    return StreamRun(options, notes, progress).run();
}

}  // namespace sightline::cli
