#include "plot/section_grid.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <utility>

namespace sightline {
namespace {

constexpr std::size_t kLeastCells = 16;  // along a side, however short
constexpr double kSamePlane = 1e-9;      // of the box: planes so close are one

std::vector<double> planes_within(std::vector<double> planes, double lo, double hi) {
    const double apart = kSamePlane * (hi - lo);
    std::erase_if(planes, [&](double p) { return !(p >= lo - apart && p <= hi + apart); });
    for (double& p : planes) {
        if (std::abs(p - lo) <= apart) p = lo;
        if (std::abs(p - hi) <= apart) p = hi;
    }
    std::ranges::sort(planes);
    const auto same = [&](double a, double b) { return b - a <= apart; };
    planes.erase(std::unique(planes.begin(), planes.end(), same), planes.end());
    return planes;
}

/// From lo to hi by way of the planes, in even steps of no more than `step` between them.
std::vector<double> nodes_of(std::vector<double> planes, double lo, double hi, double step) {
    if (planes.empty() || planes.front() > lo) planes.insert(planes.begin(), lo);
    if (planes.back() < hi) planes.push_back(hi);
    std::vector<double> nodes;
    for (std::size_t k = 0; k + 1 < planes.size(); ++k) {
        const double gap = planes[k + 1] - planes[k];
        // Rounding must not add a cell.
        const double n = std::max(1.0, std::ceil(gap / step - 1e-6));
        for (double i = 0; i < n; ++i) nodes.push_back(planes[k] + gap * (i / n));
    }
    nodes.push_back(hi);
    return nodes;
}

bool has(const std::vector<double>& planes, double at) {
    return std::ranges::binary_search(planes, at);
}

/// Distances of chords from the surface.
class ChordSampler {
public:
    ChordSampler(const Field& field, const Camera& camera)
        : value_(field.make()), camera_(camera) {}

    /// In pixels, for the side from a to b. `flat_axis`: the surface is cut by a plane across this
    /// axis, and the distance is that from the cut; -1: not.
    [[nodiscard]] std::optional<double> error(glm::dvec3 a, glm::dvec3 b, int flat_axis) {
        const glm::dvec3 middle = 0.5 * (a + b);
        const double length = glm::distance(a, b), depth = camera_.depth_of(middle);
        if (depth <= camera_.near_plane || depth >= camera_.far_plane) return std::nullopt;
        const glm::dvec2 pixel = camera_.pixel_of(middle);
        if (!(pixel.x >= 0 && pixel.x <= camera_.resolution.width && pixel.y >= 0 &&
              pixel.y <= camera_.resolution.height))
            return std::nullopt;
        const double step = length / 16;
        double square = 0;
        for (int axis = 0; axis < 3; ++axis) {
            if (axis == flat_axis) continue;
            glm::dvec3 by{};
            by[axis] = step;
            const double slope = (value_(middle + by) - value_(middle - by)) / (2 * step);
            square += slope * slope;
        }
        const double off = std::abs(value_(middle)) / std::sqrt(square);
        if (!(off <= length)) return std::nullopt;  // no gradient to speak of
        return off * camera_.pixels_per_unit() / (camera_.is_perspective() ? depth : 1.0);
    }

private:
    Evaluator value_;
    const Camera& camera_;
};

}  // namespace

SectionPlanes::SectionPlanes(const Box& of, std::vector<double> x_planes,
                             std::vector<double> z_planes)
    : box(of),
      x(planes_within(std::move(x_planes), of.lo.x, of.hi.x)),
      z(planes_within(std::move(z_planes), of.lo.z, of.hi.z)) {}

bool SectionPlanes::contain(glm::dvec3 a, glm::dvec3 b, glm::dvec3 third) const {
    return (a.x == b.x && third.x != a.x && has(x, a.x)) ||
           (a.z == b.z && third.z != a.z && has(z, a.z));
}

SectionGrid grid_of(const SectionPlanes& planes, std::size_t cells) {
    const glm::dvec3 extent = planes.box.extent();
    const double step = std::max({extent.x, extent.y, extent.z}) / static_cast<double>(cells);
    const auto nodes = [&](const std::vector<double>& at, int axis) {
        const double least = extent[axis] / static_cast<double>(kLeastCells);
        return nodes_of(at, planes.box.lo[axis], planes.box.hi[axis], std::min(step, least));
    };
    return {nodes(planes.x, 0), nodes({}, 1), nodes(planes.z, 2)};
}

double chord_error(const Field& field, const SectionMesh& mesh, const SectionPlanes& planes,
                   const Camera& camera) {
    constexpr std::size_t kTriangles = 20000, kSamples = 2000;
    ChordSampler sampler(field, camera);
    const bool all = planes.x.empty() && planes.z.empty();
    std::vector<double> errors;
    const std::size_t stride = std::max<std::size_t>(1, mesh.triangles.size() / kTriangles);
    for (std::size_t t = 0; t < mesh.triangles.size() && errors.size() < kSamples; t += stride) {
        const Corners c = mesh.triangles[t];
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 a = mesh.points[c[k]], b = mesh.points[c[(k + 1) % 3]];
            if (!all && !planes.contain(a, b, mesh.points[c[(k + 2) % 3]])) continue;
            const int flat = all ? -1 : a.x == b.x ? 0 : 2;
            if (const auto error = sampler.error(a, b, flat)) errors.push_back(*error);
        }
    }
    if (errors.empty()) return 0;
    const auto nearly_all = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() * 99 / 100);
    std::ranges::nth_element(errors, nearly_all);
    return *nearly_all;
}

}  // namespace sightline
