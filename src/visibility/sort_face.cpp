#include "visibility/sort_face.hpp"

#include <algorithm>
#include <cmath>

#include "math/predicates.hpp"
#include "sightline/visibility.hpp"

namespace sightline {

namespace {

constexpr double kUnit = 0x1p-53;

/// Depth of a face's plane and a bound of its error; see approximate_depth() of the predicates for
/// the derivation.
struct Depth {
    double z, error;
};

Depth depth_at(const SortFace& face, const ScreenPoint& at) {
    const double tx = face.gx * (static_cast<double>(at.x) - face.plane.at.x);
    const double ty = face.gy * (static_cast<double>(at.y) - face.plane.at.y);
    return {face.plane.at.z + (tx + ty),
            8 * kUnit * (std::abs(tx) + std::abs(ty) + face.plane.at.z)};
}

/// Sign of (depth of `face` - depth of `other`) at a corner of `face`.
int sign_at_corner(const SortFace& face, const SortFace& other, const ScreenPoint& corner,
                   std::uint64_t& exact) {
    if (face.own_plane && other.own_plane) {
        // Neighbours share corners, so this is the rule rather than the exception.
        for (const ScreenPoint& point : other.corners)
            if (point == corner) return 0;
    }
    const Depth own =
        face.own_plane ? Depth{static_cast<double>(corner.z), 0} : depth_at(face, corner);
    const Depth of_other = depth_at(other, corner);
    const double difference = own.z - of_other.z;
    // The subtraction rounds once more; doubling the bound covers it.
    if (std::abs(difference) > 2 * (own.error + of_other.error)) return difference < 0 ? -1 : 1;
    ++exact;
    return compare_depth_exactly(face.plane, other.plane, corner.x, corner.y);
}

/// Whether all of b lies left of, or on, a side of a.
bool has_separating_side(const SortFace& a, const SortFace& b) {
    for (std::size_t k = 0; k < 3; ++k) {
        const ScreenPoint &p = a.corners[k], &q = a.corners[(k + 1) % 3];
        const bool apart = std::ranges::all_of(b.corners, [&](const ScreenPoint& s) {
            return side(p.x, p.y, q.x, q.y, s.x, s.y) <= 0;
        });
        if (apart) return true;
    }
    return false;
}

}  // namespace

SortFace::SortFace(const ScreenScene& screen, std::uint32_t number_)
    : number(number_), id(screen.id(number_)), shared(screen.shared_plane(id)) {
    const Corners c = screen.corners(number);
    const OrientedTriangle triangle(screen.point(c.x), screen.point(c.y), screen.point(c.z));
    corners = {triangle.p, triangle.q, triangle.r};
    plane = screen.plane(id);
    gx = static_cast<double>(plane.a) / static_cast<double>(plane.c);
    gy = static_cast<double>(plane.b) / static_cast<double>(plane.c);
    own_plane = std::ranges::all_of(corners, [&](const ScreenPoint& p) {
        return depth_numerator(plane, p.x, p.y) == Int128{plane.c} * p.z;
    });
    const auto [x0, x1] = std::minmax({corners[0].x, corners[1].x, corners[2].x});
    const auto [y0, y1] = std::minmax({corners[0].y, corners[1].y, corners[2].y});
    std::array<double, 3> z{};
    for (std::size_t k = 0; k < 3; ++k) {
        z[k] = own_plane ? corners[k].z : evaluate_depth(plane, corners[k].x, corners[k].y);
    }
    const auto [z0, z1] = std::minmax({z[0], z[1], z[2]});
    // evaluate_depth() is good to far less than a unit.
    const int slack = own_plane ? 0 : 1;
    near = static_cast<std::int32_t>(std::floor(z0)) - slack;
    box = {{x0, x1, y0, y1}, static_cast<std::int32_t>(std::ceil(z1)) + slack};
}

PieceRegion region_of(const SortFace& face) {
    const auto& [p, q, r] = face.corners;
    return PieceRegion(
        {{line_through(p, q), {}}, {line_through(q, r), {}}, {line_through(r, p), {}}});
}

PlaneSides sides_of(const SortFace& face, const SortFace& plane_of, std::uint64_t& exact) {
    PlaneSides sides;
    for (const ScreenPoint& corner : face.corners) {
        const int sign = sign_at_corner(face, plane_of, corner, exact);
        sides.behind = sides.behind || sign > 0;
        sides.in_front = sides.in_front || sign < 0;
    }
    return sides;
}

bool are_disjoint(const SortFace& a, const SortFace& b) {
    return has_separating_side(a, b) || has_separating_side(b, a);
}

}  // namespace sightline
