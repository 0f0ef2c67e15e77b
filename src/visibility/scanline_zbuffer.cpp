// The scan-line z-buffer: one row of depth, used again for every row of the picture.
//
// Source: A. Watt, "Fundamentals of Three-Dimensional Computer Graphics", 1989, section 5.3; the
// incremental depth is as old as the scan-line algorithms, see Sutherland, Sproull, Schumacker, "A
// Characterization of Ten Hidden-Surface Algorithms", 1974.
//
// How this version differs: depths run in 64-bit fixed point with 32 bits of fraction, so that the
// increments (z + A along the row, z + B + A times the columns that the left edge moves) gather an
// error that is bounded and tiny; what lies within it is decided in integers, and exact ties go to
// the lower id. So the answer is canonical. Bands of rows are independent: all cores work, and a
// picture can leave row by row.
//
// Time O(rows * active triangles + covered samples), memory O(columns + active triangles).
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "visibility/algorithms.hpp"
#include "visibility/counts.hpp"
#include "visibility/row_bands.hpp"
#include "visibility/scan_machine.hpp"

namespace sightline {

namespace {

using Fixed = std::int64_t;
constexpr int kFractionBits = 32;
constexpr double kOne = 4294967296.0;  // 2^kFractionBits
// A surface is regular when it rises by at most this over its box: then depths stay below
// 2^30 + 2 * 2^28 and their fixed-point form below 2^62.6.
constexpr double kRegular = 0x1p28;
// A start is off by the slack of its surface and the rounding to fixed point, gx and gy by 2^-32
// each; after at most 2^21 columns and the rows of a band, by less than 2^-10 more. Two depths
// further apart than kUncertain are in the order of the true ones.
constexpr double kMostSlack = 0x1p-10;
constexpr Fixed kUncertain = Fixed{1} << (kFractionBits - 8);
constexpr Fixed kNothing = std::numeric_limits<Fixed>::max() - 2 * kUncertain;

/// A triangle with the depth at its left end of the row.
struct Walker {
    ActiveTriangle active;
    Fixed z = 0, along = 0, down = 0;
    std::int32_t column = 0;  // where z is
    bool regular = false;

    Walker(const ScreenScene& screen, const SampleUnits& units, std::uint32_t number,
           std::int32_t row)
        : active(screen, units, number, row) {}
};

enum class Count : std::uint8_t { triangles, most_active, samples, exact };

constexpr std::array kCountNames{
    CountName{"triangles set up in bands"},
    CountName{"active triangles at most", Combine::maximum},
    CountName{"depth comparisons"},
    CountName{"exact comparisons"},
};

class Machine : public ScanMachine {
public:
    using Counts = sightline::Counts<Count, kCountNames>;

    using ScanMachine::ScanMachine;

    void add(std::uint32_t number) {
        active_.emplace_back(screen_, units_, number, row_);
        Walker& w = active_.back();
        if (w.active.rows.empty()) {
            active_.pop_back();
            return;
        }
        if (observer_ != nullptr) observer_->step({StepKind::triangle_taken, w.active.surface.id});
        start(w);
        ++counts[Count::triangles];
    }

    void resolve_row() {
        counts.reaches(Count::most_active, active_.size());
        z_.assign(static_cast<std::size_t>(units_.columns), kNothing);
        owner_.assign(static_cast<std::size_t>(units_.columns), kNone);
        for (std::uint32_t k = 0; k < active_.size(); ++k) {
            const Walker& w = active_[k];
            const std::int32_t left = w.active.rows.left(), right = w.active.rows.right();
            if (left >= right) continue;
            counts[Count::samples] += static_cast<std::uint64_t>(right - left);
            if (w.regular)
                draw(k, left, right);
            else
                draw_steep(k, left, right);
        }
        write();
        advance();
        counts[Count::exact] = judge_.exact;
    }

    Counts counts;

private:
    void start(Walker& w) const {
        const SampledPlane& s = w.active.surface;
        const RowTriangle& rows = w.active.rows;
        const double width = w.active.end_column - w.active.first_column + 1;
        const double height = rows.end_row() - rows.row() + 1;
        w.regular =
            std::abs(s.gx) * width + std::abs(s.gy) * height <= kRegular && s.slack <= kMostSlack;
        if (!w.regular) return;
        w.column = left_of(rows);
        const double z = s.depth(w.column, rows.row());
        // A shared plane may leave the depths of the scene beside its triangle.
        w.regular = std::abs(z) <= 0x1p30 + kRegular;
        if (!w.regular) return;
        w.z = static_cast<Fixed>(z * kOne);
        w.along = static_cast<Fixed>(s.gx * kOne);
        w.down = static_cast<Fixed>(s.gy * kOne);
    }

    [[nodiscard]] std::int32_t left_of(const RowTriangle& rows) const {
        return std::min(rows.left(), units_.columns);
    }

    // Not inlined, so that z has a register to itself.
    [[gnu::noinline]] void draw(std::uint32_t k, std::int32_t left, std::int32_t right) {
        const Walker& w = active_[k];
        const Fixed along = w.along;
        Fixed z = w.z + along * (left - w.column);
        for (std::int32_t i = left; i < right; ++i, z += along) offer(k, i, z);
    }

    // Too steep to be followed in fixed point: the quotient of the integers, rounded down.
    void draw_steep(std::uint32_t k, std::int32_t left, std::int32_t right) {
        const Plane plane = screen_.plane(active_[k].active.surface.id);
        constexpr Int128 kLimit = Int128{1} << 62;
        for (std::int32_t i = left; i < right; ++i) {
            const Int128 numerator =
                depth_numerator(plane, units_.position(i), units_.position(row_));
            const Int128 z = (numerator << kFractionBits) / plane.c;
            offer(k, i, static_cast<Fixed>(std::clamp(z, -kLimit, kLimit)));
        }
    }

    void offer(std::uint32_t k, std::int32_t i, Fixed z) {
        const auto at = static_cast<std::size_t>(i);
        const Fixed old = z_[at];
        if (z > old + kUncertain) return;
        if (z > old - kUncertain && !judge_.before(surface(k), surface(owner_[at]), i, row_))
            return;
        if (observer_ != nullptr) tell_owner(k, i, owner_[at]);
        z_[at] = z;
        owner_[at] = k;
    }

    [[nodiscard]] const SampledPlane& surface(std::uint32_t k) const {
        return active_[k].active.surface;
    }

    void tell_owner(std::uint32_t k, std::int32_t i, std::uint32_t before) const {
        const std::uint32_t id = before == kNone ? kNone : surface(before).id;
        tell(StepKind::sample_decided, surface(k), id, i, i + 1);
    }

    // Runs of one owner.
    void write() {
        const std::uint32_t* owner = owner_.data();
        for (std::int32_t i = 0; i < units_.columns;) {
            const std::uint32_t k = owner[i];
            std::int32_t end = i + 1;
            while (end < units_.columns && owner[end] == k) ++end;
            if (k == kNone)
                fill_background(i, end);
            else
                fill_run(surface(k), i, end);
            i = end;
        }
    }

    // The equations of the left edge: B down, and A for each column that the edge moves.
    void advance() {
        for (std::size_t k = 0; k < active_.size();) {
            Walker& w = active_[k];
            w.active.rows.advance(units_);
            if (w.active.rows.empty()) {
                w = active_.back();
                active_.pop_back();
                continue;
            }
            if (w.regular) {
                const std::int32_t left = left_of(w.active.rows);
                w.z += w.down + w.along * (left - w.column);
                w.column = left;
            }
            ++k;
        }
    }

    std::vector<Walker> active_;
    std::vector<Fixed> z_;              // the row of depth
    std::vector<std::uint32_t> owner_;  // and who it belongs to: an index into active_
};

}  // namespace

std::unique_ptr<RowSource> open_scanline_zbuffer(const ScreenScene& screen, const SampleGrid& grid,
                                                 const ResolveOptions& options) {
    return std::make_unique<RowScanner<Machine>>(screen, grid, options);
}

}  // namespace sightline
