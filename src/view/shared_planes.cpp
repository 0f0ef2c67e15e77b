// Snapping moves each point by up to half a unit in x, y and z, so a plane through three snapped
// points is off by up to (1 + |gx| + |gy|)/2 depth units at them, and further out by that times the
// barycentric coordinates of the place. Among points p, q, r chosen as below (q farthest from p, r
// farthest from the line p q) every other point has coordinates of at most about 3.
#include "view/shared_planes.hpp"

#include <cstdlib>
#include <tuple>

#include "math/predicates.hpp"

namespace sightline {

namespace {

auto lexicographic(const ScreenPoint& p) { return std::tie(p.x, p.y, p.z); }

// The point with the greatest measure; among equals the lexicographically smallest.
template <class Measure>
ScreenPoint farthest(std::span<const ScreenPoint> points, const Measure& measure) {
    ScreenPoint best = points.front();
    auto best_measure = measure(best);
    for (const ScreenPoint& p : points) {
        const auto m = measure(p);
        if (m > best_measure || (m == best_measure && lexicographic(p) < lexicographic(best))) {
            best = p;
            best_measure = m;
        }
    }
    return best;
}

std::int64_t squared_distance(const ScreenPoint& p, const ScreenPoint& q) {
    const std::int64_t dx = std::int64_t{p.x} - q.x, dy = std::int64_t{p.y} - q.y;
    return dx * dx + dy * dy;
}

}  // namespace

Plane plane_of_spread_points(std::span<const ScreenPoint> points) {
    if (points.size() < 3) return {};
    const ScreenPoint start = farthest(points, [](const ScreenPoint&) { return 0; });
    const ScreenPoint p =
        farthest(points, [&](const ScreenPoint& s) { return squared_distance(start, s); });
    const ScreenPoint q =
        farthest(points, [&](const ScreenPoint& s) { return squared_distance(p, s); });
    const ScreenPoint r = farthest(
        points, [&](const ScreenPoint& s) { return std::abs(side(p.x, p.y, q.x, q.y, s.x, s.y)); });
    return plane_through(p, q, r);
}

}  // namespace sightline
