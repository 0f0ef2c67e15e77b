#include "math/page_grid.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <array>
#include <atomic>
#include <bit>
#include <cmath>

#include "math/clipped_triangle.hpp"

namespace sightline {
namespace {

constexpr int kMaxShift = 25;            // one cell holds the page
constexpr std::size_t kCellsPerBox = 4;  // and a few more for small scenes
constexpr std::size_t kFewCells = 1024;
constexpr std::uint32_t kFewOfOne = 8;  // in more cells the nearest z of each one pays

void extend(PageBounds& all, const PageBounds& box) {
    all.x0 = std::min(all.x0, box.x0);
    all.x1 = std::max(all.x1, box.x1);
    all.y0 = std::min(all.y0, box.y0);
    all.y1 = std::max(all.y1, box.y1);
}

/// Cells as large as this are just larger than the triangle; those for a thin one are so small that
/// it passes a good dozen of them.
int shift_of(const PageTriangle& t) {
    constexpr double kLongest = 32;  // in cells
    const double size = std::max(t.box.x1 - t.box.x0, t.box.y1 - t.box.y0);
    const double area2 =
        std::abs((static_cast<double>(t.q.x) - t.p.x) * (static_cast<double>(t.r.y) - t.p.y) -
                 (static_cast<double>(t.q.y) - t.p.y) * (static_cast<double>(t.r.x) - t.p.x));
    const double thickness = size > 0 ? area2 / size : 0;
    const double cell = std::clamp(2 * thickness, size / kLongest, size);
    return std::min<int>(static_cast<int>(std::bit_width(static_cast<std::uint32_t>(cell))),
                         kMaxShift);
}

std::size_t count_cells(const PageBounds& box, int shift) {
    return static_cast<std::size_t>((box.x1 >> shift) - (box.x0 >> shift) + 1) *
           static_cast<std::size_t>((box.y1 >> shift) - (box.y0 >> shift) + 1);
}

template <class Body>
void for_ranges(std::size_t n, const Body& body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 4096), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
    });
}

}  // namespace

void VisitMarks::begin(std::size_t items) {
    if (marks_.size() < items) marks_.resize(items, 0);
    if (++now_ == 0) {
        std::ranges::fill(marks_, 0);
        now_ = 1;
    }
}

PageGrid::PageGrid(std::span<const PageTriangle> triangles) : level_of_(triangles.size()) {
    choose_levels(triangles);
    fill(triangles);
    sort_cells();
}

// Boxes of one size whose grid would have too many cells move to larger cells.
void PageGrid::choose_levels(std::span<const PageTriangle> triangles) {
    struct Class {
        PageBounds bounds{INT32_MAX, INT32_MIN, INT32_MAX, INT32_MIN};
        std::size_t count = 0;
    };
    std::array<Class, kMaxShift + 1> classes;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const int shift = shift_of(triangles[i]);
        level_of_[i] = static_cast<std::uint8_t>(shift);
        Class& own = classes[static_cast<std::size_t>(shift)];
        extend(own.bounds, triangles[i].box);
        ++own.count;
    }
    std::array<std::uint8_t, kMaxShift + 1> level_of_shift{};
    for (int shift = 0; shift <= kMaxShift; ++shift) {
        Class& own = classes[static_cast<std::size_t>(shift)];
        if (own.count == 0) continue;
        level_of_shift[static_cast<std::size_t>(shift)] = static_cast<std::uint8_t>(levels_.size());
        const std::size_t cells = count_cells(own.bounds, shift);
        if (shift < kMaxShift && cells > kCellsPerBox * own.count + kFewCells) {
            Class& next = classes[static_cast<std::size_t>(shift) + 1];
            extend(next.bounds, own.bounds);
            next.count += own.count;
            continue;
        }
        Level level;
        level.shift = shift;
        level.column0 = own.bounds.x0 >> shift;
        level.row0 = own.bounds.y0 >> shift;
        level.columns = (own.bounds.x1 >> shift) - level.column0 + 1;
        level.rows = (own.bounds.y1 >> shift) - level.row0 + 1;
        level.first_cell = levels_.empty() ? 0
                                           : levels_.back().first_cell +
                                                 static_cast<std::size_t>(levels_.back().columns) *
                                                     static_cast<std::size_t>(levels_.back().rows);
        levels_.push_back(level);
    }
    for (std::uint8_t& level : level_of_) level = level_of_shift[level];
}

std::int32_t PageGrid::near_in(const Level& level, std::int32_t row, std::int32_t column,
                               const PageTriangle& t) {
    ClippedTriangle part(t.p, t.q, t.r);
    using Corner = ClippedTriangle::Corner;
    const std::pair<double, double> slab = PageGrid::slab(level, row);
    const double top = slab.first, bottom = slab.second;
    const double left = static_cast<double>(std::int64_t{column + level.column0} << level.shift);
    const double right = left + (bottom - top);
    // A unit more on every side, for rounding.
    part.keep([&](const Corner& c) { return c.y - (top - 1); });
    part.keep([&](const Corner& c) { return bottom + 1 - c.y; });
    part.keep([&](const Corner& c) { return c.x - (left - 1); });
    part.keep([&](const Corner& c) { return right + 1 - c.x; });
    if (part.corners().empty()) return t.box.far;
    double nearest = part.corners()[0].z;
    for (const Corner& c : part.corners()) nearest = std::min(nearest, c.z);
    // The box may reach nearer than the corners, by the plane that the triangle shares.
    const double beyond = static_cast<double>(std::min({t.p.z, t.q.z, t.r.z})) - t.box.near;
    return std::max(t.box.near, static_cast<std::int32_t>(nearest - beyond - 2));
}

void PageGrid::fill(std::span<const PageTriangle> triangles) {
    if (levels_.empty()) return;
    const Level& last = levels_.back();
    start_.assign(cell_of(last, last.rows, 0) + 1, 0);
    const auto each_cell = [&](std::size_t item, const auto& body) {
        const Level& level = levels_[level_of_[item]];
        for_rows(level, triangles[item], [&](std::int32_t row, const CellRange& range) {
            for (std::int32_t column = range.column0; column <= range.column1; ++column)
                body(level, row, column);
        });
    };
    // In any order: the cells are sorted afterwards.
    std::vector<std::uint32_t> cells(triangles.size());
    for_ranges(triangles.size(), [&](std::size_t i) {
        each_cell(i, [&](const Level& level, std::int32_t row, std::int32_t column) {
            ++std::atomic_ref(start_[cell_of(level, row, column)]);
            ++cells[i];
        });
    });
    std::size_t end = 0;
    for (std::size_t& start : start_) start = end += start;
    residents_.resize(end);
    for_ranges(triangles.size(), [&](std::size_t i) {
        each_cell(i, [&](const Level& level, std::int32_t row, std::int32_t column) {
            Resident resident{triangles[i].box, static_cast<std::uint32_t>(i),
                              is_long(cells_of(level, triangles[i].box)) ? 1u : 0u};
            if (cells[i] > kFewOfOne) resident.box.near = near_in(level, row, column, triangles[i]);
            residents_[--std::atomic_ref(start_[cell_of(level, row, column)])] = resident;
        });
    });
}

void PageGrid::sort_cells() {
    constexpr std::size_t kCells = 1024;
    if (start_.empty()) return;
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, start_.size() - 1, kCells), [&](const auto& range) {
            for (std::size_t cell = range.begin(); cell != range.end(); ++cell) {
                const auto own =
                    std::span(residents_).subspan(start_[cell], start_[cell + 1] - start_[cell]);
                std::ranges::sort(own, [](const Resident& a, const Resident& b) {
                    return a.box.near != b.box.near ? a.box.near < b.box.near : a.item < b.item;
                });
            }
        });
}

std::pair<double, double> PageGrid::extent_between(const PageTriangle& t, double top,
                                                   double bottom) {
    double x0 = t.box.x1, x1 = t.box.x0;
    const auto add = [&](double x) {
        x0 = std::min(x0, x);
        x1 = std::max(x1, x);
    };
    const auto add_side = [&](const ScreenPoint& a, const ScreenPoint& b) {
        const double ay = a.y, by = b.y;
        if (top <= ay && ay <= bottom) add(a.x);
        for (const double y : {top, bottom})
            if ((ay < y) != (by < y))
                add(a.x + (y - ay) / (by - ay) * (static_cast<double>(b.x) - a.x));
    };
    add_side(t.p, t.q);
    add_side(t.q, t.r);
    add_side(t.r, t.p);
    return {x0, x1};
}

}  // namespace sightline
