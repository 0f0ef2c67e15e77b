// Drawings in sample points: what the definition says is seen there, and what a drawing says.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "math/predicates.hpp"
#include "sightline/drawing.hpp"

namespace sightline::testing {

/// Ids of things on a page, by the cells of a uniform grid, about as many cells as things.
class PageCells {
public:
    PageCells(const Resolution& size, int subpixel_bits, std::size_t things)
        : side_(1 + static_cast<std::size_t>(std::sqrt(static_cast<double>(things)))),
          scale_(static_cast<double>(side_) / std::ldexp(1.0, subpixel_bits) /
                 glm::dvec2(size.width, size.height)),
          cells_(side_ * side_) {}

    /// What has a point between low and high is then found there: cell_of() is monotone.
    void add(const glm::dvec2& low, const glm::dvec2& high, std::uint32_t id) {
        const Cell first = cell_of(low), last = cell_of(high);
        for (std::size_t row = first.row; row <= last.row; ++row)
            for (std::size_t column = first.column; column <= last.column; ++column)
                cells_[row * side_ + column].push_back(id);
    }

    [[nodiscard]] const std::vector<std::uint32_t>& around(const glm::dvec2& p) const {
        const Cell cell = cell_of(p);
        return cells_[cell.row * side_ + cell.column];
    }

private:
    struct Cell {
        std::size_t column, row;
    };
    /// The one nearest to it, of a point beside the page.
    [[nodiscard]] Cell cell_of(const glm::dvec2& p) const {
        const auto last = static_cast<double>(side_ - 1);
        return {static_cast<std::size_t>(std::clamp(p.x * scale_.x, 0.0, last)),
                static_cast<std::size_t>(std::clamp(p.y * scale_.y, 0.0, last))};
    }

    std::size_t side_;
    glm::dvec2 scale_;  ///< from units to cells
    std::vector<std::vector<std::uint32_t>> cells_;
};

/// The canonical answer in any point of a page: of the triangles that cover it the one with the
/// least depth, of those the lowest id. Nothing but the definition, and a table of which triangles
/// may cover a point.
class CanonicalAnswer {
public:
    explicit CanonicalAnswer(const ScreenScene& page)
        : page_(page), grid_(page.resolution(), page.subpixel_bits(), page.triangle_count()) {
        for (std::uint32_t k = 0; k < page.triangle_count(); ++k)
            if (page.drawable(k)) add(k);
    }

    /// kNone: nothing.
    [[nodiscard]] std::uint32_t at(std::int32_t x, std::int32_t y) const {
        const Entry* best = nullptr;
        for (const std::uint32_t k : grid_.around({x, y})) {
            const Entry& entry = entries_[k];
            if (entry.plane.c <= 0 || !covers(entry.triangle, x, y)) continue;
            const int sign =
                best == nullptr ? -1 : compare_depth_exactly(entry.plane, best->plane, x, y);
            if (sign < 0 || (sign == 0 && entry.id < best->id)) best = &entry;
        }
        return best == nullptr ? kNone : best->id;
    }

    /// Whether something else is seen somewhere within four units: there is a border near by. A
    /// triangle whose mean width is four, which is no region of its own, has no point farther from
    /// its border.
    [[nodiscard]] bool near_border(std::int32_t x, std::int32_t y) const {
        constexpr std::int32_t kWithin = 4;
        const std::uint32_t own = polygon_at(x, y);
        for (std::int32_t dx = -kWithin; dx <= kWithin; ++dx)
            for (std::int32_t dy = -kWithin; dy <= kWithin; ++dy)
                if (polygon_at(x + dx, y + dy) != own) return true;
        return false;
    }

    [[nodiscard]] std::uint32_t polygon_at(std::int32_t x, std::int32_t y) const {
        const std::uint32_t id = at(x, y);
        return id == kNone ? kNone : page_.scene().triangle_polygon[id];
    }

    /// Whether a triangle of the polygon lies over a point, seen or not.
    [[nodiscard]] bool is_over(std::uint32_t polygon, std::int32_t x, std::int32_t y) const {
        return std::ranges::any_of(grid_.around({x, y}), [&](std::uint32_t k) {
            const Entry& entry = entries_[k];
            return page_.scene().triangle_polygon[entry.id] == polygon &&
                   covers(entry.triangle, x, y);
        });
    }

private:
    struct Entry {
        OrientedTriangle triangle;
        Plane plane;
        std::uint32_t id;
    };

    void add(std::uint32_t k) {
        const Corners c = page_.corners(k);
        const ScreenPoint &p = page_.point(c.x), &q = page_.point(c.y), &r = page_.point(c.z);
        const auto [x0, x1] = std::minmax({p.x, q.x, r.x});
        const auto [y0, y1] = std::minmax({p.y, q.y, r.y});
        grid_.add({x0, y0}, {x1, y1}, static_cast<std::uint32_t>(entries_.size()));
        entries_.push_back({{p, q, r}, page_.plane(page_.id(k)), page_.id(k)});
    }

    const ScreenScene& page_;
    PageCells grid_;
    std::vector<Entry> entries_;
};

/// The regions of a drawing, asked for the one in which a point lies: even-odd, over the edges that
/// a line to the left of it crosses.
class RegionAnswer {
public:
    struct At {
        std::vector<std::uint32_t> polygons;  ///< of all regions that hold the point
        bool on_edge = false;                 ///< or so near one as it was asked for
    };

    /// near: up to which distance from an edge, in units, a point is taken to be on it.
    RegionAnswer(const Drawing& drawing, int subpixel_bits, double near)
        : regions_(drawing.regions),
          near_(near),
          grid_(drawing.resolution, subpixel_bits, drawing.regions.size()) {
        for (glm::dvec2& point : regions_.points) point *= std::ldexp(1.0, subpixel_bits);
        for (std::uint32_t r = 0; r < regions_.size(); ++r) add(r);
    }

    [[nodiscard]] At at(const glm::dvec2& point) const {
        At at;
        for (const std::uint32_t r : grid_.around(point)) {
            bool inside = false;
            for (std::uint32_t l = regions_.first_loop[r]; l < regions_.first_loop[r + 1]; ++l)
                follow(l, point, inside, at.on_edge);
            if (inside) at.polygons.push_back(regions_.polygon[r]);
        }
        return at;
    }

private:
    /// No point of a region, nor one on its edges, is outside the box of its corners, grown.
    void add(std::uint32_t r) {
        glm::dvec2 low(std::numeric_limits<double>::infinity()), high = -low;
        const std::uint32_t end = regions_.first_point[regions_.first_loop[r + 1]];
        for (std::uint32_t k = regions_.first_point[regions_.first_loop[r]]; k < end; ++k) {
            low = glm::min(low, regions_.points[k]);
            high = glm::max(high, regions_.points[k]);
        }
        grid_.add(low - near_, high + near_, r);
    }

    /// Every edge of the loop that the line crosses changes whether the point is inside.
    void follow(std::uint32_t loop, const glm::dvec2& point, bool& inside, bool& on_edge) const {
        const std::uint32_t first = regions_.first_point[loop];
        const std::uint32_t end = regions_.first_point[loop + 1];
        for (std::uint32_t k = first; k < end; ++k) {
            const glm::dvec2& from = regions_.points[k];
            const glm::dvec2& to = regions_.points[k + 1 == end ? first : k + 1];
            on_edge = on_edge || is_near(from, to, point);
            if ((from.y > point.y) == (to.y > point.y)) continue;
            const glm::dvec2 along = to - from, beside = point - from;
            const double cross = along.x * beside.y - along.y * beside.x;
            if ((along.y > 0) == (cross < 0)) inside = !inside;
        }
    }

    [[nodiscard]] bool is_near(const glm::dvec2& from, const glm::dvec2& to,
                               const glm::dvec2& p) const {
        if (std::min(from.x, to.x) > p.x + near_ || std::max(from.x, to.x) < p.x - near_ ||
            std::min(from.y, to.y) > p.y + near_ || std::max(from.y, to.y) < p.y - near_)
            return false;
        const glm::dvec2 a = from - p, along = to - from;
        const double length2 = along.x * along.x + along.y * along.y;
        const double t =
            std::clamp(-(a.x * along.x + a.y * along.y) / std::max(length2, 1e-300), 0.0, 1.0);
        return std::hypot(a.x + t * along.x, a.y + t * along.y) <= near_;
    }

    DrawnRegions regions_;  ///< in units
    double near_;
    PageCells grid_;
};

}  // namespace sightline::testing
