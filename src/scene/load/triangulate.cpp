// Decides between a fan, ears and, where ears leave triangles turned over, the least area, in the
// plane of the polygon's Newell normal.
#include "scene/load/triangulate.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>

#include "math/newell.hpp"

namespace sightline::load {
namespace {

/// Projects along the axis that the normal is closest to, so that counter-clockwise stays so.
void flatten(std::span<const glm::dvec3> corners, const glm::dvec3& normal,
             std::vector<glm::dvec2>& flat) {
    const glm::dvec3 size{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
    const int drop = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
    const int right = (drop + (normal[drop] > 0 ? 1 : 2)) % 3;
    const int up = 3 - drop - right;
    flat.clear();
    for (const glm::dvec3& corner : corners) flat.emplace_back(corner[right], corner[up]);
}

/// Turns left (or not at all) everywhere, and once around: the sides' directions change from
/// leftward to rightward and back only once.
bool is_convex(std::span<const glm::dvec2> p) {
    const auto rightward = [](const glm::dvec2& d) { return d.x != 0 ? d.x > 0 : d.y > 0; };
    const std::size_t n = p.size();
    glm::dvec2 last{0, 0};
    for (std::size_t i = n; i-- > 0 && last == glm::dvec2{0, 0};) last = p[(i + 1) % n] - p[i];
    int changes = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const glm::dvec2 side = p[(i + 1) % n] - p[i];
        if (side == glm::dvec2{0, 0}) continue;
        if (last.x * side.y - last.y * side.x < 0) return false;
        changes += rightward(last) != rightward(side) ? 1 : 0;
        last = side;
    }
    return changes <= 2;
}

bool fan_has_area(std::span<const glm::dvec2> p) {
    for (std::size_t i = 1; i + 1 < p.size(); ++i) {
        if (!(turn(p[0], p[i], p[i + 1]) > 0)) return false;
    }
    return true;
}

void make_fan(std::uint32_t n, std::vector<PolygonTriangle>& triangles) {
    for (std::uint32_t i = 1; i + 1 < n; ++i) triangles.push_back({0, i, i + 1});
}

/// Angles below which an outline that turns back runs along itself. The first allows for a polygon
/// that was turned in space: that moves corners by 2^-53 of their coordinates, so it holds for
/// sides down to 2^-12 of those. The second allows for coordinates of six digits.
constexpr double kSameAngle = 0x1p-40, kLooseAngle = 0x1p-14;

/// Which part of their area triangles that are turned over have; 0 where rounding explains it. What
/// a polygon covers once is covered once by its triangles if and only if none is turned over: at
/// any point, the triangles that run counter-clockwise less those that run clockwise are as many as
/// the polygon winds around it.
double turned_over(std::span<const glm::dvec2> p, const std::vector<PolygonTriangle>& triangles) {
    constexpr double kRounding = 0x1p-30;
    double over = 0, all = 0;
    for (const PolygonTriangle& t : triangles) {
        const double area = turn(p[t[0]], p[t[1]], p[t[2]]);
        all += std::abs(area);
        if (area < 0) over -= area;
    }
    return over > kRounding * all ? over / all : 0;
}

}  // namespace

/// Looks for triangles of which a smaller part than `over` is turned over.
void Triangulator::mend(double over, std::vector<PolygonTriangle>& triangles) {
    if (least_area_.cut(flat_, triangles)) return;
    // Where sides cross everywhere this takes far more steps, and mends nothing.
    constexpr std::uint64_t kStepsPerCorner = 256;
    loose_.clear();
    const bool done = loose_ears_.cut(flat_, kLooseAngle, kStepsPerCorner * flat_.size(), loose_);
    if (done && turned_over(flat_, loose_) < over) triangles.swap(loose_);
}

Triangulator::Shape Triangulator::triangulate(std::span<const glm::dvec3> corners,
                                              std::vector<PolygonTriangle>& triangles) {
    assert(corners.size() >= 3 && corners.size() < 0xFFFFFFFFu);
    const auto n = static_cast<std::uint32_t>(corners.size());
    triangles.clear();
    if (n == 3) {
        triangles.push_back({0, 1, 2});
        return Shape::convex;
    }
    // Relative to a corner, so that a polygon far from the origin keeps its shape in the products.
    relative_.clear();
    for (const glm::dvec3& corner : corners) relative_.push_back(corner - corners[0]);
    const glm::dvec3 normal = math::newell_normal(relative_);
    flatten(relative_, normal, flat_);
    const bool convex = is_convex(flat_);
    if (normal == glm::dvec3{0, 0, 0} || (convex && fan_has_area(flat_))) {
        make_fan(n, triangles);
        return Shape::convex;
    }
    if (ears_.work() > kWorkLimit ||
        !ears_.cut(flat_, kSameAngle, kWorkLimit - ears_.work(), triangles)) {
        triangles.clear();
        return Shape::too_complex;
    }
    if (const double over = turned_over(flat_, triangles); over > 0) mend(over, triangles);
    return convex ? Shape::convex : Shape::concave;
}

}  // namespace sightline::load
