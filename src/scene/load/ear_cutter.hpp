// Triangulation of a polygon in the plane by cutting off ears.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "scene/load/corner_tree.hpp"

namespace sightline::load {

/// A triangle as three corner numbers of its polygon, counter-clockwise where the polygon is.
using PolygonTriangle = std::array<std::uint32_t, 3>;

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
    [[nodiscard]] std::optional<std::uint32_t> next_ear(Strictness strictness);
    [[nodiscard]] bool is_ear(std::uint32_t corner, Strictness strictness);
    [[nodiscard]] bool blocks(std::uint32_t other, std::uint32_t corner,
                              Strictness strictness) const;

    std::span<const glm::dvec2> points_;
    std::vector<Corner> corners_;
    std::array<std::deque<Candidate>, 3> queues_;  ///< what may be an ear, by Strictness:
                                                   ///< first in the first, and later in the next
    std::deque<Candidate> flats_;  ///< corners on a straight line: only when there is no proper ear
    std::deque<Candidate> backs_;  ///< where the outline turns back: to be cut off at once
    CornerTree reflex_;            ///< marks what turns right or back: only that can block an ear
    double same_angle_ = 0;
    std::uint32_t left_ = 0;   ///< corners not cut off yet
    std::uint32_t start_ = 0;  ///< one of them
    std::uint64_t work_ = 0;   ///< steps so far, of all polygons
    std::uint64_t limit_ = 0;  ///< of work_
};

}  // namespace sightline::load
