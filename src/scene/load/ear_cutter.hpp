// Triangulation of a polygon in the plane by cutting off ears.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

namespace sightline::load {

/// A triangle as three corner numbers of its polygon, counter-clockwise where the polygon is.
using PolygonTriangle = std::array<std::uint32_t, 3>;

/// Twice the signed area of a triangle: positive when a, b, c turn left.
[[nodiscard]] inline double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The corners of a polygon in the cells of a grid, to look up those in a box.
class CornerGrid {
public:
    void build(std::span<const glm::dvec2> points);
    /// Cells that a box touches: [x0, x1] x [y0, y1].
    struct Cells {
        std::uint32_t x0, x1, y0, y1;
        [[nodiscard]] std::uint64_t count() const {
            return std::uint64_t{x1 - x0 + 1} * (y1 - y0 + 1);
        }
    };
    [[nodiscard]] Cells cells_of(const glm::dvec2& lo, const glm::dvec2& hi) const;
    [[nodiscard]] std::span<const std::uint32_t> corners_in(std::uint32_t x, std::uint32_t y) const;

private:
    [[nodiscard]] std::uint32_t column(double x) const;
    [[nodiscard]] std::uint32_t row(double y) const;

    glm::dvec2 origin_{0, 0}, cell_{1, 1};
    std::uint32_t columns_ = 1, rows_ = 1;
    std::vector<std::uint32_t> first_;
    std::vector<std::uint32_t> corners_;
};

/// Cuts the ears of one polygon after another, with the same scratch memory.
class EarCutter {
public:
    /// Appends the n - 2 triangles of a counter-clockwise polygon of n > 3 corners; false when that
    /// takes more than `most` steps. Sides that differ by less than `same_angle` count as one on
    /// the other.
    bool cut(std::span<const glm::dvec2> points, double same_angle, std::uint64_t most,
             std::vector<PolygonTriangle>& triangles);
    /// Steps so far, of all polygons.
    [[nodiscard]] std::uint64_t work() const { return work_; }

private:
    /// What makes a corner an ear, from a proper one to the least that is asked.
    enum class Strictness {
        proper,    ///< positive area, and no corner inside, on the diagonal, or leading inside
        touching,  ///< positive area, and no corner strictly inside
        convex,    ///< positive area
    };
    struct Corner {
        std::uint32_t prev, next;
        std::uint32_t stamp = 0;  ///< counts its entries in the queues; only the last one is valid
        bool reflex = false;      ///< turns right or back: only such corners can block an ear
        bool listed = false;      ///< stands in reflex_
        bool alive = true;
    };
    struct Candidate {
        std::uint32_t corner, stamp;
    };

    void start(std::span<const glm::dvec2> points);
    void touch(std::uint32_t corner);
    void cut_off(std::uint32_t corner, std::vector<PolygonTriangle>& triangles);
    std::optional<std::uint32_t> next_of(std::deque<Candidate>& queue);
    [[nodiscard]] bool same_way(const glm::dvec2& from, const glm::dvec2& p,
                                const glm::dvec2& q) const;
    [[nodiscard]] std::uint32_t relaxed_ear();
    [[nodiscard]] bool is_ear(std::uint32_t corner, Strictness strictness);
    [[nodiscard]] bool blocked(std::uint32_t corner, Strictness strictness);
    [[nodiscard]] bool blocked_by_list(std::uint32_t corner, Strictness strictness);
    [[nodiscard]] bool blocks(std::uint32_t other, std::uint32_t corner,
                              Strictness strictness) const;

    std::span<const glm::dvec2> points_;
    std::vector<Corner> corners_;
    std::deque<Candidate> queue_;        ///< what may be a proper ear
    std::deque<Candidate> flats_;        ///< corners on a straight line: only when that has none
    std::deque<Candidate> backs_;        ///< where the outline turns back: to be cut off at once
    std::vector<std::uint32_t> reflex_;  ///< all reflex corners, and some that no longer are
    CornerGrid grid_;
    bool has_grid_ = false;
    double same_angle_ = 0;
    std::uint32_t left_ = 0;   ///< corners not cut off yet
    std::uint32_t start_ = 0;  ///< one of them
    std::uint64_t work_ = 0;   ///< steps so far, of all polygons
    std::uint64_t limit_ = 0;  ///< of work_
};

}  // namespace sightline::load
