// From a projected scene to the files of `sightline render`.
#include "render_frame.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>

#include "errors.hpp"
#include "report.hpp"

namespace sightline::cli {
namespace {

constexpr std::uint64_t kMaxPerAxis = 8;

/// An algorithm that makes a picture row by row, for those who chose one that can't.
std::string_view algorithm_for_large_pictures() {
    const auto all = algorithms();
    const auto found =
        std::ranges::find_if(all, [](const Algorithm& a) { return a.open_rows != nullptr; });
    return found == all.end() ? "" : found->name;
}

/// An error unless the algorithm can hold so many samples.
std::optional<Error> check_samples(const Algorithm& algorithm, std::string_view option,
                                   Resolution size, std::uint64_t samples) {
    const std::uint64_t pixels = std::uint64_t{size.width} * size.height;
    if (algorithm.open_rows != nullptr || pixels * samples <= kMaxSamples) return std::nullopt;
    return wrong_use("{}: {} a pixel at {}x{} are over 2^28 samples; use --algorithm {}", option,
                     samples, size.width, size.height, algorithm_for_large_pictures());
}

/// Times the stages and tells the terminal of them.
class StageWatch {
public:
    StageWatch(Drawn& drawn, Progress& progress, std::uint32_t rows)
        : drawn_(drawn), progress_(progress), rows_(rows) {}

    void enter(DrawStage stage, std::uint32_t rows_done) {
        leave();
        stage_ = stage;
        if (stage == DrawStage::resolve) progress_.stage("drawing rows", rows_done, rows_);
    }
    void leave() {
        const double ms = watch_.lap();
        if (stage_ == DrawStage::resolve) drawn_.resolve += ms;
        if (stage_ == DrawStage::shade) drawn_.shade += ms;
        if (stage_ == DrawStage::write) drawn_.write += ms;
    }

private:
    Drawn& drawn_;
    Progress& progress_;
    std::uint32_t rows_;
    DrawStage stage_ = DrawStage::resolve;
    Stopwatch watch_;
};

}  // namespace

void read_size(OptionReader& reader, RenderOptions& options) {
    // All pixels together are the algorithm's business.
    options.resolution =
        read_resolution(reader, Resolution{}, std::uint64_t{kMaxSide} * std::uint64_t{kMaxSide});
    if (auto error = check_samples(*options.algorithm, "--resolution", options.resolution, 1)) {
        reader.fail(std::move(*error));
    }

    const std::string expected = "a square grid of samples: 1, 4, 16 or 64";
    const auto samples = reader.count("--samples", 1, kMaxPerAxis * kMaxPerAxis, expected);
    options.by_area = !samples && options.algorithm->open_fragments != nullptr;
    if (!samples) return;
    const auto n =
        static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(*samples))));
    if (n * n != *samples || !std::has_single_bit(n)) {
        reader.fail(wrong_use("--samples: '{}' is not {}", *samples, expected));
        return;
    }
    options.per_axis = n;
    if (auto error = check_samples(*options.algorithm, "--samples", options.resolution, *samples)) {
        reader.fail(std::move(*error));
    }
}

bool has_file_normals(const Scene& scene) {
    return std::ranges::any_of(scene.objects, &Object::has_file_normals);
}

Shading shading_for(const RenderOptions& options, bool file_normals) {
    return options.shading.value_or(file_normals ? Shading::phong : Shading::flat);
}

glm::vec4 linear_color(glm::u8vec4 srgb) {
    const float alpha = static_cast<float>(srgb.a) / 255.0f;
    return {alpha * from_srgb8(srgb.r), alpha * from_srgb8(srgb.g), alpha * from_srgb8(srgb.b),
            alpha};
}

std::vector<PictureFile> files_of(const RenderOptions& options, const OutputBatch& batch,
                                  std::span<const PictureOutput> pictures) {
    std::vector<PictureFile> files;
    for (std::size_t i = 0; i < batch.outputs().size(); ++i) {
        const Output& output = batch.outputs()[i];
        const auto picture = std::ranges::find_if(
            pictures, [&](const PictureOutput& p) { return p.output.option == output.option; });
        files.push_back({picture->content, batch.path(i), output.format, options.layers.normals,
                         options.layers.ids,
                         options.deep && picture->content == PictureContent::color});
        if (output.format == ImageFormat::exr) use_exr_threads(options.common.threads);
    }
    return files;
}

namespace {

/// A matte is the alpha of a picture without a background; so it is drawn on its own.
Status draw_mattes(const View& view, const Algorithm& algorithm, DrawOptions drawing,
                   std::vector<PictureFile>& files) {
    const auto is_matte = [](const PictureFile& file) {
        return file.content == PictureContent::matte;
    };
    std::vector<PictureFile> mattes;
    std::ranges::copy_if(files, std::back_inserter(mattes), is_matte);
    std::erase_if(files, is_matte);
    if (mattes.empty()) return success();
    drawing.shading.shading = Shading::unlit;
    drawing.shading.background = glm::vec4(0);
    if (!files.empty()) drawing.counters = nullptr;
    return draw(view.screen, algorithm, drawing, mattes);
}

}  // namespace

Result<Drawn> draw_outputs(const RenderOptions& options, const View& view,
                           std::span<const PictureOutput> pictures, Progress& progress) {
    std::vector<Output> outputs;
    for (const PictureOutput& picture : pictures) outputs.push_back(picture.output);
    OutputBatch batch(std::move(outputs));
    std::vector<PictureFile> files = files_of(options, batch, pictures);
    Drawn drawn;
    StageWatch watch(drawn, progress, options.resolution.height);
    const DrawOptions drawing{
        options.per_axis,
        options.by_area,
        {view.shading, linear_color(options.background), options.common.threads},
        &drawn.counters,
        [&](DrawStage stage, std::uint32_t rows_done) { watch.enter(stage, rows_done); },
        view.tree,
        &drawn.anything_seen};
    Status done = draw_mattes(view, *options.algorithm, drawing, files);
    if (done) done = draw(view.screen, *options.algorithm, drawing, files);
    done = batch.publish(done);
    watch.leave();
    if (!done) return done.error();
    return drawn;
}

}  // namespace sightline::cli
