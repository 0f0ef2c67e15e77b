#include "visibility/painting.hpp"

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>

#include "visibility/counts.hpp"

namespace sightline {

namespace {

enum class Count : std::uint8_t { runs, samples, comparisons, exact };

constexpr std::array kCountNames{CountName{"runs painted"}, CountName{"samples painted"},
                                 CountName{"depth comparisons"}, CountName{"exact comparisons"}};

using PaintCounts = Counts<Count, kCountNames>;

/// The ids of a band while it is painted.
class IdPainter final : public RunSink {
public:
    IdPainter(Over& over, const SampleUnits& units, std::int32_t first_row, std::uint32_t* ids,
              Observer* observer)
        : over_(over), units_(units), first_row_(first_row), ids_(ids), observer_(observer) {}

    void take(const Run& run) override {
        std::uint32_t* row = ids_ + static_cast<std::size_t>(run.row - first_row_) *
                                        static_cast<std::size_t>(units_.columns);
        ++counts[Count::runs];
        over_.paint(run, row, [&](std::int32_t first, std::int32_t end) {
            std::fill(row + first, row + end, run.id);
            counts[Count::samples] += static_cast<std::uint64_t>(end - first);
            tell(run, first, end);
        });
    }

    PaintCounts counts;

private:
    void tell(const Run& run, std::int32_t first, std::int32_t end) const {
        if (observer_ == nullptr) return;
        const auto y = static_cast<std::uint32_t>(run.row);
        observer_->step({StepKind::span_decided, run.id, kNone, static_cast<std::uint32_t>(first),
                         y, static_cast<std::uint32_t>(end), y + 1});
    }

    Over& over_;
    SampleUnits units_;
    std::int32_t first_row_;
    std::uint32_t* ids_;
    Observer* observer_;
};

class PaintedRows final : public RowSource {
public:
    PaintedRows(const ScreenScene& screen, const SampleGrid& grid, const ResolveOptions& options,
                std::unique_ptr<LayerSource> layers, Ties ties)
        : screen_(screen),
          units_(grid, screen.subpixel_bits()),
          options_(options),
          layers_(std::move(layers)),
          ties_(ties) {}

    [[nodiscard]] std::uint32_t band_rows() const override { return layers_->band_rows(); }

    void resolve_band(std::uint32_t band, std::uint32_t* ids, float* depth) override {
        const auto height = static_cast<std::int32_t>(layers_->band_rows());
        const std::int32_t first = static_cast<std::int32_t>(band) * height;
        const std::int32_t end = std::min(units_.rows, first + height);
        const auto width = static_cast<std::size_t>(units_.columns);
        std::fill(ids, ids + static_cast<std::size_t>(end - first) * width, kNone);
        Over over(screen_, units_, ties_);
        IdPainter painter(over, units_, first, ids, options_.observer);
        layers_->visit_band(band, painter);
        for (std::int32_t j = first; j < end; ++j, ids += width, depth += width)
            fill_depth(over.planes(), j, ids, depth);
        painter.counts[Count::comparisons] = over.comparisons();
        painter.counts[Count::exact] = over.exact();
        const std::lock_guard lock(mutex_);
        counts_ += painter.counts;
    }

    void report() override {
        layers_->report();
        counts_.report(options_);
    }

private:
    // The depths of a row whose owners are known.
    void fill_depth(PlaneCache& planes, std::int32_t row, std::uint32_t* ids, float* depth) const {
        for (std::int32_t i = 0; i < units_.columns;) {
            const std::uint32_t id = ids[i];
            const std::int32_t first = i;
            while (i < units_.columns && ids[i] == id) ++i;
            if (id == kNone)
                fill_background(first, i, ids, depth);
            else
                fill_run(screen_, units_, planes.plane(id), row, first, i, ids, depth);
        }
    }

    const ScreenScene& screen_;
    SampleUnits units_;
    ResolveOptions options_;
    std::unique_ptr<LayerSource> layers_;
    Ties ties_;
    std::mutex mutex_;
    PaintCounts counts_;
};

}  // namespace

std::unique_ptr<RowSource> open_painted_rows(const ScreenScene& screen, const SampleGrid& grid,
                                             const ResolveOptions& options,
                                             std::unique_ptr<LayerSource> layers, Ties ties) {
    return std::make_unique<PaintedRows>(screen, grid, options, std::move(layers), ties);
}

}  // namespace sightline
