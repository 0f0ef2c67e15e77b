// The scan-line algorithm: active edges in the order of x, and a decision only where a surface
// begins, ends or crosses the visible one.
//
// Sources: C. Wylie, G. Romney, D. Evans, A. Erdahl, "Half-tone perspective drawings by computer",
// 1967; W. Bouknight, "A procedure for generation of three-dimensional half-toned computer graphics
// presentations", CACM 13(9), 1970.
//
// How this version differs. Edges are walked in integers, so a surface is on at just the samples
// that it covers. A visible surface stays visible until it ends, a nearer one begins, or another
// one overtakes it, at a column found by one division: penetrating and cyclically overlapping
// surfaces need no care. Coherence from line to line is kept for each pair of surfaces instead of
// the whole list of edges: when one hides the other at the four corners of their common box, it
// does so on every further line, and depths of the two are not computed again. Decisions are by
// exact depth, then id: the canonical answer. Bands of rows are independent.
//
// Time O(rows * active edges + decisions), memory O(columns + active edges).
#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "visibility/active_pool.hpp"
#include "visibility/algorithms.hpp"
#include "visibility/counts.hpp"
#include "visibility/scan_machine.hpp"

namespace sightline {

namespace {

constexpr std::int32_t kNever = std::numeric_limits<std::int32_t>::max();

// An edge of the active edge list is named by its triangle's slot and its side: at its column the
// triangle's flag turns to in (left) or out (right).
constexpr std::uint32_t left_edge(std::uint32_t slot) { return 2 * slot; }
constexpr std::uint32_t right_edge(std::uint32_t slot) { return 2 * slot + 1; }
constexpr bool is_left(std::uint32_t edge) { return edge % 2 == 0; }
constexpr std::uint32_t slot_of(std::uint32_t edge) { return edge / 2; }

/// What is known of two surfaces wherever both are.
enum class Order : std::int8_t { either, first_hides, second_hides };

/// The last surface that another one was compared with.
struct Memory {
    std::uint32_t serial = 0;  ///< of the other
    Order order = Order::either;
};

enum class Count : std::uint8_t {
    edges,
    most_active,
    runs,
    alone,
    computed,
    kept,
    crossings,
    exact
};

constexpr std::array kCountNames{
    CountName{"edges activated"},     CountName{"active edges at most", Combine::maximum},
    CountName{"runs of one surface"}, CountName{"runs that needed no depth"},
    CountName{"depth comparisons"},   CountName{"decisions kept from lines before"},
    CountName{"crossings"},           CountName{"exact comparisons"},
};

class Machine : public ScanMachine {
public:
    using Counts = sightline::Counts<Count, kCountNames>;

    using ScanMachine::ScanMachine;

    void add(std::uint32_t number) {
        const std::uint32_t slot = pool_.add(screen_, units_, number, row_);
        if (slot == kNone) return;
        if (slot >= serial_.size()) {
            serial_.resize(slot + 1);
            memory_.resize(slot + 1);
        }
        serial_[slot] = ++last_serial_;
        memory_[slot] = {};
        counts[Count::edges] += 2;
        const RowTriangle& rows = pool_.rows(slot);
        for (const std::int32_t x : {rows.left(), rows.right()})
            tell(StepKind::edge_activated, surface(slot), kNone, x, x + 1);
    }

    void resolve_row() {
        list_edges();
        counts.reaches(Count::most_active, 2 * pool_.active().size());
        sweep();
        pool_.advance(units_);
        counts[Count::computed] = judge_.comparisons + related_;
        counts[Count::exact] = judge_.exact;
    }

    Counts counts;

private:
    [[nodiscard]] const SampledPlane& surface(std::uint32_t slot) const {
        return pool_.plane(slot);
    }

    // -- one line ----------------------------------------------------------------------------

    // The active edge list in the order of x. Triangles that lie between two samples of the line
    // stay away from it.
    void list_edges() {
        for (const std::uint32_t slot : pool_.active()) {
            const std::int32_t left = pool_.rows(slot).left(), right = pool_.rows(slot).right();
            if (left >= right) continue;
            edges_.put(left, left_edge(slot));
            edges_.put(right, right_edge(slot));
        }
    }

    void sweep() {
        on_.clear();
        visible_ = kNone;
        from_ = 0;
        change_ = kNever;
        edges_.take_all([&](std::int32_t x, std::uint32_t edge) {
            cross_until(x);
            const std::uint32_t before = visible_;
            begun_.clear();
            for (; edge != kNone; edge = edges_.next(edge)) turn_flag(edge);
            if (visible_ == kNone || before == kNone || change_ == x)
                decide_anew(x, before);
            else if (!begun_.empty())
                challenge(x);
        });
        emit(visible_, units_.columns);
    }

    void turn_flag(std::uint32_t edge) {
        const std::uint32_t slot = slot_of(edge);
        if (is_left(edge)) {
            on_.push_back(slot);
            begun_.push_back(slot);
            return;
        }
        *std::find(on_.begin(), on_.end(), slot) = on_.back();
        on_.pop_back();
        if (slot == visible_) visible_ = kNone;
    }

    // The crossings of the visible surface with others that lie before column x.
    void cross_until(std::int32_t x) {
        while (change_ < x) {
            ++counts[Count::crossings];
            const std::int32_t at = change_;
            const std::uint32_t before = visible_;
            emit(before, at);
            visible_ = nearest(at);
            tell(StepKind::span_split, surface(before), surface(visible_).id, at, at + 1);
            change_ = next_change(on_, at);
        }
    }

    // The visible surface has ended or is overtaken right here, or there was none.
    void decide_anew(std::int32_t x, std::uint32_t before) {
        if (before == kNone && on_.empty()) return;
        emit(before, x);
        change_ = kNever;
        if (on_.empty()) return;
        visible_ = nearest(x);
        change_ = next_change(on_, x);
        alone_ = on_.size() == 1;
    }

    // Surfaces begin while one is visible.
    void challenge(std::int32_t x) {
        const std::uint32_t before = visible_;
        std::uint32_t winner = before;
        for (const std::uint32_t slot : begun_)
            if (comes_before(slot, winner, x)) winner = slot;
        if (winner == before) {
            alone_ = false;
            change_ = std::min(change_, next_change(begun_, x));
            return;
        }
        emit(before, x);
        alone_ = false;
        visible_ = winner;
        change_ = next_change(on_, x);
    }

    std::uint32_t nearest(std::int32_t x) {
        std::uint32_t best = on_.front();
        for (std::size_t k = 1; k < on_.size(); ++k)
            if (comes_before(on_[k], best, x)) best = on_[k];
        return best;
    }

    // The first column after x at which one of the surfaces overtakes the visible one.
    std::int32_t next_change(const std::vector<std::uint32_t>& surfaces, std::int32_t x) {
        std::int32_t first = kNever;
        for (const std::uint32_t slot : surfaces)
            if (slot != visible_) first = std::min(first, overtaking(slot, x));
        return first;
    }

    std::int32_t overtaking(std::uint32_t slot, std::int32_t x) {
        if (order(visible_, slot) == Order::first_hides) return kNever;
        const std::int32_t last =
            std::min(pool_.rows(visible_).right(), pool_.rows(slot).right()) - 1;
        const SampledPlane &a = surface(visible_), &b = surface(slot);
        if (last <= x || judge_.before(a, b, last, row_)) return kNever;
        return judge_.crossing(a, b, x, last, row_);
    }

    bool comes_before(std::uint32_t a, std::uint32_t b, std::int32_t x) {
        const Order known = order(a, b);
        if (known != Order::either) return known == Order::first_hides;
        return judge_.before(surface(a), surface(b), x, row_);
    }

    // -- what is known of two surfaces ---------------------------------------------------------

    Order order(std::uint32_t a, std::uint32_t b) {
        if (memory_[b].serial == serial_[a]) return recall(memory_[b].order);
        if (memory_[a].serial == serial_[b]) return recall(reversed(memory_[a].order));
        const Order found = relate(a, b);
        memory_[b] = {serial_[a], found};
        return found;
    }

    Order recall(Order known) {
        if (known != Order::either) ++counts[Count::kept];
        return known;
    }

    static Order reversed(Order order) {
        if (order == Order::first_hides) return Order::second_hides;
        return order == Order::second_hides ? Order::first_hides : order;
    }

    // The difference of two depths is linear, so its extremes over the common box are at corners.
    Order relate(std::uint32_t a, std::uint32_t b) {
        const SampledPlane &s = surface(a), &t = surface(b);
        if (s.shared != kNone && s.shared == t.shared)
            return s.id < t.id ? Order::first_hides : Order::second_hides;
        ++related_;
        tell(StepKind::depths_compared, s, t.id, pool_.rows(a).left(), pool_.rows(a).right());
        const std::int32_t left = std::max(pool_.columns(a).first, pool_.columns(b).first);
        const std::int32_t right = std::min(pool_.columns(a).end, pool_.columns(b).end) - 1;
        const std::int32_t bottom = std::min(pool_.rows(a).end_row(), pool_.rows(b).end_row()) - 1;
        const double slack = s.slack + t.slack;
        bool first = true, second = true;
        for (const std::int32_t i : {left, right}) {
            for (const std::int32_t j : {row_, bottom}) {
                const double difference = s.depth(i, j) - t.depth(i, j);
                first = first && difference < -slack;
                second = second && difference > slack;
            }
        }
        if (first) return Order::first_hides;
        return second ? Order::second_hides : Order::either;
    }

    // -- output --------------------------------------------------------------------------------

    // Samples from_ .. end-1 belong to a surface, or to none.
    void emit(std::uint32_t slot, std::int32_t end) {
        if (end <= from_) return;
        if (slot == kNone) {
            fill_background(from_, end);
        } else {
            ++counts[Count::runs];
            counts[Count::alone] += alone_;
            fill_run(surface(slot), from_, end);
            tell(StepKind::span_decided, surface(slot), kNone, from_, end);
        }
        from_ = end;
    }

    ActivePool pool_;
    std::vector<std::uint32_t> serial_;  // of the triangle in each slot
    std::vector<Memory> memory_;         // by slot
    std::uint32_t last_serial_ = 0;
    std::uint64_t related_ = 0;
    ColumnBuckets edges_{units_.columns};    // the active edge list
    std::vector<std::uint32_t> on_, begun_;  // surfaces whose flag is in; those that just turned
    std::uint32_t visible_ = kNone;
    std::int32_t from_ = 0, change_ = kNever;  // the visible run's start, and its first crossing
    bool alone_ = false;                       // no other surface is on along the run
};

}  // namespace

std::unique_ptr<RowSource> open_scanline(const ScreenScene& screen, const SampleGrid& grid,
                                         const ResolveOptions& options) {
    return std::make_unique<RowScanner<Machine>>(screen, grid, options);
}

}  // namespace sightline
