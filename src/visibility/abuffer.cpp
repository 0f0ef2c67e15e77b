// The A-buffer: every position of the picture keeps all surfaces that can still be seen there.
//
// Source: L. Carpenter, "The A-buffer, an Antialiased Hidden Surface Method", 1984. This file has
// the A-buffer at point samples; fragments.cpp has the one whose positions are whole pixels, with
// coverage masks and areas.
//
// A position has two fields, as in the original: the nearest opaque surface, and a list of the
// translucent ones in front of it, which is mostly empty. Triangles come in any order. What lies
// behind the opaque surface of the moment is dropped at once, or when the lists are sorted.
//
// How this version differs: depths are compared exactly, so the order in a list is the canonical
// one (exact depth, then the lower id). And where only the nearest surface is asked for, every
// position is in the state of a single surface: that A-buffer is a z-buffer, whose code it shares.
//
// Time O(covered samples + k log k for lists of k); memory O(triangles) and, for each thread, the
// lists of a band of rows.
#include <algorithm>
#include <array>
#include <mutex>

#include "visibility/algorithms.hpp"
#include "visibility/counts.hpp"
#include "visibility/row_bands.hpp"

namespace sightline {

namespace {

enum class Count : std::uint8_t { fragments, hidden, kept, deepest, comparisons, exact };

constexpr std::array kCountNames{
    CountName{"fragments"},          CountName{"fragments found hidden"},
    CountName{"fragments in lists"}, CountName{"longest list", Combine::maximum},
    CountName{"depth comparisons"},  CountName{"exact comparisons"}};

using ListCounts = Counts<Count, kCountNames>;

/// The positions of one band of rows. Surfaces are numbered as they come.
class BandLists {
public:
    BandLists(const ScreenScene& screen, const SampleUnits& units, Observer* observer,
              std::int32_t first_row, std::int32_t rows)
        : units_(units),
          judge_(screen, units, observer),
          first_row_(first_row),
          width_(static_cast<std::size_t>(units.columns)),
          positions_(width_ * static_cast<std::size_t>(rows)) {}

    /// All samples that a triangle covers in the band.
    void add(ActiveTriangle triangle, bool translucent) {
        RowTriangle& rows = triangle.rows;
        const auto number = static_cast<std::uint32_t>(surfaces_.size());
        surfaces_.push_back(triangle.surface);
        const std::int32_t end = first_row_ + static_cast<std::int32_t>(positions_.size() / width_);
        for (; !rows.empty() && rows.row() < end; rows.advance(units_))
            for (std::int32_t i = rows.left(); i < rows.right(); ++i)
                add(number, translucent, i, rows.row());
    }

    /// Hands over what the lists hold, row by row, from back to front.
    void visit(RunSink& sink) {
        const auto rows = static_cast<std::int32_t>(positions_.size() / width_);
        for (std::int32_t r = 0; r < rows; ++r) {
            sort_row(first_row_ + r);
            visit_row(first_row_ + r, sink);
        }
        counts[Count::comparisons] = judge_.comparisons;
        counts[Count::exact] = judge_.exact;
    }

    ListCounts counts;

private:
    struct Position {
        std::uint32_t opaque = kNone;  ///< the nearest opaque surface
        std::uint32_t head = kNone;    ///< of the list of translucent ones
    };
    struct Node {
        std::uint32_t surface, next;
    };

    [[nodiscard]] std::size_t index(std::int32_t i, std::int32_t j) const {
        return static_cast<std::size_t>(j - first_row_) * width_ + static_cast<std::size_t>(i);
    }

    [[nodiscard]] bool before(std::uint32_t a, std::uint32_t b, std::int32_t i, std::int32_t j) {
        return judge_.before(surfaces_[a], surfaces_[b], i, j);
    }

    void add(std::uint32_t number, bool translucent, std::int32_t i, std::int32_t j) {
        ++counts[Count::fragments];
        Position& position = positions_[index(i, j)];
        if (position.opaque != kNone && !before(number, position.opaque, i, j)) {
            ++counts[Count::hidden];
        } else if (translucent) {
            nodes_.push_back({number, position.head});
            position.head = static_cast<std::uint32_t>(nodes_.size()) - 1;
        } else {
            position.opaque = number;
        }
    }

    /// Brings the lists of a row into one array, each from back to front.
    void sort_row(std::int32_t j) {
        sorted_.clear();
        ends_.clear();
        for (std::int32_t i = 0; i < units_.columns; ++i) {
            const Position& position = positions_[index(i, j)];
            const std::size_t first = sorted_.size();
            if (position.opaque != kNone) sorted_.push_back(position.opaque);
            for (std::uint32_t n = position.head; n != kNone; n = nodes_[n].next) {
                // It may have come before the surface that hides it.
                if (position.opaque == kNone || before(nodes_[n].surface, position.opaque, i, j))
                    sorted_.push_back(nodes_[n].surface);
                else
                    ++counts[Count::hidden];
            }
            const auto begin = sorted_.begin() + static_cast<std::ptrdiff_t>(first);
            std::sort(begin + (position.opaque != kNone ? 1 : 0), sorted_.end(),
                      [&](std::uint32_t a, std::uint32_t b) { return before(b, a, i, j); });
            counts.reaches(Count::deepest, sorted_.size() - first);
            ends_.push_back(sorted_.size());
        }
        counts[Count::kept] += sorted_.size();
    }

    /// The k-th surfaces from the back of neighbours, for ascending k: those of one triangle are a
    /// run.
    void visit_row(std::int32_t j, RunSink& sink) const {
        bool more = true;
        for (std::size_t level = 0; more; ++level) {
            more = false;
            Run run{kNone, j, 0, 0};
            for (std::int32_t i = 0; i < units_.columns; ++i) {
                const auto at = static_cast<std::size_t>(i);
                const std::size_t k = (at == 0 ? 0 : ends_[at - 1]) + level;
                const std::uint32_t id = k < ends_[at] ? surfaces_[sorted_[k]].id : kNone;
                more = more || id != kNone;
                if (id == run.id) continue;
                run.end = i;
                if (run.id != kNone) sink.take(run);
                run = {id, j, i, i};
            }
            run.end = units_.columns;
            if (run.id != kNone) sink.take(run);
        }
    }

    SampleUnits units_;
    DepthJudge judge_;
    std::int32_t first_row_;
    std::size_t width_;
    std::vector<SampledPlane> surfaces_;
    std::vector<Position> positions_;
    std::vector<Node> nodes_;
    std::vector<std::uint32_t> sorted_;  // of the row at hand, list by list
    std::vector<std::size_t> ends_;      // of each list
};

class ListLayers final : public LayerSource {
public:
    ListLayers(const ScreenScene& screen, const SampleGrid& grid, const ResolveOptions& options)
        : screen_(screen),
          units_(grid, screen.subpixel_bits()),
          options_(options),
          translucent_(translucent_triangles(screen.scene())),
          bands_(screen, units_, options) {}

    [[nodiscard]] std::uint32_t band_rows() const override { return RowBands::kRows; }

    void visit_band(std::uint32_t band, RunSink& sink) override {
        std::vector<std::uint32_t> numbers, starts;
        bands_.triangles_of(band, numbers, starts);
        const std::int32_t first = static_cast<std::int32_t>(band) * RowBands::kRows;
        BandLists lists(screen_, units_, options_.observer, first,
                        std::min(RowBands::kRows, units_.rows - first));
        for (const std::uint32_t k : numbers) {
            ActiveTriangle triangle(screen_, units_, k, first);
            if (triangle.rows.empty()) continue;
            const bool translucent = !translucent_.empty() && translucent_[screen_.id(k)] != 0;
            lists.add(triangle, translucent);
        }
        lists.visit(sink);
        const std::lock_guard lock(mutex_);
        counts_ += lists.counts;
    }

    void report() override { counts_.report(options_); }

private:
    const ScreenScene& screen_;
    SampleUnits units_;
    ResolveOptions options_;
    std::vector<std::uint8_t> translucent_;
    RowBands bands_;
    std::mutex mutex_;
    ListCounts counts_;
};

}  // namespace

void resolve_abuffer(const ScreenScene& screen, const ResolveOptions& options, Visibility& out) {
    resolve_zbuffer(screen, options, out);
}

std::unique_ptr<LayerSource> open_abuffer_layers(const ScreenScene& screen, const SampleGrid& grid,
                                                 const ResolveOptions& options) {
    return std::make_unique<ListLayers>(screen, grid, options);
}

}  // namespace sightline
