// The depths at which a scene lies within the four sides of a view.
//
// Source: I. Sutherland, G. Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974; for quadrics
// the branch and bound of R. Moore, "Interval Analysis", 1966.
//
// How this version differs: nothing is projected. A point is the list of what is linear in it, its
// depth and its distances to the four sides, and it is these that are interpolated.
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <queue>
#include <vector>

#include "math/frame.hpp"
#include "sightline/camera.hpp"
#include "sightline/scene.hpp"

namespace sightline {

namespace {

constexpr std::uint32_t kGrain = 4096;  // triangles that a task takes at a time
constexpr std::size_t kSides = 4;

/// The depth of a point, then its distances to the sides, not negative inside; in no common unit.
using Measures = std::array<double, 1 + kSides>;

/// The four sides of a view. In perspective what is inside of all of them is in front of the eye.
class Sides {
public:
    explicit Sides(const Camera& camera)
        : camera_(camera),
          half_height_(0.5 * camera.view_height),
          half_width_(half_height_ * camera.resolution.width / camera.resolution.height),
          target_depth_(camera.is_perspective() ? 0 : camera.depth_of(camera.target)) {}

    [[nodiscard]] Measures of_point(const glm::dvec3& p) const {
        const glm::dvec3 v = p - camera_.eye;
        const double depth = -glm::dot(camera_.back, v);
        double x = glm::dot(camera_.right, v), y = glm::dot(camera_.up, v);
        double share = depth;
        if (!camera_.is_perspective()) {
            x += camera_.oblique.x * (depth - target_depth_);
            y += camera_.oblique.y * (depth - target_depth_);
            share = 1;
        }
        return of(depth, x, y, share);
    }
    /// By how much the measures grow along a vector.
    [[nodiscard]] Measures of_vector(const glm::dvec3& v) const {
        const double depth = -glm::dot(camera_.back, v);
        double x = glm::dot(camera_.right, v), y = glm::dot(camera_.up, v);
        if (camera_.is_perspective()) return of(depth, x, y, depth);
        x += camera_.oblique.x * depth;
        y += camera_.oblique.y * depth;
        return of(depth, x, y, 0);
    }

private:
    [[nodiscard]] Measures of(double depth, double x, double y, double share) const {
        const double width = half_width_ * share, height = half_height_ * share;
        return {depth, width - x, width + x, height - y, height + y};
    }

    const Camera& camera_;
    double half_height_, half_width_, target_depth_;
};

using Polygon = std::array<Measures, 3 + kSides>;  // each side adds a corner at most

Measures between(const Measures& a, const Measures& b, std::size_t side) {
    const double s = a[side] / (a[side] - b[side]);
    Measures cut;
    for (std::size_t m = 0; m < cut.size(); ++m) cut[m] = a[m] + s * (b[m] - a[m]);
    cut[side] = 0;
    return cut;
}

std::size_t clip_by(std::size_t side, const Polygon& in, std::size_t count, Polygon& out) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Measures &here = in[i], &next = in[i + 1 == count ? 0 : i + 1];
        const bool here_inside = here[side] >= 0, next_inside = next[side] >= 0;
        if (here_inside) out[kept++] = here;
        if (here_inside != next_inside) out[kept++] = between(here, next, side);
    }
    return kept;
}

/// The depths of a triangle within the sides.
DepthRange depths_of(const std::array<Measures, 3>& corners) {
    DepthRange whole;
    bool all_inside = true;
    for (const Measures& corner : corners) {
        whole.take_in({corner[0], corner[0]});
        for (std::size_t side = 1; side <= kSides; ++side)
            all_inside = all_inside && corner[side] >= 0;
    }
    if (all_inside) return whole;
    for (std::size_t side = 1; side <= kSides; ++side)
        if (corners[0][side] < 0 && corners[1][side] < 0 && corners[2][side] < 0) return {};
    Polygon polygon{corners[0], corners[1], corners[2]}, next;
    std::size_t count = 3;
    for (std::size_t side = 1; side <= kSides; ++side) {
        count = clip_by(side, polygon, count, next);
        std::swap(polygon, next);
    }
    DepthRange range;
    for (std::size_t i = 0; i < count; ++i) {
        // What is interpolated can be off in the last digits.
        const double depth = std::clamp(polygon[i][0], whole.nearest, whole.farthest);
        range.take_in({depth, depth});
    }
    return range;
}

// -- quadrics ---------------------------------------------------------------------------------

/// A cell of a quadric's box, in the quadric's own coordinates.
struct Cell {
    glm::dvec3 centre, half;
    double depth, radius;  ///< depths from depth - radius to depth + radius
    [[nodiscard]] double nearest() const { return depth - radius; }
};

struct IsFarther {
    bool operator()(const Cell& a, const Cell& b) const { return a.nearest() > b.nearest(); }
};

/// Looks for the nearest point of a quadric within the sides: of the cells that may hold one, the
/// one that begins nearest is split.
class NearestOfQuadric {
public:
    NearestOfQuadric(const Quadric& quadric, const Sides& sides)
        : quadric_(quadric), sides_(sides) {
        for (int k = 0; k < 3; ++k) {
            along_[static_cast<std::size_t>(k)] = sides.of_vector(glm::dvec3(quadric.frame[k]));
        }
    }

    [[nodiscard]] DepthRange find() {
        add(quadric_.clip.centre(), 0.5 * quadric_.clip.extent());
        for (int splits = 0; splits < kMostSplits && !cells_.empty(); ++splits) {
            const Cell cell = cells_.top();
            if (2 * cell.radius <= kTolerance * std::abs(cell.depth) &&
                std::max({cell.half.x, cell.half.y, cell.half.z}) <= kSmallCell)
                break;
            cells_.pop();
            split(cell);
        }
        if (cells_.empty()) return {};
        return {cells_.top().nearest(), farthest_of_box()};
    }

private:
    static constexpr double kTolerance = 1e-3;       // of the depth
    static constexpr double kSmallCell = 1.0 / 128;  // of a box that is about 1 in size
    static constexpr int kMostSplits = 20000;

    [[nodiscard]] double farthest_of_box() const {
        const Box box = bounds_of(quadric_);
        double farthest = cells_.top().nearest();
        for (unsigned k = 0; k < 8; ++k) {
            const glm::dvec3 corner{(k & 1) != 0 ? box.hi.x : box.lo.x,
                                    (k & 2) != 0 ? box.hi.y : box.lo.y,
                                    (k & 4) != 0 ? box.hi.z : box.lo.z};
            farthest = std::max(farthest, sides_.of_point(corner)[0]);
        }
        return farthest;
    }

    /// Unless it is empty for certain.
    void add(const glm::dvec3& centre, const glm::dvec3& half) {
        const std::array<double, 10>& c = quadric_.coefficients;
        const glm::dvec3 slope = glm::abs(quadric_.gradient_at(centre));
        const double change = glm::dot(slope, half) + std::abs(c[0]) * half.x * half.x +
                              std::abs(c[1]) * half.y * half.y + std::abs(c[2]) * half.z * half.z +
                              std::abs(c[3]) * half.x * half.y + std::abs(c[4]) * half.x * half.z +
                              std::abs(c[5]) * half.y * half.z;
        if (std::abs(quadric_.value_at(centre)) > (1 + 1e-9) * change) return;
        const Measures middle =
            sides_.of_point(glm::dvec3(quadric_.frame * glm::dvec4(centre, 1.0)));
        Measures reach;
        for (std::size_t m = 0; m < reach.size(); ++m)
            reach[m] = half.x * std::abs(along_[0][m]) + half.y * std::abs(along_[1][m]) +
                       half.z * std::abs(along_[2][m]);
        for (std::size_t side = 1; side <= kSides; ++side)
            if (middle[side] + reach[side] < 0) return;
        cells_.push({centre, half, middle[0], reach[0]});
    }

    void split(const Cell& cell) {
        int axis = cell.half.y > cell.half.x ? 1 : 0;
        if (cell.half.z > cell.half[axis]) axis = 2;
        glm::dvec3 half = cell.half, offset(0);
        half[axis] *= 0.5;
        offset[axis] = half[axis];
        add(cell.centre - offset, half);
        add(cell.centre + offset, half);
    }

    const Quadric& quadric_;
    const Sides& sides_;
    std::array<Measures, 3> along_;  // the axes of its own coordinates
    std::priority_queue<Cell, std::vector<Cell>, IsFarther> cells_;
};

// -- the scene --------------------------------------------------------------------------------

class DepthFinder {
public:
    DepthFinder(const Scene& scene, const Camera& camera, EdgeOn edge_on)
        : scene_(scene), camera_(camera), sides_(camera), edge_on_(edge_on) {}

    [[nodiscard]] DepthRange find() {
        std::vector<std::uint8_t> moving(scene_.objects.size(), 0);
        for (const Motion& motion : scene_.motions) {
            if (motion.frames.empty()) continue;
            for (std::uint32_t i = 0; i < motion.object_count; ++i)
                moving[motion.first_object + i] = 1;
            for (const glm::dmat4& by : motion.frames) {
                for (std::uint32_t i = 0; i < motion.object_count; ++i)
                    take_in(motion.first_object + i, &by);
            }
        }
        for (std::uint32_t o = 0; o < scene_.objects.size(); ++o)
            if (moving[o] == 0) take_in(o, nullptr);
        return range_;
    }

private:
    void take_in(std::uint32_t object, const glm::dmat4* by) {
        const std::size_t first_quadric = scene_.objects.size() - scene_.quadrics.size();
        if (object >= first_quadric) {
            const Quadric& rest = scene_.quadrics[object - first_quadric];
            take_in(by != nullptr ? transformed(rest, *by) : rest);
        } else if (by != nullptr) {
            const math::Frame frame(*by);
            take_in_triangles(scene_.objects[object],
                              [&](const glm::dvec3& p) { return frame.point(p); });
        } else {
            take_in_triangles(scene_.objects[object], [](const glm::dvec3& p) { return p; });
        }
    }

    void take_in(const Quadric& quadric) {
        DepthRange range = NearestOfQuadric(quadric, sides_).find();
        if (camera_.is_perspective()) range.nearest = std::max(range.nearest, 0.0);
        range_.take_in(range);
    }

    template <class Place>
    void take_in_triangles(const Object& object, const Place& place) {
        range_.take_in(tbb::parallel_reduce(
            tbb::blocked_range<std::uint32_t>(0, object.triangle_count, kGrain), DepthRange{},
            [&](const auto& part, DepthRange range) {
                for (std::uint32_t i = part.begin(); i != part.end(); ++i) {
                    const std::uint32_t t = object.first_triangle + i;
                    if (!scene_.degenerate.empty() && scene_.degenerate[t] != 0) continue;
                    const Corners c = scene_.triangles[t];
                    range.take_in(
                        of_triangle({place(scene_.positions[c.x]), place(scene_.positions[c.y]),
                                     place(scene_.positions[c.z])}));
                }
                return range;
            },
            [](DepthRange a, const DepthRange& b) {
                a.take_in(b);
                return a;
            }));
    }

    [[nodiscard]] DepthRange of_triangle(const std::array<glm::dvec3, 3>& corners) const {
        const DepthRange range =
            depths_of({sides_.of_point(corners[0]), sides_.of_point(corners[1]),
                       sides_.of_point(corners[2])});
        if (range.empty() || edge_on_ == EdgeOn::counts) return range;
        return camera_.sees_edge_on(corners) ? DepthRange{} : range;
    }

    const Scene& scene_;
    const Camera& camera_;
    Sides sides_;
    EdgeOn edge_on_;
    DepthRange range_;
};

}  // namespace

void DepthRange::take_in(const DepthRange& other) {
    nearest = std::min(nearest, other.nearest);
    farthest = std::max(farthest, other.farthest);
}

DepthRange depths_in_view(const Scene& scene, const Camera& camera, EdgeOn edge_on) {
    DepthRange range = DepthFinder(scene, camera, edge_on).find();
    // -0 becomes +0: which zero a minimum keeps depends on the order.
    if (!range.empty()) range = {range.nearest + 0.0, range.farthest + 0.0};
    return range;
}

}  // namespace sightline
