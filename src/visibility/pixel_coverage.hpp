// How much of each pixel a triangle covers: as a mask of 8 x 8 samples and as an area.
//
// Source: the masks are those of L. Carpenter, "The A-buffer", 1984; areas by signed integrals
// along the edges, as in font rasterizers (D. Turner, FreeType's smooth rasterizer, 2000).
//
// How this version differs: both are consistent between neighbours to the last bit. An edge is
// always taken from its upper end to the lower one, so two triangles that share it get the same
// half of the samples and the complement, and the same integral with the opposite sign.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "math/predicates.hpp"
#include "sightline/fragments.hpp"

namespace sightline {

/// One pixel: its upper left corner and its size in units of the screen (a power of two, at least
/// 2 * kMaskSide).
struct PixelSquare {
    std::int64_t x, y, size;
};

/// An edge of a triangle.
class CoverageEdge {
public:
    CoverageEdge() = default;

    /// Runs from p to q with the inside where side() > 0.
    CoverageEdge(const ScreenPoint& p, const ScreenPoint& q) {
        runs_down_ = p.y != q.y ? p.y < q.y : p.x < q.x;
        const ScreenPoint &upper = runs_down_ ? p : q, &lower = runs_down_ ? q : p;
        x_ = upper.x, y_ = upper.y;
        dx_ = std::int64_t{lower.x} - x_, dy_ = std::int64_t{lower.y} - y_;
    }

    /// Where a pixel lies: side() at the corner that is farthest outside, and farthest inside.
    struct Reach {
        std::int64_t least, most;
    };
    [[nodiscard]] Reach reach(const PixelSquare& pixel) const {
        const std::int64_t sign = runs_down_ ? 1 : -1;
        const std::int64_t at = sign * (dx_ * (pixel.y - y_) - dy_ * (pixel.x - x_));
        const std::int64_t across = -sign * dy_ * pixel.size, down = sign * dx_ * pixel.size;
        const std::int64_t zero = 0;
        return {at + std::min(zero, across) + std::min(zero, down),
                at + std::max(zero, across) + std::max(zero, down)};
    }

    /// The samples of the pixel on the inner side, with the top-left rule.
    [[nodiscard]] std::uint64_t inner_mask(const PixelSquare& pixel) const {
        const std::uint64_t mask = dy_ == 0 ? mask_below(pixel) : mask_right(pixel);
        // Going down, the inside lies to the left; a level edge to the right has it below.
        return (dy_ == 0) == runs_down_ ? mask : ~mask;
    }

    /// What the edge adds to the area in the pixel; `inside`: the pixel lies on its inner side.
    [[nodiscard]] std::int64_t area(const PixelSquare& pixel, bool inside) const {
        const std::int64_t y0 = std::max(y_, pixel.y),
                           y1 = std::min(y_ + dy_, pixel.y + pixel.size);
        if (y0 >= y1) return 0;
        if (inside) return runs_down_ ? 0 : scaled((y1 - y0) * pixel.size, pixel);
        const std::int64_t right = area_right(pixel, y0, y1);
        return runs_down_ ? -right : right;
    }

    /// Extent in x, in units of the screen, of the part between two heights; nothing when empty.
    void widen(double y0, double y1, double& low, double& high) const {
        const double top = std::max(y0, static_cast<double>(y_)),
                     end = std::min(y1, static_cast<double>(y_ + dy_));
        if (top > end) return;
        const double slope = dy_ == 0 ? 0 : static_cast<double>(dx_) / static_cast<double>(dy_);
        for (const double y : {top, end}) {
            const double x = static_cast<double>(x_) + slope * (y - static_cast<double>(y_));
            low = std::min(low, x);
            high = std::max(high, x);
        }
        if (dy_ == 0) high = std::max(high, static_cast<double>(x_ + dx_));
    }

private:
    [[nodiscard]] static std::int64_t scaled(std::int64_t area, const PixelSquare& pixel) {
        return area * (std::int64_t{kFullArea} / (pixel.size * pixel.size));
    }

    /// dy times the distance from the pixel's left side to the edge at a height: exact.
    [[nodiscard]] std::int64_t distance(const PixelSquare& pixel, std::int64_t y) const {
        return (x_ - pixel.x) * dy_ + dx_ * (y - y_);
    }

    /// The area of the pixel to the right of the edge, between two heights: rounded once.
    [[nodiscard]] std::int64_t area_right(const PixelSquare& pixel, std::int64_t y0,
                                          std::int64_t y1) const {
        const std::int64_t d0 = distance(pixel, y0), d1 = distance(pixel, y1);
        const std::int64_t least = std::min(d0, d1), most = std::max(d0, d1);
        if (least >= pixel.size * dy_) return 0;
        if (most <= 0) return scaled((y1 - y0) * pixel.size, pixel);
        const double size = static_cast<double>(pixel.size), height = static_cast<double>(y1 - y0);
        const double from = static_cast<double>(least) / static_cast<double>(dy_),
                     to = static_cast<double>(most) / static_cast<double>(dy_);
        const double a = std::max(from, 0.0), b = std::min(to, size);
        const double part = to > from ? height / (to - from) : 0;
        const double whole = to > from ? (a - from) * part * size : 0;  // where it is left of it
        const double crossed = to > from ? (b - a) * part : height;
        const double sum = whole + crossed * (size - 0.5 * (a + b));
        // Not negative, so the conversion rounds to the nearest.
        return static_cast<std::int64_t>(sum * static_cast<double>(scaled(1, pixel)) + 0.5);
    }

    /// Samples at or below a level edge.
    [[nodiscard]] std::uint64_t mask_below(const PixelSquare& pixel) const {
        const std::int64_t step = pixel.size / kMaskSide;
        const std::int64_t rows =
            std::clamp<std::int64_t>((y_ - pixel.y - step / 2 + step - 1) / step, 0, kMaskSide);
        if (y_ - pixel.y <= step / 2) return ~std::uint64_t{0};
        return rows >= kMaskSide ? 0 : ~std::uint64_t{0} << (kMaskSide * rows);
    }

    /// Samples on the edge's line or to the right of it. The quotients are exact where they are
    /// whole, so a sample on the line is never missed: |distance| < 2^52, dy < 2^25.
    [[nodiscard]] std::uint64_t mask_right(const PixelSquare& pixel) const {
        const std::int64_t step = pixel.size / kMaskSide;
        const double divisor = static_cast<double>(dy_ * step);
        std::int64_t d = distance(pixel, pixel.y + step / 2) - dy_ * (step / 2);
        std::uint64_t mask = 0;
        for (std::uint32_t row = 0; row < kMaskSide; ++row, d += dx_ * step) {
            const double place =
                std::clamp(static_cast<double>(d) / divisor, -1.0, static_cast<double>(kMaskSide));
            // The next whole number; std::ceil is a call on processors of the first 64 bits.
            const int whole = static_cast<int>(place);
            const int first = std::max(0, whole + static_cast<int>(place > whole));
            mask |= std::uint64_t{(0xFFu << first) & 0xFFu} << (kMaskSide * row);
        }
        return mask;
    }

    std::int64_t x_ = 0, y_ = 0, dx_ = 0, dy_ = 0;  // from the upper end; dy >= 0
    bool runs_down_ = false;                        // the triangle has it in this direction
};

/// What a triangle covers of one pixel.
struct PixelCoverage {
    std::uint64_t mask = 0;
    std::uint32_t area = 0;
};

/// A triangle of the screen as pixels meet it.
class CoveredTriangle {
public:
    CoveredTriangle(const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c) {
        const OrientedTriangle t(a, b, c);
        edges_ = {CoverageEdge(t.p, t.q), CoverageEdge(t.q, t.r), CoverageEdge(t.r, t.p)};
        has_area_ = t.area2 > 0;
    }

    [[nodiscard]] bool has_area() const { return has_area_; }

    /// Area 0: it does not reach into the pixel.
    [[nodiscard]] PixelCoverage of(const PixelSquare& pixel) const {
        std::array<bool, 3> inside{};
        for (std::size_t k = 0; k < 3; ++k) {
            const CoverageEdge::Reach reach = edges_[k].reach(pixel);
            if (reach.most <= 0) return {};
            inside[k] = reach.least >= 0;
        }
        if (inside[0] && inside[1] && inside[2]) return {~std::uint64_t{0}, kFullArea};
        std::int64_t area = 0;
        std::uint64_t mask = ~std::uint64_t{0};
        for (std::size_t k = 0; k < 3; ++k) {
            area += edges_[k].area(pixel, inside[k]);
            if (!inside[k]) mask &= edges_[k].inner_mask(pixel);
        }
        if (area <= 0) return {};
        return {mask, static_cast<std::uint32_t>(std::min<std::int64_t>(area, kFullArea))};
    }

    /// The pixels of a row of pixels that it can reach, as columns from .. last; those left of the
    /// picture may be missing.
    struct Columns {
        std::int64_t from, last;
    };
    [[nodiscard]] Columns columns(std::int64_t y, std::int64_t size) const {
        double low = 1e18, high = -1e18;
        for (const CoverageEdge& edge : edges_)
            edge.widen(static_cast<double>(y), static_cast<double>(y + size), low, high);
        if (low > high) return {0, -1};
        const double unit = static_cast<double>(size);
        // Rounding may have moved them by much less than a step of the screen, and the conversion
        // takes the next column to the right where they are negative: no pixel there.
        return {static_cast<std::int64_t>((low - 0.5) / unit),
                static_cast<std::int64_t>((high + 0.5) / unit)};
    }

private:
    std::array<CoverageEdge, 3> edges_;
    bool has_area_ = false;
};

/// The bit of the sample nearest to the part of a triangle in a pixel that covers none: that of the
/// middle of what the triangle's box has in common with the pixel.
[[nodiscard]] inline std::uint64_t nearest_bit(const ScreenPoint& a, const ScreenPoint& b,
                                               const ScreenPoint& c, const PixelSquare& pixel) {
    const auto place = [&pixel](std::int64_t low, std::int64_t high, std::int64_t origin) {
        const std::int64_t from = std::max(low - origin, std::int64_t{0}),
                           to = std::min(high - origin, pixel.size);
        const std::int64_t i = (from + to) * kMaskSide / (2 * pixel.size);
        return static_cast<std::uint64_t>(std::clamp<std::int64_t>(i, 0, kMaskSide - 1));
    };
    const std::uint64_t i = place(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}), pixel.x),
                        j = place(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}), pixel.y);
    return std::uint64_t{1} << (kMaskSide * j + i);
}

}  // namespace sightline
