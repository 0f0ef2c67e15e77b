// Thinning: D. H. Douglas, T. K. Peucker, "Algorithms for the reduction of the number of points
// required to represent a digitized line or its caricature", The Canadian Cartographer 10 (1973),
// 112-122, with a stack of its own in place of recursion.
#include "drawing/curve_runs.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "sightline/scene.hpp"

namespace sightline {
namespace {

double distance_to(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
    const glm::dvec2 along = b - a;
    const double square = glm::dot(along, along);
    const double t = square > 0 ? std::clamp(glm::dot(p - a, along) / square, 0.0, 1.0) : 0;
    return glm::length(p - (a + t * along));
}

/// Marks the points that stay.
std::vector<bool> thinned(const std::vector<glm::dvec2>& points, double tolerance) {
    std::vector<bool> keep(points.size(), !(tolerance > 0));
    if (!(tolerance > 0)) return keep;
    keep.front() = keep.back() = true;
    std::vector<std::pair<std::size_t, std::size_t>> open = {{0, points.size() - 1}};
    while (!open.empty()) {
        const auto [first, last] = open.back();
        open.pop_back();
        double farthest = tolerance;
        std::size_t at = first;
        for (std::size_t k = first + 1; k < last; ++k) {
            const double d = distance_to(points[k], points[first], points[last]);
            if (d > farthest) {
                farthest = d;
                at = k;
            }
        }
        if (at == first) continue;
        keep[at] = true;
        open.emplace_back(first, at);
        open.emplace_back(at, last);
    }
    return keep;
}

void put(DrawnLines& out, glm::dvec2 from, glm::dvec2 to, const CurveStyle& style) {
    if (from == to) return;
    out.from.push_back(from);
    out.to.push_back(to);
    out.kind.push_back(style.kind);
    out.visible.push_back(style.visible ? 1 : 0);
    out.polygons.emplace_back(style.number, kNone);
    out.object.push_back(style.object);
}

}  // namespace

void CurveRun::add(glm::dvec2 from, glm::dvec2 to, const CurveStyle& style, double tolerance,
                   DrawnLines& out) {
    if (points_.empty() || !(style == style_) || points_.back() != from) {
        flush(tolerance, out);
        style_ = style;
        points_.push_back(from);
    }
    points_.push_back(to);
}

void CurveRun::flush(double tolerance, DrawnLines& out) {
    if (points_.size() > 1) {
        const std::vector<bool> keep = thinned(points_, tolerance);
        std::size_t last = 0;
        for (std::size_t k = 1; k < points_.size(); ++k) {
            if (!keep[k]) continue;
            put(out, points_[last], points_[k], style_);
            last = k;
        }
    }
    points_.clear();
}

void count_lengths(const DrawnLines& lines, DrawingCounts& counts) {
    for (std::size_t k = 0; k < lines.size(); ++k) {
        const double length = glm::length(lines.to[k] - lines.from[k]);
        ++(lines.visible[k] != 0 ? counts.visible_segments : counts.hidden_segments);
        (lines.visible[k] != 0 ? counts.visible_length : counts.hidden_length) += length;
    }
}

void append(DrawnLines& lines, const DrawnLines& more) {
    const auto add = [](auto& to, const auto& from) {
        to.insert(to.end(), from.begin(), from.end());
    };
    add(lines.from, more.from);
    add(lines.to, more.to);
    add(lines.kind, more.kind);
    add(lines.visible, more.visible);
    add(lines.polygons, more.polygons);
    add(lines.object, more.object);
}

}  // namespace sightline
