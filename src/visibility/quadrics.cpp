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

/// Works on one row after another. Each thread has its own.
class RowOffer {
public:
    RowOffer(const ScreenScene& screen, const SampleUnits& units, Observer* observer)
        : screen_(screen), units_(units), observer_(observer) {}

    /// `ids` and `depth` are those of row j.
    void offer(std::int32_t j, std::uint32_t* ids, float* depth) {
        begin_ = units_.columns;
        end_ = 0;
        const auto all = static_cast<std::uint32_t>(screen_.quadrics().rays.size());
        for (std::uint32_t k = 0; k < all; ++k) asked += find(k, j);
        for (std::int32_t i = begin_; i < end_; ++i) compared += settle(i, j, ids[i], depth[i]);
    }

    std::uint64_t asked = 0;     ///< rays of quadrics
    std::uint64_t compared = 0;  ///< quadrics with triangles

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

/// Works on blocks of rows, any number of them at once.
class PictureOffer {
public:
    PictureOffer(const ScreenScene& screen, const SampleGrid& grid, const ResolveOptions& options)
        : screen_(screen), units_(grid, screen.subpixel_bits()), options_(options) {}

    /// Rows first .. first + count - 1, as far as the picture has them. `ids` and `depth` begin
    /// with row `first`.
    void offer(std::uint32_t first, std::uint32_t count, std::uint32_t* ids, float* depth) {
        RowOffer row(screen_, units_, options_.observer);
        const auto begin = static_cast<std::int32_t>(first);
        const std::int32_t end = std::min(units_.rows, begin + static_cast<std::int32_t>(count));
        for (std::int32_t j = begin; j < end; ++j) {
            row.offer(j, ids, depth);
            ids += units_.columns;
            depth += units_.columns;
        }
        asked_ += row.asked;
        compared_ += row.compared;
    }

    void report() const {
        count(options_, "rays asked of quadrics", asked_);
        count(options_, "quadrics compared with triangles", compared_);
    }

private:
    const ScreenScene& screen_;
    SampleUnits units_;
    ResolveOptions options_;
    std::atomic<std::uint64_t> asked_{0}, compared_{0};
};

class QuadricRows : public RowSource {
public:
    QuadricRows(const ScreenScene& screen, const SampleGrid& grid, const ResolveOptions& options,
                std::unique_ptr<RowSource> triangles)
        : triangles_(std::move(triangles)), quadrics_(screen, grid, options) {}

    [[nodiscard]] std::uint32_t band_rows() const override { return triangles_->band_rows(); }

    void resolve_band(std::uint32_t band, std::uint32_t* ids, float* depth) override {
        triangles_->resolve_band(band, ids, depth);
        quadrics_.offer(band * band_rows(), band_rows(), ids, depth);
    }

    void report() override {
        triangles_->report();
        quadrics_.report();
    }

private:
    std::unique_ptr<RowSource> triangles_;
    PictureOffer quadrics_;
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
    PictureOffer quadrics(screen, out.grid, options);
    for_each_index((out.grid.rows() + kRows - 1) / kRows, options, [&](std::uint32_t block) {
        const std::size_t at = std::size_t{block} * kRows * out.grid.columns();
        quadrics.offer(block * kRows, kRows, out.ids.data() + at, out.depth.data() + at);
    });
    quadrics.report();
}

std::unique_ptr<RowSource> offer_quadrics(const ScreenScene& screen, const SampleGrid& grid,
                                          const ResolveOptions& options,
                                          std::unique_ptr<RowSource> triangles) {
    if (screen.quadrics().rays.empty()) return triangles;
    return std::make_unique<QuadricRows>(screen, grid, options, std::move(triangles));
}

}  // namespace sightline
