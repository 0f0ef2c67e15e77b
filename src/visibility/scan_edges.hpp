// Triangles as scan lines meet them: for each row of samples, the interval of columns that a
// triangle covers, followed from row to row in integers.
//
// Source: J. Bresenham, "Algorithm for computer control of a digital plotter", 1965, for the
// division that is carried along as a remainder; the top-left rule falls out of rounding both ends
// of the interval upwards and of half-open rows: a sample on a left or top edge is inside, one on a
// right or bottom edge is not. So the intervals equal covers() of the predicates in every sample.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "math/predicates.hpp"
#include "visibility/sample_units.hpp"

namespace sightline {

/// A corner, as the walks need it.
struct ScanPoint {
    std::int32_t x, y;
};

/// Where an edge crosses a row: the first column at or right of it.
class EdgeWalk {
public:
    EdgeWalk() = default;

    /// The edge from p down to q (p.y < q.y), at row j.
    EdgeWalk(ScanPoint p, ScanPoint q, const SampleUnits& units, std::int32_t j) {
        const std::int64_t dx = std::int64_t{q.x} - p.x, dy = std::int64_t{q.y} - p.y;
        const double inverse = 1.0 / static_cast<double>(dy);
        // column = ceil(numerator / divisor); error = numerator - column * divisor, in
        // (-divisor, 0].
        divisor_ = dy << units.step_bits;
        const std::int64_t numerator =
            (std::int64_t{p.x} - units.offset) * dy + dx * (std::int64_t{units.position(j)} - p.y);
        const double step = units.step();
        const std::int64_t column = -floor_divide(-numerator, divisor_, inverse / step);
        error_ = numerator - column * divisor_;
        column_ = static_cast<std::int32_t>(column);
        const std::int64_t whole = floor_divide(dx, dy, inverse);
        whole_ = static_cast<std::int32_t>(whole);
        part_ = (dx - whole * dy) << units.step_bits;
    }

    [[nodiscard]] std::int32_t column() const { return column_; }

    /// To the next row.
    void advance() {
        error_ += part_;
        const bool over = error_ > 0;
        column_ += whole_ + static_cast<std::int32_t>(over);
        error_ -= over ? divisor_ : 0;
    }

private:
    // floor(n / d), given 1 / d: |n| < 2^51, so the product is off by less than one and the
    // remainder tells by how much. Several times faster than a division of 64-bit integers.
    static std::int64_t floor_divide(std::int64_t n, std::int64_t d, double inverse) {
        auto quotient = static_cast<std::int64_t>(static_cast<double>(n) * inverse);
        const std::int64_t rest = n - quotient * d;
        quotient -= static_cast<std::int64_t>(rest < 0);
        quotient += static_cast<std::int64_t>(rest >= d);
        return quotient;
    }

    std::int64_t divisor_, error_, part_;
    std::int32_t column_, whole_;
};

/// The columns that a triangle covers, row by row.
class RowTriangle {
public:
    /// Stands at row `first` or at the triangle's first row, whichever is lower on the page.
    RowTriangle(const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c,
                const SampleUnits& units, std::int32_t first)
        : columns_(units.columns), top_{a.x, a.y}, middle_{b.x, b.y}, bottom_{c.x, c.y} {
        if (middle_.y < top_.y) std::swap(top_, middle_);
        if (bottom_.y < middle_.y) std::swap(middle_, bottom_);
        if (middle_.y < top_.y) std::swap(top_, middle_);
        row_ = std::max(first, units.first_from(top_.y));
        turn_ = units.first_from(middle_.y);
        end_ = std::min(units.rows, units.first_from(bottom_.y));
        const std::int64_t turn = side(top_.x, top_.y, bottom_.x, bottom_.y, middle_.x, middle_.y);
        if (turn == 0) end_ = row_;  // no area
        if (empty()) return;
        long_is_left_ = turn < 0;
        (long_is_left_ ? left_ : right_) = EdgeWalk(top_, bottom_, units, row_);
        set_short(units);
    }

    [[nodiscard]] bool empty() const { return row_ >= end_; }
    [[nodiscard]] std::int32_t row() const { return row_; }
    [[nodiscard]] std::int32_t end_row() const { return end_; }
    /// Columns left() .. right()-1 are covered in this row; none when left() >= right().
    [[nodiscard]] std::int32_t left() const { return std::max(left_.column(), 0); }
    [[nodiscard]] std::int32_t right() const { return std::min(right_.column(), columns_); }

    /// To the next row; empty() tells when there is none.
    void advance(const SampleUnits& units) {
        if (++row_ >= end_) return;
        left_.advance();
        right_.advance();
        if (row_ == turn_) set_short(units);
    }

private:
    // The side that turns at the middle corner.
    void set_short(const SampleUnits& units) {
        EdgeWalk& walk = long_is_left_ ? right_ : left_;
        walk = row_ < turn_ ? EdgeWalk(top_, middle_, units, row_)
                            : EdgeWalk(middle_, bottom_, units, row_);
    }

    EdgeWalk left_, right_;
    std::int32_t row_, turn_, end_, columns_;
    ScanPoint top_, middle_, bottom_;
    bool long_is_left_ = false;
};

}  // namespace sightline
