// Grids over the triangles of a page: which of them can meet this line, this box, or one another?
//
// Source: a hierarchy of uniform grids, as in C. Ericson, "Real-Time Collision Detection", 2005,
// section 7.2. How this version differs: a triangle stands in the grid whose cells are just larger
// than it (a thin one in a finer grid), in every cell that it touches, so that a search looks at no
// neighbours; each grid spans only what it holds, and none has more cells than a few a triangle;
// in a cell the nearest ones come first, so that a search ends at the depth it asks for and meets
// what hides before what is hidden; a search for a line walks along the line.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "math/page_line.hpp"
#include "math/raw_vector.hpp"
#include "sightline/screen_scene.hpp"

namespace sightline {

/// The extents of a triangle in x, y and z, ends included.
struct SpaceBox : PageBounds {
    std::int32_t near = 0, far = 0;

    // All comparisons at once: as branches they would be guessed wrongly half of the time.
    [[nodiscard]] bool meets(const PageBounds& other) const {
        return (static_cast<int>(x0 <= other.x1) & static_cast<int>(other.x0 <= x1) &
                static_cast<int>(y0 <= other.y1) & static_cast<int>(other.y0 <= y1)) != 0;
    }
    [[nodiscard]] bool meets(const SpaceBox& other) const {
        return (static_cast<int>(meets(static_cast<const PageBounds&>(other))) &
                static_cast<int>(near <= other.far) & static_cast<int>(other.near <= far)) != 0;
    }
};

/// Remembers what a search has visited already: a box stands in several cells. One a thread.
class VisitMarks {
public:
    /// Forgets everything. Amortised O(1).
    void begin(std::size_t items);
    /// True the first time.
    bool visit(std::uint32_t item) {
        if (marks_[item] == now_) return false;
        marks_[item] = now_;
        return true;
    }

private:
    std::vector<std::uint32_t> marks_;
    std::uint32_t now_ = 0;
};

/// A triangle and its extents.
struct PageTriangle {
    ScreenPoint p, q, r;
    SpaceBox box;
};

/// Read-only once made, so any number of threads may search it. Coordinates within 2^24 of 0.
class PageGrid {
public:
    /// O(n log n), on all cores but for O(n).
    explicit PageGrid(std::span<const PageTriangle> triangles);

    /// Walks along the line p -> q through the cells that it passes, cell after cell of each grid.
    /// visitor.enter(t0, t1) hears which part of the line may lie in a cell, as fractions of its
    /// length, and answers whether the triangles there matter; visitor.visit(item) then hears of
    /// those not met before, near ones first, whose box meets that of the line and that have a
    /// point no deeper than `far`, until it answers false; once visitor.done() the walk ends. The
    /// order depends on the triangles and the answers alone.
    template <class Visitor>
    void walk(const ScreenPoint& p, const ScreenPoint& q, std::int32_t far, VisitMarks& marks,
              Visitor& visitor) const;

    /// visit(item) once for every triangle that comes near a box, whose own box meets it and that
    /// has a point no deeper than `far`. In an order that depends on the triangles alone.
    template <class Visit>
    void search(const PageBounds& box, std::int32_t far, VisitMarks& marks,
                const Visit& visit) const;

    /// Cells of all grids; the arguments of pairs().
    [[nodiscard]] std::size_t cell_count() const { return start_.empty() ? 0 : start_.size() - 1; }

    // Every two triangles whose boxes meet in x, y and z are met once, by pairs() over all cells or
    // by partners() over all items.

    /// visit(a, b): pairs of short triangles (of at most 2 x 2 cells) in one grid.
    template <class Visit>
    void pairs(std::size_t begin_cell, std::size_t end_cell, const Visit& visit) const;

    /// visit(other): those that stand in coarser grids, and in the same one when the item is long.
    template <class Visit>
    void partners(std::uint32_t item, const PageTriangle& triangle, VisitMarks& marks,
                  const Visit& visit) const;

private:
    struct Resident {
        SpaceBox box;  // its near may be that of the part in the cell
        std::uint32_t item;
        /// 1: its box is larger than 2 x 2 cells, and it does not stand in all of them.
        std::uint32_t is_long;
    };
    /// The grid of boxes of one size: cells of 2^shift units.
    struct Level {
        int shift = 0;
        std::int32_t column0 = 0, row0 = 0, columns = 0, rows = 0;
        std::size_t first_cell = 0;
    };
    struct CellRange {
        std::int32_t column0, column1, row0, row1;  // ends included; empty when 0 > 1
    };

    [[nodiscard]] static CellRange cells_of(const Level& level, const PageBounds& box) {
        const auto low = [](std::int32_t v, int shift, std::int32_t origin) {
            return std::max((v >> shift) - origin, 0);
        };
        return {low(box.x0, level.shift, level.column0),
                std::min((box.x1 >> level.shift) - level.column0, level.columns - 1),
                low(box.y0, level.shift, level.row0),
                std::min((box.y1 >> level.shift) - level.row0, level.rows - 1)};
    }
    [[nodiscard]] std::span<const Resident> residents(const Level& level, std::int32_t row,
                                                      std::int32_t column) const {
        const std::size_t cell = cell_of(level, row, column);
        return {residents_.data() + start_[cell], start_[cell + 1] - start_[cell]};
    }
    [[nodiscard]] static std::size_t cell_of(const Level& level, std::int32_t row,
                                             std::int32_t column) {
        return level.first_cell +
               static_cast<std::size_t>(row) * static_cast<std::size_t>(level.columns) +
               static_cast<std::size_t>(column);
    }
    /// The y extent of a row of cells.
    [[nodiscard]] static std::pair<double, double> slab(const Level& level, std::int32_t row) {
        const double top = static_cast<double>(std::int64_t{row + level.row0} << level.shift);
        return {top, top + static_cast<double>(std::int64_t{1} << level.shift)};
    }
    /// The part of a line, as fractions of its length, in which one coordinate is within an extent,
    /// a unit more on either side.
    [[nodiscard]] static std::pair<double, double> part_between(double from, double way, double low,
                                                                double high) {
        if (way == 0) return {0.0, 1.0};
        const double a = (low - 1 - from) / way, b = (high + 1 - from) / way;
        return {std::max(0.0, std::min(a, b)), std::min(1.0, std::max(a, b))};
    }
    /// Makes columns out of an extent in x, and a unit more on either side for rounding.
    static void narrow(const Level& level, double x0, double x1, CellRange& range) {
        const auto column = [&](double x) {
            return (static_cast<std::int32_t>(std::clamp(x, -0x1p24, 0x1p24)) >> level.shift) -
                   level.column0;
        };
        range.column0 = std::max(range.column0, column(x0 - 1));
        range.column1 = std::min(range.column1, column(x1 + 1));
    }
    /// Others stand in all cells of their box.
    [[nodiscard]] static bool is_long(const CellRange& range) {
        return range.row1 > range.row0 + 1 || range.column1 > range.column0 + 1;
    }
    /// Whether two triangles are short and a cell is the first one in which their boxes meet.
    [[nodiscard]] static bool is_first_common(const Level& level, const Resident& a,
                                              const Resident& b, std::int32_t row,
                                              std::int32_t column) {
        if ((a.is_long | b.is_long) != 0) return false;
        return (std::max(a.box.x0, b.box.x0) >> level.shift) - level.column0 == column &&
               (std::max(a.box.y0, b.box.y0) >> level.shift) - level.row0 == row;
    }
    /// body(row, range) for the cells that a triangle may touch.
    template <class Body>
    static void for_rows(const Level& level, const PageTriangle& triangle, const Body& body) {
        const CellRange all = cells_of(level, triangle.box);
        for (std::int32_t row = all.row0; row <= all.row1; ++row) {
            CellRange range = all;
            if (is_long(all)) {
                const auto [top, bottom] = slab(level, row);
                const auto [x0, x1] = extent_between(triangle, top, bottom);
                narrow(level, x0, x1, range);
            }
            if (range.column0 <= range.column1) body(row, range);
        }
    }
    /// Extent in x of the part of a triangle with top <= y <= bottom.
    [[nodiscard]] static std::pair<double, double> extent_between(const PageTriangle& triangle,
                                                                  double top, double bottom);
    /// The nearest z of the part of a triangle in a cell, or nearer.
    [[nodiscard]] static std::int32_t near_in(const Level& level, std::int32_t row,
                                              std::int32_t column, const PageTriangle& triangle);
    void choose_levels(std::span<const PageTriangle> triangles);
    void fill(std::span<const PageTriangle> triangles);
    void sort_cells();

    std::vector<std::uint8_t> level_of_;  // of each item
    std::vector<Level> levels_;           // small cells first
    std::vector<std::size_t> start_;      // residents of cell c: start_[c] .. start_[c + 1] - 1
    RawVector<Resident> residents_;       // of a cell: the nearest first
};

template <class Visitor>
void PageGrid::walk(const ScreenPoint& p, const ScreenPoint& q, std::int32_t far, VisitMarks& marks,
                    Visitor& visitor) const {
    const auto [x0, x1] = std::minmax(p.x, q.x);
    const auto [y0, y1] = std::minmax(p.y, q.y);
    const PageBounds box{x0, x1, y0, y1};
    const double dx = static_cast<double>(q.x) - p.x, dy = static_cast<double>(q.y) - p.y;
    marks.begin(level_of_.size());
    for (const Level& level : levels_) {
        const CellRange all = cells_of(level, box);
        for (std::int32_t row = all.row0; row <= all.row1; ++row) {
            const auto [top, bottom] = slab(level, row);
            CellRange range = all;
            if (all.row0 < all.row1 && all.column0 < all.column1) {
                const double at_top = p.x + dx / dy * (top - p.y);
                const double at_bottom = p.x + dx / dy * (bottom - p.y);
                narrow(level, std::min(at_top, at_bottom), std::max(at_top, at_bottom), range);
            }
            const auto [row0, row1] = part_between(p.y, dy, top, bottom);
            for (std::int32_t column = range.column0; column <= range.column1; ++column) {
                const std::span<const Resident> own = residents(level, row, column);
                if (own.empty()) continue;
                const double left =
                    static_cast<double>(std::int64_t{column + level.column0} << level.shift);
                const auto [t0, t1] = part_between(p.x, dx, left, left + (bottom - top));
                if (!visitor.enter(std::max(row0, t0), std::min(row1, t1))) continue;
                for (const Resident& r : own) {
                    if (r.box.near > far) break;
                    if (r.box.meets(box) && marks.visit(r.item) && !visitor.visit(r.item)) break;
                }
                if (visitor.done()) return;
            }
        }
    }
}

template <class Visit>
void PageGrid::search(const PageBounds& box, std::int32_t far, VisitMarks& marks,
                      const Visit& visit) const {
    marks.begin(level_of_.size());
    for (const Level& level : levels_) {
        const CellRange range = cells_of(level, box);
        for (std::int32_t row = range.row0; row <= range.row1; ++row) {
            for (std::int32_t column = range.column0; column <= range.column1; ++column) {
                for (const Resident& r : residents(level, row, column)) {
                    if (r.box.near > far) break;
                    if (r.box.meets(box) && marks.visit(r.item)) visit(r.item);
                }
            }
        }
    }
}

template <class Visit>
void PageGrid::pairs(std::size_t begin_cell, std::size_t end_cell, const Visit& visit) const {
    std::size_t l = 0;
    for (std::size_t cell = begin_cell; cell < end_cell; ++cell) {
        while (l + 1 < levels_.size() && levels_[l + 1].first_cell <= cell) ++l;
        const Level& level = levels_[l];
        const auto columns = static_cast<std::size_t>(level.columns);
        const auto row = static_cast<std::int32_t>((cell - level.first_cell) / columns);
        const auto column = static_cast<std::int32_t>((cell - level.first_cell) % columns);
        const std::span<const Resident> own = residents(level, row, column);
        for (std::size_t i = 0; i < own.size(); ++i) {
            const Resident& r = own[i];
            for (std::size_t j = i + 1; j < own.size() && own[j].box.near <= r.box.far; ++j)
                if (r.box.meets(own[j].box) && is_first_common(level, r, own[j], row, column))
                    visit(r.item, own[j].item);
        }
    }
}

template <class Visit>
void PageGrid::partners(std::uint32_t item, const PageTriangle& triangle, VisitMarks& marks,
                        const Visit& visit) const {
    const SpaceBox& box = triangle.box;
    const std::size_t own = level_of_[item];
    const bool long_one = is_long(cells_of(levels_[own], box));
    if (!long_one && own + 1 == levels_.size()) return;
    marks.begin(level_of_.size());
    for (std::size_t l = long_one ? own : own + 1; l < levels_.size(); ++l) {
        const Level& level = levels_[l];
        for_rows(level, triangle, [&](std::int32_t row, const CellRange& range) {
            for (std::int32_t column = range.column0; column <= range.column1; ++column) {
                for (const Resident& r : residents(level, row, column)) {
                    if (r.box.near > box.far) break;
                    if (!r.box.meets(box)) continue;
                    // Two long ones of one grid meet twice; the lower number counts.
                    if (l == own && r.item <= item && r.is_long != 0) continue;
                    if (marks.visit(r.item)) visit(r.item);
                }
            }
        });
    }
}

}  // namespace sightline
