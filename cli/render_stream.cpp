// Every model is loaded twice: once for its bounds, which decide the offset of the whole and the
// camera, and once for the picture; three times where the whole has an offset. In between nothing
// of it stays.
#include "render_stream.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "errors.hpp"
#include "suggest.hpp"

namespace sightline::cli {
namespace {

/// What is known of all parts before the first is drawn.
struct Survey {
    /// Empty, but for the box and the offset of all parts and the camera of the first that has one.
    Scene frame;
    bool has_normals = false;
};

/// Times and sizes of a run.
struct StreamTotals {
    double load = 0, project = 0, resolve = 0, write = 0;
    std::uint64_t triangles = 0, largest = 0, objects = 0;
};

/// A part in the coordinates of the whole.
Result<Scene> load_part(const RenderOptions& options, std::size_t k, glm::dvec3 offset) {
    const std::vector<std::string> path{options.models.paths[k]};
    LoadOptions loading = options.models.options;
    loading.offset = offset;
    return load_scene(path, loading);
}

void include(const Scene& part, Survey& survey) {
    Box& box = survey.frame.reach;
    if (!part.reach.empty())
        box = box.empty() ? part.reach
                          : Box{glm::min(box.lo, part.reach.lo), glm::max(box.hi, part.reach.hi)};
    if (!survey.frame.camera) survey.frame.camera = part.camera;
    survey.has_normals = survey.has_normals || has_file_normals(part);
}

Result<Survey> survey_parts(const RenderOptions& options, glm::dvec3 offset, Progress& progress) {
    Survey survey;
    survey.frame.offset = offset;
    const auto count = static_cast<unsigned>(options.models.paths.size());
    for (unsigned k = 0; k < count; ++k) {
        progress.stage("looking at part", k + 1, count);
        const Result<Scene> part = load_part(options, k, offset);
        if (!part) return part.error();
        include(*part, survey);
    }
    survey.frame.bounds = survey.frame.reach;
    return survey;
}

/// In the coordinates of the files, and where these are far from the origin again relative to the
/// offset that the whole has then.
Result<Survey> survey_parts(const RenderOptions& options, Progress& progress) {
    auto survey = survey_parts(options, glm::dvec3(0), progress);
    if (!survey) return survey;
    const glm::dvec3 offset = offset_for(survey->frame.reach);
    return offset == glm::dvec3(0) ? std::move(survey) : survey_parts(options, offset, progress);
}

class StreamRun {
public:
    StreamRun(const RenderOptions& options, Progress& progress)
        : options_(options), progress_(progress) {}

    Result<std::vector<Row>> run() {
        Stopwatch watch;
        const auto survey = survey_parts(options_, progress_);
        if (!survey) return survey.error();
        const auto camera = camera_for(survey->frame, options_.camera, options_.resolution);
        if (!camera) return camera.error();
        totals_.load = watch.ms();
        std::vector<Output> outputs;
        for (const PictureOutput& picture : options_.outputs) outputs.push_back(picture.output);
        OutputBatch batch(std::move(outputs));
        const std::vector<PictureFile> files = files_of(options_, batch, options_.outputs);
        const Shading shading = shading_for(options_, survey->has_normals);
        DrawOptions drawing;
        drawing.samples_per_axis = options_.per_axis;
        drawing.shading = {shading, linear_color(options_.background), options_.common.threads};
        StreamedPicture picture(*camera, drawing, files);
        Status done = add_parts(picture, *camera, survey->frame.offset);
        watch.lap();
        progress_.stage("writing");
        if (done) done = picture.write();
        done = batch.publish(done);
        if (!done) return done.error();
        totals_.write = watch.ms();
        progress_.clear();
        return rows();
    }

private:
    Status add_parts(StreamedPicture& picture, const Camera& camera, glm::dvec3 offset) {
        const auto count = static_cast<unsigned>(options_.models.paths.size());
        ScreenScene screen;
        for (unsigned k = 0; k < count; ++k) {
            progress_.stage("drawing part", k + 1, count);
            Stopwatch watch;
            Result<Scene> part = load_part(options_, k, offset);
            if (!part) return part.error();
            if (!part->motions.empty()) {
                return wrong_use("--stream: '{}' has moving objects; leave out --stream",
                                 options_.models.paths[k]);
            }
            if (options_.shading && is_smooth(*options_.shading))
                make_normals(*part, options_.crease_angle);
            totals_.load += watch.lap();
            const ProjectOptions projecting{options_.cull, options_.common.threads};
            if (Status done = project(*part, camera, projecting, screen); !done) return done;
            totals_.project += watch.lap();
            if (Status done = picture.add(screen); !done) return done;
            totals_.resolve += watch.lap();
            const std::uint64_t triangles = part->triangle_count();
            totals_.triangles += triangles;
            totals_.largest = std::max(totals_.largest, triangles);
            totals_.objects += part->objects.size();
        }
        return success();
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
    Progress& progress_;
    StreamTotals totals_;
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

Result<std::vector<Row>> render_stream(const RenderOptions& options, Progress& progress) {
    return StreamRun(options, progress).run();
}

}  // namespace sightline::cli
