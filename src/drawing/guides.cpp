// Construction lines of perspective: the edges of a box, extended to their vanishing points.
#include "sightline/drawing.hpp"

namespace sightline {

std::vector<GuideLine> vanishing_guides(const Camera& camera, const Box& box) {
    std::vector<GuideLine> guides;
    if (box.empty()) return guides;
    const auto points = principal_vanishing_points(camera);
    for (std::uint8_t axis = 0; axis < 3; ++axis) {
        if (!points[axis]) continue;
        // From the end of each edge that lies farther from the vanishing point.
        for (unsigned corner = 0; corner < 8; ++corner) {
            if ((corner >> axis & 1u) != 0) continue;
            glm::dvec3 low, high;
            for (int k = 0; k < 3; ++k)
                low[k] = high[k] =
                    (corner >> static_cast<unsigned>(k) & 1u) != 0 ? box.hi[k] : box.lo[k];
            high[axis] = box.hi[axis];
            const double to_low = camera.depth_of(low), to_high = camera.depth_of(high);
            const glm::dvec3& near = to_low < to_high ? low : high;
            if (!(camera.depth_of(near) > 0)) continue;
            guides.push_back({camera.pixel_of(near), *points[axis], axis});
        }
    }
    return guides;
}

}  // namespace sightline
