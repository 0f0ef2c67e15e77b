// Spans: in each row, one decision for every stretch between the ends of the polygons' segments.
//
// Source: G. Watkins, "A Real-Time Visible Surface Algorithm", University of Utah, 1970; the
// plane of a scan line cuts each polygon in a segment, and between two neighbouring ends of
// segments the set of segments does not change.
//
// How this version differs: a span is decided from its first and last sample. Depths along a row
// are linear, so the surface that wins at both (by depth, then id) wins at all between. Where two
// different ones win, they or others between them cross: the span is cut where the one at the left
// stops being nearer than the one at the right, and both halves are decided in the same way. So
// penetrating polygons need no care and the answer is canonical. Bands of rows are independent.
//
// Time O(spans * segments on them) a row, memory O(columns + active triangles).
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "visibility/active_pool.hpp"
#include "visibility/algorithms.hpp"
#include "visibility/counts.hpp"
#include "visibility/scan_machine.hpp"

namespace sightline {

namespace {

/// The part of a triangle that lies in the plane of the row: columns left .. right-1.
struct Segment {
    std::int32_t left, right;
    std::uint32_t slot;
};

enum class Count : std::uint8_t {
    segments,
    most_active,
    spans,
    samples,
    decisions,
    splits,
    comparisons,
    exact
};

constexpr std::array kCountNames{
    CountName{"segments"},
    CountName{"active triangles at most", Combine::maximum},
    CountName{"spans"},
    CountName{"samples in spans"},
    CountName{"span decisions"},
    CountName{"spans split at crossings"},
    CountName{"depth comparisons"},
    CountName{"exact comparisons"},
};

class Machine : public ScanMachine {
public:
    using Counts = sightline::Counts<Count, kCountNames>;

    using ScanMachine::ScanMachine;

    void add(std::uint32_t number) {
        const std::uint32_t slot = pool_.add(screen_, units_, number, row_);
        if (slot == kNone) return;
        if (observer_ != nullptr) observer_->step({StepKind::triangle_taken, pool_.plane(slot).id});
    }

    void resolve_row() {
        cut_segments();
        counts.reaches(Count::most_active, pool_.active().size());
        counts[Count::segments] += segments_.size();
        sweep(segments_);
        pool_.advance(units_);
        counts[Count::comparisons] = judge_.comparisons;
        counts[Count::exact] = judge_.exact;
    }

    Counts counts;

private:
    // The segments of this row in the order of their left ends.
    void cut_segments() {
        for (const std::uint32_t slot : pool_.active()) {
            const RowTriangle& rows = pool_.rows(slot);
            if (rows.left() < rows.right()) buckets_.put(rows.left(), slot);
        }
        segments_.clear();
        buckets_.take_all([&](std::int32_t left, std::uint32_t first) {
            for (std::uint32_t slot = first; slot != kNone; slot = buckets_.next(slot))
                segments_.push_back({left, pool_.rows(slot).right(), slot});
        });
    }

    // From boundary to boundary; on_ holds the segments between two of them.
    void sweep(const std::vector<Segment>& segments) {
        on_.clear();
        std::int32_t x = 0;
        for (std::size_t next = 0; next < segments.size() || !on_.empty();) {
            if (on_.empty()) {
                fill_background(x, segments[next].left);
                x = segments[next].left;
            }
            while (next < segments.size() && segments[next].left == x)
                on_.push_back(segments[next++]);
            std::int32_t end = next < segments.size() ? segments[next].left : units_.columns;
            for (const Segment& s : on_) end = std::min(end, s.right);
            take_span(x, end);
            std::erase_if(on_, [end](const Segment& s) { return s.right == end; });
            x = end;
        }
        fill_background(x, units_.columns);
    }

    void take_span(std::int32_t first, std::int32_t end) {
        ++counts[Count::spans];
        counts[Count::samples] += static_cast<std::uint64_t>(end - first);
        if (on_.size() == 1) {
            write(pool_.plane(on_[0].slot), first, end);
            return;
        }
        decide(first, end, nearest(first), nearest(end - 1));
    }

    // The winners at both ends are known.
    void decide(std::int32_t first, std::int32_t end, const SampledPlane& at_first,
                const SampledPlane& at_last) {
        if (&at_first == &at_last) {
            ++counts[Count::decisions];
            write(at_first, first, end);
            return;
        }
        ++counts[Count::splits];
        const std::int32_t cut = judge_.crossing(at_first, at_last, first, end - 1, row_);
        tell(StepKind::span_split, at_first, at_last.id, first, end);
        decide(first, cut, at_first, cut - 1 == first ? at_first : nearest(cut - 1));
        decide(cut, end, cut == end - 1 ? at_last : nearest(cut), at_last);
    }

    const SampledPlane& nearest(std::int32_t i) {
        const SampledPlane* best = &pool_.plane(on_[0].slot);
        for (std::size_t k = 1; k < on_.size(); ++k) {
            const SampledPlane& s = pool_.plane(on_[k].slot);
            if (judge_.before(s, *best, i, row_)) best = &s;
        }
        return *best;
    }

    void write(const SampledPlane& surface, std::int32_t first, std::int32_t end) {
        fill_run(surface, first, end);
        tell(StepKind::span_decided, surface, kNone, first, end);
    }

    ActivePool pool_;
    ColumnBuckets buckets_{units_.columns};
    std::vector<Segment> segments_;  // those that cover a sample of the row, by left end
    std::vector<Segment> on_;
};

}  // namespace

std::unique_ptr<RowSource> open_spans(const ScreenScene& screen, const SampleGrid& grid,
                                      const ResolveOptions& options) {
    return std::make_unique<RowScanner<Machine>>(screen, grid, options);
}

}  // namespace sightline
