// The line of a cut. A ray e + t d meets the surface's plane T at t = -T(e) / T.d, where T(e) is
// the plane's value at e and T.d the rate along d; there the value of the node's plane N is
//
//     N(e) + t N.d  =  (N(e) T.d - T(e) N.d) / T.d.
//
// In perspective e is the eye and d = a + x a_x + y a_y. What is seen lies before the eye, t > 0,
// so T.d has the sign of -T(e) wherever the surface is seen, and the sign of the quotient is that
// of |T(e)| N.d - sign(T(e)) N(e) T.d: affine in x and y. In parallel projection d is fixed and
// e = a + x a_x + y a_y: the sign is that of |T.d| N(e) - sign(T.d) N.d T(e).
//
// A plane seen edge-on (T(e) or T.d nearly 0) gives a line that means little. Both sides of the cut
// use the same numbers all the same, so each sample of the surface still has one owner.
//
// A node's plane that is seen edge-on, N(e) = 0 in perspective and N.d = 0 in parallel projection,
// cuts all surfaces in one line of the page, that where N.d = 0 or N(e) = 0, whatever T is. Then
// this line is taken, so that rounding can't put the surfaces under a sample of the line on
// different sides, where the order of the sides means nothing. Edge-on is what stays within the
// tolerance of being it in all the scene.
//
// Only + - * / in a fixed order: the same bytes on every machine.
#include "visibility/bsp_page.hpp"

#include <algorithm>
#include <cmath>

namespace sightline::bsp {

namespace {

// Keeps products finite for an eye beyond all reason.
glm::dvec3 within_reason(const glm::dvec3& p) {
    constexpr double kFar = 1e100;
    return {std::clamp(p.x, -kFar, kFar), std::clamp(p.y, -kFar, kFar),
            std::clamp(p.z, -kFar, kFar)};
}

}  // namespace

Rays::Rays(const ScreenScene& screen, const WorldGrid& grid)
    : perspective_(screen.camera().is_perspective()) {
    const Camera& camera = screen.camera();
    const double ppu = camera.pixels_per_unit();
    const double unit = 1 / (ppu * static_cast<double>(1 << screen.subpixel_bits()));
    const glm::dvec3 x = unit * camera.right, y = -unit * camera.up;
    // Of the top left corner of the page.
    const glm::dvec3 corner = (0.5 * camera.resolution.height / ppu) * camera.up -
                              (0.5 * camera.resolution.width / ppu) * camera.right;
    // A ray leaves the scene's box after less than 2^25 steps.
    edge_on_ = perspective_ ? kTolerance : kTolerance / 0x1p25;
    if (perspective_) {
        fixed_ = within_reason(grid.of(camera.eye));
        a_ = corner + camera.gaze();
        a_x_ = x;
        a_y_ = y;
    } else {
        fixed_ = camera.view_vector(camera.target);
        // Where the page's points are at the target's depth, an oblique view does not shift them.
        const glm::dvec3 start = camera.eye + camera.depth_of(camera.target) * camera.gaze();
        a_ = within_reason(grid.of(start + corner));
        a_x_ = x / grid.step;
        a_y_ = y / grid.step;
    }
}

glm::dvec3 Rays::line(const TreePlane& node, const TreePlane& surface) const {
    const double n = perspective_ ? node.at(fixed_) : node.along(fixed_);
    if (std::abs(n) <= edge_on_) return line_edge_on(node);
    const double t = perspective_ ? surface.at(fixed_) : surface.along(fixed_);
    const double factor = std::abs(t), other = t < 0 ? -n : n;
    const auto along = [&](const glm::dvec3& d) {
        return factor * node.along(d) - other * surface.along(d);
    };
    const double constant =
        perspective_ ? along(a_) : factor * node.at(a_) - other * surface.at(a_);
    return {along(a_x_), along(a_y_), constant};
}

glm::dvec3 Rays::line_edge_on(const TreePlane& node) const {
    return {node.along(a_x_), node.along(a_y_), perspective_ ? node.along(a_) : node.at(a_)};
}

// The polygon holds all points that the triangle and the cuts so far leave, and a little more: cuts
// are moved outwards by `slack`, an amount of their value that stands for a sixteenth of a unit and
// is far above any rounding. What is outside of the moved cut by all corners is outside of the cut;
// a cut that holds all corners by the slack holds all samples.
bool CutPruner::prune(const ScreenScene& screen, std::uint32_t triangle,
                      std::vector<PageCut>& cuts) {
    polygon_.clear();
    const Corners c = screen.corners(triangle);
    for (int k = 0; k < 3; ++k) {
        const ScreenPoint& p = screen.point(c[k]);
        polygon_.push_back({static_cast<double>(p.x), static_cast<double>(p.y)});
    }
    const auto slack_of = [](const PageCut& cut) {
        constexpr double kPage = 0x1p23;
        return (std::abs(cut.line.x) + std::abs(cut.line.y)) * 0.0625 +
               0x1p-45 *
                   ((std::abs(cut.line.x) + std::abs(cut.line.y)) * kPage + std::abs(cut.line.z));
    };
    for (const PageCut& cut : cuts)
        if (!clip(cut, slack_of(cut))) return false;
    std::erase_if(cuts, [&](const PageCut& cut) { return !needs(cut, slack_of(cut)); });
    double top = polygon_[0].y, bottom = top;
    for (const Corner& corner : polygon_) {
        top = std::min(top, corner.y);
        bottom = std::max(bottom, corner.y);
    }
    for (PageCut& cut : cuts) {
        cut.top = static_cast<std::int32_t>(std::floor(top)) - 1;
        cut.bottom = static_cast<std::int32_t>(std::ceil(bottom)) + 1;
    }
    return true;
}

bool CutPruner::clip(const PageCut& cut, double slack) {
    const auto value = [&](const Corner& p) {
        return (cut.line.x * p.x + (cut.line.y * p.y + cut.line.z)) + slack;
    };
    clipped_.clear();
    for (std::size_t k = 0; k < polygon_.size(); ++k) {
        const Corner& p = polygon_[k];
        const Corner& q = polygon_[k + 1 == polygon_.size() ? 0 : k + 1];
        const double vp = value(p), vq = value(q);
        if (!(vp < 0)) clipped_.push_back(p);
        if ((vp < 0 && vq > 0) || (vp > 0 && vq < 0)) {
            const double t = vp / (vp - vq);
            clipped_.push_back({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)});
        }
    }
    polygon_.swap(clipped_);
    return !polygon_.empty();
}

bool CutPruner::needs(const PageCut& cut, double slack) const {
    return !std::ranges::all_of(polygon_, [&](const Corner& p) {
        return cut.line.x * p.x + (cut.line.y * p.y + cut.line.z) > slack;
    });
}

}  // namespace sightline::bsp
