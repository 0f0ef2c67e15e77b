// Source: I. Sutherland, G. Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974, with a plane
// that is as thick as the tolerance (C. Ericson, Real-Time Collision Detection, 2005, section 8.3).
#include "visibility/bsp_face.hpp"

#include <algorithm>

namespace sightline::bsp {

Placement place(std::span<const glm::dvec3> polygon, const TreePlane& plane) {
    double lowest = plane.at(polygon[0]), highest = lowest;
    for (std::size_t k = 1; k < polygon.size(); ++k) {
        const double value = plane.at(polygon[k]);
        lowest = std::min(lowest, value);
        highest = std::max(highest, value);
    }
    const bool behind = lowest<-kTolerance, before = highest> kTolerance;
    if (behind && before) return {Side::both, false};
    if (behind) return {Side::back, false};
    if (before) return {Side::front, false};
    return {lowest + highest < 0 ? Side::back : Side::front, true};
}

void split(std::span<const glm::dvec3> polygon, const TreePlane& plane,
           std::vector<glm::dvec3>& front, std::vector<glm::dvec3>& back) {
    front.reserve(polygon.size() + 1);
    back.reserve(polygon.size() + 1);
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const glm::dvec3& p = polygon[k];
        const glm::dvec3& q = polygon[k + 1 == polygon.size() ? 0 : k + 1];
        const double vp = plane.at(p), vq = plane.at(q);
        if (vp >= -kTolerance) front.push_back(p);
        if (vp <= kTolerance) back.push_back(p);
        const bool crosses =
            (vp > kTolerance && vq < -kTolerance) || (vp < -kTolerance && vq > kTolerance);
        if (!crosses) continue;
        const glm::dvec3 crossing = p + (vp / (vp - vq)) * (q - p);
        front.push_back(crossing);
        back.push_back(crossing);
    }
}

}  // namespace sightline::bsp
