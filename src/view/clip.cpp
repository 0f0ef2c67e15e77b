// Source: I. Sutherland, G. Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974, in homogeneous
// coordinates as in J. Blinn, M. Newell, "Clipping Using Homogeneous Coordinates", SIGGRAPH 1978.
//
// How this version differs: a clip point is computed on the triangle's *original* edge, with the
// ends in a canonical order, however many planes have cut the edge before. Neighbours that share
// the edge then get the same point to the bit, so there are no cracks.
#include "view/clip.hpp"

#include <tuple>
#include <utility>

namespace sightline {

namespace {

constexpr int kPlanes = 6;
constexpr int kCut = -1;  // an edge that a clip plane has made

struct Corner {
    HomogeneousPoint point;
    int edge = kCut;  // the original edge (0..2) along which the polygon leaves this corner
};

using Polygon = std::vector<Corner>;

// Positive inside, linear in the point.
double distance(const ScreenTransform& t, const HomogeneousPoint& h, int plane) {
    const ViewVolume& v = t.volume;
    const double w = t.w_of(h);
    switch (plane) {
        case 0:
            return h.d - v.near_plane;
        case 1:
            return v.far_plane - h.d;
        case 2:
            return h.x + (t.cx - v.x_min) * w;
        case 3:
            return (v.x_max - t.cx) * w - h.x;
        case 4:
            return h.y + (t.cy - v.y_min) * w;
        default:
            return (v.y_max - t.cy) * w - h.y;
    }
}

HomogeneousPoint crossing(const ScreenTransform& t, HomogeneousPoint a, HomogeneousPoint b,
                          int plane) {
    if (std::tie(b.x, b.y, b.d) < std::tie(a.x, a.y, a.d)) std::swap(a, b);
    const double da = distance(t, a, plane), db = distance(t, b, plane);
    const double s = da / (da - db);
    return {a.x + s * (b.x - a.x), a.y + s * (b.y - a.y), a.d + s * (b.d - a.d)};
}

void clip_by(const ScreenTransform& t, const std::array<HomogeneousPoint, 3>& original, int plane,
             const Polygon& in, Polygon& out) {
    out.clear();
    for (std::size_t i = 0; i < in.size(); ++i) {
        const Corner& here = in[i];
        const Corner& next = in[i + 1 == in.size() ? 0 : i + 1];
        const bool here_inside = distance(t, here.point, plane) >= 0;
        const bool next_inside = distance(t, next.point, plane) >= 0;
        if (here_inside) out.push_back(here);
        if (here_inside == next_inside) continue;
        const auto e = static_cast<std::size_t>(here.edge);
        const HomogeneousPoint cut = here.edge == kCut
                                         ? crossing(t, here.point, next.point, plane)
                                         : crossing(t, original[e], original[(e + 1) % 3], plane);
        // Going out, the polygon continues along the plane; coming in, along the edge.
        out.push_back({cut, here_inside ? kCut : here.edge});
    }
}

}  // namespace

void clip_triangle(const ScreenTransform& transform, const std::array<glm::dvec3, 3>& corners,
                   std::vector<ScreenPoint>& polygon) {
    std::array<HomogeneousPoint, 3> original;
    Polygon current, next;
    for (int k = 0; k < 3; ++k) {
        original[static_cast<std::size_t>(k)] =
            transform.apply(corners[static_cast<std::size_t>(k)]);
        current.push_back({original[static_cast<std::size_t>(k)], k});
    }
    // Near comes first: behind the eye x and y have no meaning.
    for (int plane = 0; plane < kPlanes && !current.empty(); ++plane) {
        clip_by(transform, original, plane, current, next);
        std::swap(current, next);
    }
    for (const Corner& corner : current) polygon.push_back(transform.snap(corner.point));
}

std::optional<std::pair<ScreenPoint, ScreenPoint>> clip_line(const ScreenTransform& transform,
                                                             const glm::dvec3& from,
                                                             const glm::dvec3& to) {
    const HomogeneousPoint a = transform.apply(from), b = transform.apply(to);
    HomogeneousPoint start = a, end = b;
    for (int plane = 0; plane < kPlanes; ++plane) {
        const bool start_inside = distance(transform, start, plane) >= 0;
        const bool end_inside = distance(transform, end, plane) >= 0;
        if (!start_inside && !end_inside) return std::nullopt;
        if (!start_inside) start = crossing(transform, a, b, plane);
        if (!end_inside) end = crossing(transform, a, b, plane);
    }
    return std::pair(transform.snap(start), transform.snap(end));
}

}  // namespace sightline
