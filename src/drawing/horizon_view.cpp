#include "drawing/horizon_view.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace sightline {
namespace {

/// A gaze straight up or down has no row that is in front: it is tilted by this, which moves what
/// is a unit high by a millionth.
constexpr double kTilt = 1e-6;
/// Depth of the nearest row in perspective, as a share of the grid's size. What is nearer lies in
/// the eye's own vertical line.
constexpr double kNearest = 1e-9;
/// Lines of sight that point backwards, or nearly across, are not on the page.
constexpr double kNearestOnPage = 1e-7;

double mean_step(const std::vector<double>& nodes) {
    return (nodes.back() - nodes.front()) / static_cast<double>(nodes.size() - 1);
}

/// Narrows t0..t1 to where a + t (b - a) >= 0.
void clip(double a, double b, double& t0, double& t1) {
    if (a >= 0 && b >= 0) return;
    if (a < 0 && b < 0) {
        t1 = -1;
        return;
    }
    const double t = a / (a - b);
    if (a < 0) {
        t0 = std::max(t0, t);
    } else {
        t1 = std::min(t1, t);
    }
}

template <class Vector>
Vector between(const Vector& a, const Vector& b, double t) {
    if (t <= 0) return a;
    if (t >= 1) return b;
    return a + t * (b - a);
}

/// The direction of parallel lines of sight, never quite vertical.
glm::dvec3 parallel_sight(const Camera& camera) {
    glm::dvec3 d = camera.view_vector(camera.target);
    const double level = std::hypot(d.x, d.z);
    if (level >= kTilt * std::abs(d.y)) return d;
    glm::dvec2 ahead(camera.up.x, camera.up.z);
    if (d.y > 0) ahead = -ahead;
    const double length = std::hypot(ahead.x, ahead.y);
    const glm::dvec2 tilt = kTilt * std::abs(d.y) * (ahead / length);
    return {tilt.x, d.y, tilt.y};
}

}  // namespace

std::vector<HorizonView> HorizonView::all(const HeightGrid& for_x, const HeightGrid& for_z,
                                          const Camera& camera) {
    std::vector<HorizonView> views;
    // Lines of sight cross no more than about one cell from one row to the next: that decides which
    // view has them.
    const double step_x = mean_step(for_z.x), step_z = mean_step(for_x.z);
    if (camera.is_perspective()) {
        for (const bool forward : {false, true}) {
            views.push_back(HorizonView(for_z, camera, false, forward, step_x / step_z));
            views.push_back(HorizonView(for_x, camera, true, forward, step_z / step_x));
        }
        return views;
    }
    const glm::dvec3 d = parallel_sight(camera);
    const bool along_x = std::abs(d.x) * step_z > std::abs(d.z) * step_x;
    views.push_back(
        HorizonView(along_x ? for_x : for_z, camera, along_x, (along_x ? d.x : d.z) > 0, 0));
    return views;
}

HorizonView::HorizonView(const HeightGrid& grid, const Camera& camera, bool along_x, bool forward,
                         double half_width)
    : camera_(&camera),
      along_x_(along_x),
      forward_(forward),
      perspective_(camera.is_perspective()),
      half_width_(half_width) {
    origin_ = perspective_ ? camera.eye
                           : glm::dvec3(0.5 * (grid.x.front() + grid.x.back()), 0,
                                        0.5 * (grid.z.front() + grid.z.back()));
    if (!perspective_) set_parallel();
    set_axes(grid);
    set_range();
}

glm::dvec3 HorizonView::local(glm::dvec3 point) const {
    const glm::dvec3 p = point - origin_;
    const double depth = along_x_ ? p.x : p.z;
    return {along_x_ ? p.z : p.x, p.y, forward_ ? depth : -depth};
}

glm::dvec3 HorizonView::world(glm::dvec3 l) const {
    const double depth = forward_ ? l.z : -l.z;
    return along_x_ ? glm::dvec3(depth, l.y, l.x) : glm::dvec3(l.x, l.y, depth);
}

glm::dvec2 HorizonView::moved(glm::dvec3 vector) const {
    const glm::dvec2 page =
        glm::dvec2(glm::dot(vector, camera_->right), glm::dot(vector, camera_->up)) -
        camera_->oblique * glm::dot(vector, camera_->back);
    return camera_->pixels_per_unit() * glm::dvec2(page.x, -page.y);
}

void HorizonView::set_parallel() {
    const glm::dvec3 d = parallel_sight(*camera_);
    const double depth = forward_ ? (along_x_ ? d.x : d.z) : -(along_x_ ? d.x : d.z);
    slant_ = {(along_x_ ? d.z : d.x) / depth, d.y / depth};
    base_ = camera_->pixel_of(origin_);
    page_u_ = moved(world({1, 0, 0}));
    // Lines of sight are points of the page, so a step up is as good as the step in depth that
    // reaches the same line. Seen from high above, a step up is no length to measure with.
    page_v_ = std::abs(slant_.y) < 1 ? moved(world({0, 1, 0}))
                                     : -moved(world({slant_.x, 0, 1})) / slant_.y;
}

void HorizonView::set_axes(const HeightGrid& grid) {
    const std::vector<double>& across = along_x_ ? grid.z : grid.x;
    const std::vector<double>& depths = along_x_ ? grid.x : grid.z;
    const double across_origin = along_x_ ? origin_.z : origin_.x;
    const double depth_origin = along_x_ ? origin_.x : origin_.z;
    for (const double a : across) across_.push_back(a - across_origin);
    for (const double d : depths) depths_.push_back(forward_ ? d - depth_origin : depth_origin - d);
    const double size = std::max(std::abs(across.back() - across.front()),
                                 std::abs(depths.back() - depths.front()));
    nearest_ = kNearest * size;
    for (std::size_t k = 0; k < depths_.size(); ++k) {
        const std::size_t row = forward_ ? k : depths_.size() - 1 - k;
        if (!perspective_ || depths_[row] >= nearest_) rows_.push_back(row);
    }
}

void HorizonView::set_range() {
    if (rows_.size() < 2) return;
    double low = INFINITY, high = -INFINITY;
    for (const double depth : {depths_[rows_.front()], depths_[rows_.back()]}) {
        for (const double a : {across_.front(), across_.back()}) {
            const double u = seen({a, 0, depth}).x;
            low = std::min(low, u);
            high = std::max(high, u);
        }
    }
    from_ = perspective_ ? std::max(low, -half_width_) : low;
    to_ = perspective_ ? std::min(high, half_width_) : high;
}

double HorizonView::pixels_across() const {
    return perspective_ ? camera_->pixels_per_unit() : glm::length(page_u_);
}

double HorizonView::depth_of_row(std::size_t row) const { return depths_[row]; }

double HorizonView::camera_depth(glm::dvec2 uv) const {
    return -glm::dot(world({uv.x, uv.y, 1}), camera_->back);
}

glm::dvec2 HorizonView::pixel(glm::dvec2 uv) const {
    if (!perspective_) return base_ + uv.x * page_u_ + uv.y * page_v_;
    const glm::dvec3 sight = world({uv.x, uv.y, 1});
    const double scale = -camera_->pixels_per_unit() / glm::dot(sight, camera_->back);
    return {0.5 * camera_->resolution.width + scale * glm::dot(sight, camera_->right),
            0.5 * camera_->resolution.height - scale * glm::dot(sight, camera_->up)};
}

std::optional<std::array<glm::dvec2, 2>> HorizonView::on_page(glm::dvec2 a, glm::dvec2 b) const {
    double t0 = 0, t1 = 1;
    if (perspective_) {
        clip(camera_depth(a) - kNearestOnPage, camera_depth(b) - kNearestOnPage, t0, t1);
        if (!(t0 < t1)) return std::nullopt;
    }
    const glm::dvec2 p = pixel(between(a, b, t0)), q = pixel(between(a, b, t1));
    const Resolution size = camera_->resolution;
    t0 = 0;
    t1 = 1;
    clip(p.x, q.x, t0, t1);
    clip(p.y, q.y, t0, t1);
    clip(size.width - p.x, size.width - q.x, t0, t1);
    clip(size.height - p.y, size.height - q.y, t0, t1);
    if (!(t0 < t1)) return std::nullopt;
    return std::array{between(p, q, t0), between(p, q, t1)};
}

std::optional<std::array<glm::dvec2, 2>> HorizonView::seen_line(const AxisLine& line) const {
    const glm::dvec3 a = local(line[0]), b = local(line[1]);
    if (!perspective_) return std::array{seen(a), seen(b)};
    double t0 = 0, t1 = 1;
    clip(a.z - nearest_, b.z - nearest_, t0, t1);
    clip(half_width_ * a.z - a.x, half_width_ * b.z - b.x, t0, t1);
    clip(half_width_ * a.z + a.x, half_width_ * b.z + b.x, t0, t1);
    if (!(t0 < t1)) return std::nullopt;
    return std::array{seen(between(a, b, t0)), seen(between(a, b, t1))};
}

}  // namespace sightline
