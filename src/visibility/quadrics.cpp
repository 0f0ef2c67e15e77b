// Quadrics beside triangles.
//
// Source: E. Catmull, "Computer Display of Curved Surfaces", 1975: a z-buffer takes whatever
// surface can tell its z at a sample.
//
// How this version differs: the visible surface is the minimum of (depth, id), and a minimum is
// associative. So the triangles are decided first, by any algorithm, and the quadrics are offered
// afterwards, row by row; a quadric's z is a whole number, a triangle's depth a rational one, and
// they are compared in integers. Rows are independent: all cores work.
#include "visibility/quadrics.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <utility>
#include <vector>

#include "math/predicates.hpp"
#include "visibility/algorithms.hpp"
#include "visibility/parallel.hpp"
#include "visibility/sample_units.hpp"

namespace sightline {
namespace {

/// What was done, by many threads.
struct Counts {
    std::atomic<std::uint64_t> asked{0}, compared{0};

    void report(const ResolveOptions& options) const {
        count(options, "rays asked of quadrics", asked);
        count(options, "quadrics compared with triangles", compared);
    }
};

/// Works on one row after another. Each thread has its own.
class RowOffer {
public:
    RowOffer(const ScreenScene& screen, const SampleUnits& units, Observer* observer)
        : screen_(screen), units_(units), observer_(observer) {}

    /// `ids` and `depth` are those of row j.
    void offer(std::int32_t j, std::uint32_t* ids, float* depth, Counts& counts) {
        begin_ = units_.columns;
        end_ = 0;
        std::uint64_t asked = 0, compared = 0;
        const auto all = static_cast<std::uint32_t>(screen_.quadrics().rays.size());
        for (std::uint32_t k = 0; k < all; ++k) asked += find(k, j);
        for (std::int32_t i = begin_; i < end_; ++i) compared += settle(i, j, ids[i], depth[i]);
        if (asked > 0) counts.asked += asked;
        if (compared > 0) counts.compared += compared;
    }

private:
    /// Enters where quadric k lies before those asked already; tells how many samples it was asked.
    std::uint64_t find(std::uint32_t k, std::int32_t j) {
        const ScreenQuadric& rays = screen_.quadrics().rays[k];
        const std::int32_t y = units_.position(j);
        if (y < rays.y_min || y > rays.y_max) return 0;
        const std::int32_t first = std::max(0, units_.first_from(rays.x_min));
        const std::int32_t end = std::min(units_.columns, units_.last_until(rays.x_max) + 1);
        if (first >= end) return 0;
        reach(first, end);
        for (std::int32_t i = first; i < end; ++i) {
            const auto hit = hit_quadric(screen_, k, units_.position(i), y);
            NearestQuadric& best = nearest_[static_cast<std::size_t>(i)];
            if (hit && (best.id == kNone || hit->z < best.z))
                best = {screen_.scene().triangle_count() + k, hit->z};
        }
        return static_cast<std::uint64_t>(end - first);
    }

    /// Makes columns first .. end - 1 part of what is looked at.
    void reach(std::int32_t first, std::int32_t end) {
        if (begin_ >= end_) {
            begin_ = end_ = first;
            if (nearest_.empty()) nearest_.resize(static_cast<std::size_t>(units_.columns));
        }
        const auto clear = [&](std::int32_t from, std::int32_t until) {
            if (from < until)
                std::fill(nearest_.begin() + from, nearest_.begin() + until, NearestQuadric{});
        };
        clear(first, begin_);
        clear(end_, end);
        begin_ = std::min(begin_, first);
        end_ = std::max(end_, end);
    }

    /// Gives the sample to its nearest quadric when that lies before the triangle that has it;
    /// tells whether there were two to be compared.
    bool settle(std::int32_t i, std::int32_t j, std::uint32_t& id, float& depth) {
        const NearestQuadric& best = nearest_[static_cast<std::size_t>(i)];
        if (best.id == kNone) return false;
        const std::uint32_t before = id;
        if (before != kNone) {
            if (before != plane_of_) plane_ = screen_.plane(plane_of_ = before);
            if (!is_before_triangle(best.z, plane_, units_.position(i), units_.position(j)))
                return true;
        }
        id = best.id;
        depth = static_cast<float>(best.z);
        if (observer_ != nullptr) {
            const auto x = static_cast<std::uint32_t>(i), y = static_cast<std::uint32_t>(j);
            observer_->step({StepKind::sample_decided, id, before, x, y, x + 1, y + 1});
        }
        return before != kNone;
    }

    const ScreenScene& screen_;
    SampleUnits units_;
    Observer* observer_;
    std::int32_t begin_ = 0, end_ = 0;     // the columns of the row that some quadric reaches
    std::vector<NearestQuadric> nearest_;  // by column; set between begin_ and end_
    std::uint32_t plane_of_ = kNone;       // the triangle of plane_
    Plane plane_;
};

class QuadricRows : public RowSource {
public:
    QuadricRows(const ScreenScene& screen, const SampleGrid& grid, const ResolveOptions& options,
                std::unique_ptr<RowSource> triangles)
        : screen_(screen),
          units_(grid, screen.subpixel_bits()),
          options_(options),
          triangles_(std::move(triangles)) {}

    [[nodiscard]] std::uint32_t band_rows() const override { return triangles_->band_rows(); }

    void resolve_band(std::uint32_t band, std::uint32_t* ids, float* depth) override {
        triangles_->resolve_band(band, ids, depth);
        RowOffer offer(screen_, units_, options_.observer);
        const auto first = static_cast<std::int32_t>(band * band_rows());
        const std::int32_t end =
            std::min(units_.rows, first + static_cast<std::int32_t>(band_rows()));
        for (std::int32_t j = first; j < end; ++j) {
            const auto at =
                static_cast<std::size_t>(j - first) * static_cast<std::size_t>(units_.columns);
            offer.offer(j, ids + at, depth + at, counts_);
        }
    }

    void report() override {
        triangles_->report();
        counts_.report(options_);
    }

private:
    const ScreenScene& screen_;
    SampleUnits units_;
    ResolveOptions options_;
    std::unique_ptr<RowSource> triangles_;
    Counts counts_;
};

}  // namespace

std::optional<NearestQuadric> nearest_quadric(const ScreenScene& screen, std::int32_t x,
                                              std::int32_t y) {
    std::optional<NearestQuadric> best;
    for (std::uint32_t k = 0; k < screen.quadrics().rays.size(); ++k) {
        const auto hit = hit_quadric(screen, k, x, y);
        if (hit && (!best || hit->z < best->z))
            best = NearestQuadric{screen.scene().triangle_count() + k, hit->z};
    }
    return best;
}

bool is_before_triangle(std::int32_t z, const Plane& triangle, std::int32_t x, std::int32_t y) {
    return Int128{triangle.c} * z < depth_numerator(triangle, x, y);
}

void offer_quadrics(const ScreenScene& screen, const ResolveOptions& options, Visibility& out) {
    if (screen.quadrics().rays.empty()) return;
    constexpr std::uint32_t kRows = 16;  // that a thread takes at a time
    const SampleUnits units(out.grid, screen.subpixel_bits());
    Counts counts;
    for_each_index((out.grid.rows() + kRows - 1) / kRows, options, [&](std::uint32_t block) {
        RowOffer offer(screen, units, options.observer);
        const std::uint32_t end = std::min(out.grid.rows(), (block + 1) * kRows);
        for (std::uint32_t j = block * kRows; j < end; ++j) {
            const std::size_t at = std::size_t{j} * out.grid.columns();
            offer.offer(static_cast<std::int32_t>(j), out.ids.data() + at, out.depth.data() + at,
                        counts);
        }
    });
    counts.report(options);
}

std::unique_ptr<RowSource> offer_quadrics(const ScreenScene& screen, const SampleGrid& grid,
                                          const ResolveOptions& options,
                                          std::unique_ptr<RowSource> triangles) {
    if (screen.quadrics().rays.empty()) return triangles;
    return std::make_unique<QuadricRows>(screen, grid, options, std::move(triangles));
}

}  // namespace sightline
