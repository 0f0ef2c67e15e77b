// Dynamic programming over the diagonals. Sources: P. D. Gilbert, "New results in planar
// triangulations", 1979; G. T. Klincsek, "Minimal triangulations of polygonal domains", Annals of
// Discrete Mathematics 9, 1980.
//
// How this differs: the weight is not the length of the diagonals but the area of the triangles.
// Its sum is least when none of them is turned over, and that sum is the area of the polygon
// wherever its outline, however often it touches or retraces itself, can be triangulated at all.
// Corners that are off by rounding cost no more area than they are off.
#include "scene/load/least_area.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace sightline::load {

bool LeastArea::cut(std::span<const glm::dvec2> points, std::vector<PolygonTriangle>& triangles) {
    const std::size_t n = points.size();
    const std::uint64_t steps = std::uint64_t{n} * n * n / 6;
    if (n > kMostCorners || steps > kWorkLimit - work_) return false;
    work_ += steps;
    parts_.assign(n * n, {});
    for (std::size_t length = 2; length < n; ++length) {
        for (std::size_t from = 0; from + length < n; ++from) {
            const std::size_t to = from + length;
            Part best{std::numeric_limits<double>::infinity(), 0};
            for (std::size_t apex = from + 1; apex < to; ++apex) {
                const double area = std::abs(turn(points[from], points[apex], points[to])) +
                                    parts_[from * n + apex].area + parts_[apex * n + to].area;
                if (area < best.area) best = {area, static_cast<std::uint32_t>(apex)};
            }
            parts_[from * n + to] = best;
        }
    }
    triangles.clear();
    std::vector<std::pair<std::uint32_t, std::uint32_t>> open{
        {0, static_cast<std::uint32_t>(n - 1)}};
    while (!open.empty()) {
        const auto [from, to] = open.back();
        open.pop_back();
        if (to - from < 2) continue;
        const std::uint32_t apex = parts_[std::size_t{from} * n + to].apex;
        triangles.push_back({from, apex, to});
        open.emplace_back(apex, to);
        open.emplace_back(from, apex);
    }
    return true;
}

}  // namespace sightline::load
