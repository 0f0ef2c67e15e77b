#include "sightline/screen_scene.hpp"

#include "math/predicates.hpp"

namespace sightline {

Plane ScreenScene::plane(std::uint32_t id) const {
    if (const std::uint32_t sheet = shared_plane(id); sheet != kNone) return sheet_planes_[sheet];
    if (!clipped_planes_.empty())
        if (const auto own = clipped_planes_.find(id); own != clipped_planes_.end())
            return own->second;
    const Corners c = scene_->triangles[id];
    return plane_through(point(c.x), point(c.y), point(c.z));
}

bool ScreenScene::is_edge_on(std::uint32_t id) const {
    const Corners c = scene_->triangles[id];
    const auto& positions = scene_->positions;
    return camera_.sees_edge_on({positions[c.x], positions[c.y], positions[c.z]});
}

double ScreenScene::metric_depth(double z) const {
    const double n = camera_.near_plane, f = camera_.far_plane;
    const double t = z / kDepthMax;
    if (!camera_.is_perspective()) return n + t * (f - n);
    return n * f / (f - t * (f - n));
}

}  // namespace sightline
