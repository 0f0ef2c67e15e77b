// Every model is loaded once for the plan, once more where it may share planes with others, once
// more where the eye is close to the scene, for the near plane is then fitted to what is in view,
// and once for the picture; all once more where they lie far from the origin, for then the plan is
// made relative to the offset of the whole. In between only what the plan keeps of it stays.
#include "render_stream.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

#include "errors.hpp"
#include "suggest.hpp"
#include "view_notes.hpp"

namespace sightline::cli {
namespace {

/// Times and sizes of a run.
struct StreamTotals {
    double load = 0, project = 0, resolve = 0, write = 0;
    std::uint64_t triangles = 0, largest = 0, objects = 0;
};

/// A part relative to the offset of the whole.
Result<Scene> load_part(const RenderOptions& options, std::size_t k, glm::dvec3 offset) {
    const std::vector<std::string> path{options.models.paths[k]};
    LoadOptions loading = options.models.options;
    loading.offset = offset;
    loading.find_sheets = false;
    return load_scene(path, loading);
}

/// Looks at all parts.
Status survey_parts(const RenderOptions& options, glm::dvec3 offset, Progress& progress,
                    StreamPlan& plan) {
    const auto count = static_cast<unsigned>(options.models.paths.size());
    for (unsigned k = 0; k < count; ++k) {
        progress.stage("looking at part", k + 1, count);
        const Result<Scene> part = load_part(options, k, offset);
        if (!part) return part.error();
        if (part->camera && plan.frame().camera)
            return failure("{}: camera: another scene file has one already; keep one",
                           options.models.paths[k]);
        plan.survey(*part);
    }
    plan.finish_survey();
    return success();
}

/// Looks at all parts, and again at those that may share a plane with another one.
Result<std::unique_ptr<StreamPlan>> make_plan(const RenderOptions& options, Progress& progress) {
    auto plan = std::make_unique<StreamPlan>();
    Status done = survey_parts(options, glm::dvec3(0), progress, *plan);
    if (!done) return done.error();
    const glm::dvec3 offset = offset_for(plan->frame().reach);
    if (offset != glm::dvec3(0)) {
        plan = std::make_unique<StreamPlan>();
        done = survey_parts(options, offset, progress, *plan);
        if (!done) return done.error();
    }
    const auto count = static_cast<unsigned>(options.models.paths.size());
    for (unsigned k = 0; k < count; ++k) {
        if (!plan->is_shared(k)) continue;
        progress.stage("comparing part", k + 1, count);
        Result<Scene> part = load_part(options, k, offset);
        if (!part) return part.error();
        plan->compare(k, *part);
    }
    plan->finish_comparison();
    return plan;
}

class StreamRun {
public:
    StreamRun(const RenderOptions& options, const Notes& notes, Progress& progress)
        : options_(options), notes_(notes), progress_(progress) {}

    Result<Streamed> run() {
        Stopwatch watch;
        auto plan = make_plan(options_, progress_);
        if (!plan) return plan.error();
        plan_ = std::move(*plan);
        const Scene& frame = plan_->frame();
        const CameraOptions asked =
            relative_to(merge_cameras(frame, options_.camera), frame.offset);
        const auto camera =
            make_camera(asked, frame.reach, options_.resolution,
                        [&](const Camera& view) { return depths_of_parts(view, EdgeOn::counts); });
        if (!camera) return camera.error();
        if (failed_) return *failed_;
        totals_.load = watch.ms();
        std::vector<Output> outputs;
        for (const PictureOutput& picture : options_.outputs) outputs.push_back(picture.output);
        OutputBatch batch(std::move(outputs));
        const std::vector<PictureFile> files = files_of(options_, batch, options_.outputs);
        const Shading shading = shading_for(options_, plan_->has_file_normals());
        DrawOptions drawing;
        drawing.samples_per_axis = options_.per_axis;
        drawing.shading = {shading, linear_color(options_.background), options_.common.threads};
        StreamedPicture picture(*camera, drawing, files, plan_.get());
        Status done = plan_->set_view(*camera, {options_.cull, options_.common.threads});
        if (done) done = add_parts(picture, *camera);
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
        view.add({{frame.reach, depths}, asked, *camera, counts_, !picture.anything_seen()});
        view.print(notes_, "the picture is blank");
        return Streamed{rows(), frame.camera};
    }

private:
    /// Finds what depths_in_view() would find in the whole: it loads one part after the other.
    DepthRange depths_of_parts(const Camera& camera, EdgeOn edge_on) {
        DepthRange range;
        const auto count = static_cast<unsigned>(options_.models.paths.size());
        for (unsigned k = 0; k < count && !failed_; ++k) {
            progress_.stage("measuring part", k + 1, count);
            const Result<Scene> part = load_part(options_, k, plan_->frame().offset);
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
            Result<Scene> part = load_part(options_, k, plan_->frame().offset);
            if (!part) return part.error();
            if (!part->motions.empty()) {
                return wrong_use("--stream: '{}' has moving objects; leave out --stream",
                                 options_.models.paths[k]);
            }
            notes_.warn_of_files(*part);
            if (options_.shading && is_smooth(*options_.shading))
                make_normals(*part, options_.crease_angle);
            plan_->adopt(k, *part);
            totals_.load += watch.lap();
            const ProjectOptions projecting{options_.cull, options_.common.threads};
            if (Status done = project(*part, camera, projecting, screen); !done) return done;
            plan_->adopt(k, screen);
            totals_.project += watch.lap();
            note(screen.counts());
            if (Status done = picture.add(screen); !done) return done;
            totals_.resolve += watch.lap();
            const std::uint64_t triangles = part->triangle_count();
            totals_.triangles += triangles;
            totals_.largest = std::max(totals_.largest, triangles);
            totals_.objects += part->objects.size();
        }
        return success();
    }

    void note(const ProjectCounts& counts) {
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
    std::unique_ptr<StreamPlan> plan_;
    StreamTotals totals_;
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
    const auto pipe = [](const std::string& path) {
        std::error_code ignored;
        return std::filesystem::is_fifo(path, ignored);
    };
    refuse(std::ranges::any_of(options.models.paths, pipe),
           "a pipe can't be read twice; name files");
}

Result<Streamed> render_stream(const RenderOptions& options, const Notes& notes,
                               Progress& progress) {
    return StreamRun(options, notes, progress).run();
}

}  // namespace sightline::cli
