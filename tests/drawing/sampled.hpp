// Drawings in sample points: what the definition says is seen there, and what a drawing says.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "math/predicates.hpp"
#include "sightline/drawing.hpp"

namespace sightline::testing {

/// The canonical answer in any point of a page: of the triangles that cover it the one with the
/// least depth, of those the lowest id. Nothing but the definition, and a table of which triangles
/// may cover a point.
class CanonicalAnswer {
public:
    explicit CanonicalAnswer(const ScreenScene& page) : page_(page) {
        cells_.resize(std::size_t{kSide} * kSide);
        const Resolution size = page.resolution();
        const auto side = static_cast<double>(std::max(size.width, size.height));
        cell_ = static_cast<std::int32_t>(std::ldexp(side, page.subpixel_bits()) / kSide) + 1;
        for (std::uint32_t k = 0; k < page.triangle_count(); ++k)
            if (page.drawable(k)) add(k);
    }

    /// kNone: nothing.
    [[nodiscard]] std::uint32_t at(std::int32_t x, std::int32_t y) const {
        if (x < 0 || y < 0 || x / cell_ >= kSide || y / cell_ >= kSide) return kNone;
        std::uint32_t best = kNone;
        Plane nearest;
        for (const Entry& entry : cells_[static_cast<std::size_t>(y / cell_ * kSide + x / cell_)]) {
            if (!covers(entry.triangle, x, y) || entry.plane.c <= 0) continue;
            const int sign = best == kNone ? -1 : compare_depth_exactly(entry.plane, nearest, x, y);
            if (sign > 0 || (sign == 0 && entry.id > best)) continue;
            best = entry.id;
            nearest = entry.plane;
        }
        return best;
    }

    /// Whether something else is seen somewhere within two units: there is a border near by.
    [[nodiscard]] bool near_border(std::int32_t x, std::int32_t y) const {
        const std::uint32_t own = polygon_at(x, y);
        for (std::int32_t dx = -2; dx <= 2; ++dx)
            for (std::int32_t dy = -2; dy <= 2; ++dy)
                if (polygon_at(x + dx, y + dy) != own) return true;
        return false;
    }

    [[nodiscard]] std::uint32_t polygon_at(std::int32_t x, std::int32_t y) const {
        const std::uint32_t id = at(x, y);
        return id == kNone ? kNone : page_.scene().triangle_polygon[id];
    }

private:
    static constexpr std::int32_t kSide = 64;
    struct Entry {
        OrientedTriangle triangle;
        Plane plane;
        std::uint32_t id;
    };

    void add(std::uint32_t k) {
        const Corners c = page_.corners(k);
        const ScreenPoint &p = page_.point(c.x), &q = page_.point(c.y), &r = page_.point(c.z);
        const Entry entry{{p, q, r}, page_.plane(page_.id(k)), page_.id(k)};
        const auto [x0, x1] = std::minmax({p.x, q.x, r.x});
        const auto [y0, y1] = std::minmax({p.y, q.y, r.y});
        for (std::int32_t row = y0 / cell_; row <= y1 / cell_; ++row)
            for (std::int32_t column = x0 / cell_; column <= x1 / cell_; ++column)
                cells_[static_cast<std::size_t>(row * kSide + column)].push_back(entry);
    }

    const ScreenScene& page_;
    std::int32_t cell_ = 1;
    std::vector<std::vector<Entry>> cells_;
};

/// The regions of a drawing, asked for the one in which a point lies: even-odd, over the edges that
/// a line to the left of it crosses.
class RegionAnswer {
public:
    struct At {
        std::vector<std::uint32_t> polygons;  ///< of all regions that hold the point
        double distance = std::numeric_limits<double>::infinity();  ///< to an edge near it, if any
    };

    RegionAnswer(const Drawing& drawing, int subpixel_bits) : polygons_(drawing.regions.polygon) {
        const DrawnRegions& regions = drawing.regions;
        const double unit = std::ldexp(1.0, subpixel_bits);
        height_ = std::ldexp(drawing.resolution.height, subpixel_bits) / kBands;
        bands_.resize(kBands);
        for (std::uint32_t r = 0; r < regions.size(); ++r)
            for (std::uint32_t l = regions.first_loop[r]; l < regions.first_loop[r + 1]; ++l)
                for (std::uint32_t k = regions.first_point[l]; k < regions.first_point[l + 1];
                     ++k) {
                    const bool last = k + 1 == regions.first_point[l + 1];
                    const std::uint32_t next = last ? regions.first_point[l] : k + 1;
                    add({unit * regions.points[k], unit * regions.points[next], r});
                }
    }

    [[nodiscard]] At at(glm::dvec2 point, double within) const {
        At at;
        std::vector<std::uint32_t> toggled;
        for (const Edge& edge : bands_[band_of(point.y)]) {
            at.distance = std::min(at.distance, distance(edge, point, within));
            if ((edge.from.y > point.y) == (edge.to.y > point.y)) continue;
            const glm::dvec2 along = edge.to - edge.from, beside = point - edge.from;
            const double cross = along.x * beside.y - along.y * beside.x;
            if ((along.y > 0) == (cross < 0)) toggled.push_back(edge.region);
        }
        std::ranges::sort(toggled);
        for (std::size_t i = 0, end = 0; i < toggled.size(); i = end) {
            while (end < toggled.size() && toggled[end] == toggled[i]) ++end;
            if ((end - i) % 2 == 1) at.polygons.push_back(polygons_[toggled[i]]);
        }
        return at;
    }

private:
    static constexpr std::size_t kBands = 512;
    static constexpr double kMargin = 1.0 / 64;  // of a band: distances are looked for that far
    struct Edge {
        glm::dvec2 from, to;
        std::uint32_t region;
    };

    [[nodiscard]] std::size_t band_of(double y) const {
        return static_cast<std::size_t>(std::clamp(y / height_, 0.0, kBands - 1.0));
    }
    void add(const Edge& edge) {
        const auto [low, high] = std::minmax(edge.from.y, edge.to.y);
        const double margin = kMargin * height_;
        for (std::size_t b = band_of(low - margin); b <= band_of(high + margin); ++b)
            bands_[b].push_back(edge);
    }
    /// Infinite when it is certainly more than `within`.
    [[nodiscard]] static double distance(const Edge& edge, const glm::dvec2& p, double within) {
        const glm::dvec2 a = edge.from - p, b = edge.to - p, along = b - a;
        if (std::min(a.x, b.x) > within || std::max(a.x, b.x) < -within ||
            std::min(a.y, b.y) > within || std::max(a.y, b.y) < -within)
            return std::numeric_limits<double>::infinity();
        const double length2 = along.x * along.x + along.y * along.y;
        const double t =
            std::clamp(-(a.x * along.x + a.y * along.y) / std::max(length2, 1e-300), 0.0, 1.0);
        return std::hypot(a.x + t * along.x, a.y + t * along.y);
    }

    std::vector<std::uint32_t> polygons_;
    double height_ = 1;
    std::vector<std::vector<Edge>> bands_;
};

}  // namespace sightline::testing
