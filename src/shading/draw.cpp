// From a projected scene to files, a group of rows at a time.
//
// A group is a whole number of the algorithm's bands, resolved in parallel; then it goes through
// all files before the next one is resolved into the same memory. An algorithm that needs the whole
// picture makes one group of it.
#include <tbb/task_arena.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "shading/antialiased_rows.hpp"
#include "shading/blended_rows.hpp"
#include "shading/draw_groups.hpp"
#include "shading/picture_sink.hpp"
#include "visibility/parallel.hpp"

namespace sightline {
namespace {

// A group has this many samples or, up to the larger number, this many bands for each core. With 8
// bytes a sample they take 32 to 96 MiB.
constexpr std::uint64_t kFewSamples = std::uint64_t{1} << 22, kManySamples = 3 * kFewSamples;
constexpr std::uint64_t kBandsPerCore = 4;

/// The samples of one grid, for one group of rows of pixels after another.
class GroupSource {
public:
    GroupSource(const ScreenScene& screen, const Algorithm& algorithm,
                const ResolveOptions& options)
        : screen_(screen), algorithm_(algorithm), options_(options) {
        held_.grid = {screen.resolution(), options.samples_per_axis};
    }

    /// To be called once, before the others.
    Status open() {
        if (algorithm_.open_rows == nullptr) return success();
        auto source = open_rows(algorithm_, screen_, options_);
        if (!source) return source.error();
        source_ = std::move(*source);
        return success();
    }

    /// Rows of pixels of which a group has a multiple.
    [[nodiscard]] std::uint32_t unit() const {
        if (source_ == nullptr) return held_.grid.resolution.height;
        return std::lcm(source_->band_rows(), held_.grid.per_axis) / held_.grid.per_axis;
    }

    /// Holds rows of pixels from now on. Precondition: `first` is a multiple of unit(), and so is
    /// `count` unless the rows are the last ones.
    Status resolve(std::uint32_t first, std::uint32_t count) {
        if (source_ == nullptr) return sightline::resolve(algorithm_, screen_, options_, held_);
        const std::uint32_t rows = count * held_.grid.per_axis;
        held_.first_row = first * held_.grid.per_axis;
        held_.ids.resize(std::size_t{rows} * held_.grid.columns());
        held_.depth.resize(held_.ids.size());
        resolve_bands(*source_, options_, held_);
        return success();
    }

    /// To be called once, after the last group.
    void report() {
        if (source_ != nullptr) source_->report();
    }

    [[nodiscard]] const Visibility& held() const { return held_; }
    [[nodiscard]] std::uint64_t samples_per_row() const {
        return std::uint64_t{held_.grid.columns()} * held_.grid.per_axis;
    }

private:
    const ScreenScene& screen_;
    const Algorithm& algorithm_;
    ResolveOptions options_;
    std::unique_ptr<RowSource> source_;  // null: the algorithm needs the whole picture
    Visibility held_;
};

/// The work of one draw().
class PictureRun {
public:
    PictureRun(const ScreenScene& screen, const Algorithm& algorithm, const DrawOptions& options,
               std::span<const PictureFile> files)
        : options_(options),
          files_(files),
          resolution_(screen.resolution()),
          height_(resolution_.height) {
        const auto needs_color = [](const PictureFile& file) {
            return file.content == PictureContent::color || file.content == PictureContent::matte;
        };
        const auto needs_centres = [&](const PictureFile& file) {
            return !needs_color(file) || (file.format == ImageFormat::exr && !file.deep);
        };
        const bool color = std::ranges::any_of(files, needs_color);
        const bool centres = std::ranges::any_of(files, needs_centres);
        resolving_ = {options.samples_per_axis, options.shading.threads, nullptr, options.counters,
                      options.tree};
        const Shading shading = options.shading.shading;
        by_area_ = color && options.by_area && antialiases(algorithm, shading);
        blends_ = color && !by_area_ && blends(algorithm, shading, screen.scene());
        const bool by_rows = by_area_ || blends_;
        if (color && !by_rows) sources_.emplace_back(screen, algorithm, resolving_);
        if (centres && (by_rows || !(color && options.samples_per_axis == 1))) {
            ResolveOptions at_centres = resolving_;
            at_centres.samples_per_axis = 1;
            if (color) at_centres.counters = nullptr;
            sources_.emplace_back(screen, algorithm, at_centres);
        }
    }

    [[nodiscard]] Status run(const ScreenScene& screen, const Algorithm& algorithm,
                             std::uint32_t group_rows) {
        if (options_.anything_seen != nullptr) *options_.anything_seen = false;
        enter(DrawStage::resolve);
        if (Status done = open_sources(screen, algorithm); !done) return done;
        // Where there are no colours, or nothing at the centres, no sink asks for them.
        const Visibility nothing{{screen.resolution(), 1}, {}, {}};
        const Visibility& samples = sources_.empty() ? nothing : sources_.front().held();
        const Visibility& centres = sources_.empty() ? nothing : sources_.back().held();
        PictureRows rows(screen, samples, centres, options_.shading, colors_.get());
        const SinkSource source{rows,
                                deep_,
                                screen.resolution(),
                                screen.camera().near_plane,
                                screen.camera().far_plane,
                                options_.shading.threads,
                                [this](DrawStage stage) { enter(stage); }};
        const std::uint32_t group = rows_of_group(group_rows);
        for (; done_ < height_; done_ += group) {
            if (Status drawn = draw_group(source, std::min(group, height_ - done_)); !drawn) {
                return drawn;
            }
        }
        if (colors_ != nullptr) colors_->report();
        for (GroupSource& finished : sources_) finished.report();
        return success();
    }

private:
    [[nodiscard]] Status open_sources(const ScreenScene& screen, const Algorithm& algorithm) {
        if (blends_) {
            auto layers = open_layers(algorithm, screen, resolving_);
            if (!layers) return layers.error();
            const SampleGrid grid{screen.resolution(), options_.samples_per_axis};
            colors_ =
                std::make_unique<BlendedRows>(screen, grid, options_.shading, std::move(*layers));
        }
        if (by_area_) {
            auto fragments = algorithm.open_fragments(screen, resolving_);
            if (!fragments) return fragments.error();
            const bool deep = std::ranges::any_of(files_, &PictureFile::deep);
            auto rows = std::make_unique<AntialiasedRows>(screen, options_.shading, deep,
                                                          std::move(*fragments));
            deep_ = deep ? rows.get() : nullptr;
            colors_ = std::move(rows);
        }
        for (GroupSource& source : sources_) {
            if (Status done = source.open(); !done) return done;
        }
        return success();
    }

    void enter(DrawStage stage) const {
        if (options_.on_stage) options_.on_stage(stage, done_);
    }

    [[nodiscard]] std::uint32_t rows_of_group(std::uint32_t wanted) const {
        std::uint64_t unit = 1, samples = 0;
        if (colors_ != nullptr) {
            unit = colors_->unit();
            samples = 2 * std::uint64_t{resolution_.width};  // 16 bytes a pixel
        }
        for (const GroupSource& source : sources_) {
            unit = std::lcm(unit, std::uint64_t{source.unit()});
            samples += source.samples_per_row();
        }
        const auto cores = static_cast<std::uint64_t>(in_arena(
            options_.shading.threads, [] { return tbb::this_task_arena::max_concurrency(); }));
        const std::uint64_t busy = std::max(kFewSamples / samples, kBandsPerCore * cores * unit);
        const std::uint64_t rows = wanted > 0 ? wanted : std::min(busy, kManySamples / samples);
        return static_cast<std::uint32_t>(
            std::min<std::uint64_t>(height_, std::max<std::uint64_t>(1, rows / unit) * unit));
    }

    /// Resolves the next rows and appends them to all files, and after the last rows completes
    /// them.
    [[nodiscard]] Status draw_group(const SinkSource& source, std::uint32_t count) {
        enter(DrawStage::resolve);
        if (colors_ != nullptr) colors_->resolve(done_, count, resolving_);
        for (GroupSource& samples : sources_) {
            if (Status done = samples.resolve(done_, count); !done) return done;
        }
        note_what_is_seen();
        // Only now, so that nothing of a view that can't be resolved touches the disk.
        for (std::size_t i = sinks_.size(); i < files_.size(); ++i) {
            auto sink = open_sink(files_[i], source);
            if (!sink) return sink.error();
            sinks_.push_back(std::move(*sink));
        }
        for (const auto& sink : sinks_) {
            if (Status done = sink->append(done_, count); !done) return done;
            if (done_ + count < height_) continue;
            if (Status done = sink->finish(); !done) return done;
        }
        return success();
    }

    void note_what_is_seen() const {
        if (options_.anything_seen == nullptr || *options_.anything_seen) return;
        *options_.anything_seen =
            colors_ != nullptr ? colors_->anything_seen() : sees_anything(sources_.front().held());
    }

    const DrawOptions& options_;
    std::span<const PictureFile> files_;
    Resolution resolution_;
    std::uint32_t height_, done_ = 0;
    ResolveOptions resolving_;  // of the colours
    bool blends_ = false, by_area_ = false;
    std::unique_ptr<ColorRows> colors_;  // where they are not those of one triangle a sample
    AntialiasedRows* deep_ = nullptr;    // the same, when it has deep samples as well
    std::vector<GroupSource> sources_;   // of the colours, of the centres, or of both in one
    std::vector<std::unique_ptr<PictureSink>> sinks_;
};

}  // namespace

Status draw_in_groups(const ScreenScene& screen, const Algorithm& algorithm,
                      const DrawOptions& options, std::span<const PictureFile> files,
                      std::uint32_t group_rows) {
    if (files.empty()) return success();
    return PictureRun(screen, algorithm, options, files).run(screen, algorithm, group_rows);
}

Status draw(const ScreenScene& screen, const Algorithm& algorithm, const DrawOptions& options,
            std::span<const PictureFile> files) {
    return draw_in_groups(screen, algorithm, options, files, 0);
}

}  // namespace sightline
