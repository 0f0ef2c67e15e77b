// Source: A. Hertzmann, D. Zorin, "Illustrating Smooth Surfaces", SIGGRAPH 2000, section 4: the
// contour of a smooth surface crosses the edges of its mesh where the product of normal and view
// direction changes its sign. (The edges between front and back faces of a mesh zigzag, and thin
// triangles add specks.) How this version differs: the field is at hand, so points are moved onto
// the surface and to where the product is 0; and what is seen is decided by lifting the curve off
// the mesh along the lines of sight. A contour in front of a hollow, which can't be seen, is inside
// of the surface then.
#include "plot/contours.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "math/arena.hpp"
#include "plot/root.hpp"

namespace sightline {
namespace {

// Of a cell. Derivatives are differences over this length: their error is of its square, and of
// 2^-52 through its inverse.
constexpr double kDifference = 0x1p-10;
constexpr double kInPlane = 1e-6;  // of a cell: a point so near to a plane lies in it

using MeshEdge = std::pair<std::uint32_t, std::uint32_t>;  // vertices, the lower one first

MeshEdge edge_of(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

double largest_cell(const SectionGrid& grid) {
    double largest = 0;
    for (const auto* nodes : {&grid.x, &grid.y, &grid.z})
        for (std::size_t k = 0; k + 1 < nodes->size(); ++k)
            largest = std::max(largest, (*nodes)[k + 1] - (*nodes)[k]);
    return largest;
}

template <class Body>
void for_each_of(std::size_t n, const Body& body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 256), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
    });
}

class ContourFinder {
public:
    ContourFinder(const Field& field, const SectionMesh& mesh, const SectionGrid& grid,
                  const Camera& camera)
        : mesh_(mesh), camera_(camera), evaluators_(field), cell_(largest_cell(grid)) {
        step_ = kDifference * cell_;
        noise_ = kNoise * usual_size(evaluators_.local(), grid.lo(), grid.hi());
    }

    void run() {
        find_facing();
        collect_edges();
        points_.resize(edges_.size());
        for_each_of(edges_.size(), [&](std::size_t k) { points_[k] = contour_point(edges_[k]); });
    }
    /// Calls body(p, q) for each piece.
    template <class Body>
    void each_piece(const Body& body) const {
        for (const std::uint32_t t : triangles_) {
            glm::dvec3 ends[2];
            int count = 0;
            each_crossed_side(t, [&](const MeshEdge& edge) {
                const auto at = std::ranges::lower_bound(edges_, edge) - edges_.begin();
                if (count < 2) ends[count++] = points_[static_cast<std::size_t>(at)];
            });
            if (count == 2) body(ends[0], ends[1]);
        }
    }
    /// The point of the same line of sight that is nearer by a cell (less where that would reach
    /// the near plane).
    [[nodiscard]] glm::dvec3 lifted(glm::dvec3 p) const {
        const glm::dvec3 view = glm::normalize(camera_.view_vector(p));
        const double room = camera_.depth_of(p) - camera_.near_plane;
        const double deeper = glm::dot(view, camera_.gaze());
        const double length = std::min(std::sqrt(3.0) * cell_, 0.5 * room / deeper);
        return length > 0 ? p - length * view : p;
    }
    [[nodiscard]] double cell() const { return cell_; }

private:
    /// How the field grows along the line of sight, but for a factor; 0 where that is rounding.
    [[nodiscard]] double growth(Evaluator& value, glm::dvec3 p) const {
        const glm::dvec3 view = step_ * glm::normalize(camera_.view_vector(p));
        const double behind = value(p + view), before = value(p - view);
        // At a border of the domain: one side, as the value here is 0.
        const double g = std::isfinite(behind) && std::isfinite(before) ? behind - before
                         : std::isfinite(behind)                        ? 2 * behind
                                                                        : -2 * before;
        return std::abs(g) <= noise_ ? 0 : g;
    }

    void find_facing() {
        growth_.resize(mesh_.points.size());
        for_each_of(growth_.size(), [&](std::size_t v) {
            growth_[v] = growth(evaluators_.local(), mesh_.points[v]);
        });
    }
    [[nodiscard]] bool is_crossed(std::uint32_t a, std::uint32_t b) const {
        return std::isfinite(growth_[a]) && std::isfinite(growth_[b]) &&
               (growth_[a] >= 0) != (growth_[b] >= 0);
    }
    template <class Body>
    void each_crossed_side(std::uint32_t t, const Body& body) const {
        const Corners c = mesh_.triangles[t];
        for (int k = 0; k < 3; ++k)
            if (is_crossed(c[k], c[(k + 1) % 3])) body(edge_of(c[k], c[(k + 1) % 3]));
    }
    void collect_edges() {
        for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
            const std::size_t before = edges_.size();
            each_crossed_side(t, [&](const MeshEdge& edge) { edges_.push_back(edge); });
            if (edges_.size() != before) triangles_.push_back(t);
        }
        std::ranges::sort(edges_);
        const auto rest = std::ranges::unique(edges_);
        edges_.erase(rest.begin(), rest.end());
    }

    /// Follows the gradient to the surface; stays where that leads farther than `reach`.
    [[nodiscard]] glm::dvec3 onto_surface(Evaluator& value, glm::dvec3 from, double reach) const {
        glm::dvec3 p = from;
        for (int round = 0; round < 3; ++round) {
            glm::dvec3 gradient{};
            for (int axis = 0; axis < 3; ++axis) {
                glm::dvec3 by{};
                by[axis] = step_;
                gradient[axis] = (value(p + by) - value(p - by)) / (2 * step_);
            }
            const double f = value(p);
            if (std::abs(f) <= noise_) break;
            p -= f / glm::dot(gradient, gradient) * gradient;
            if (!(glm::distance(p, from) <= reach)) return from;
        }
        return p;
    }

    [[nodiscard]] glm::dvec3 contour_point(const MeshEdge& edge) {
        // Twelve halvings would do; the secant takes fewer where the field is smooth.
        constexpr int kSteps = 12;
        Evaluator& value = evaluators_.local();
        const glm::dvec3 a = mesh_.points[edge.first], b = mesh_.points[edge.second];
        const double reach = glm::distance(a, b);
        const bool first_sign = growth_[edge.first] >= 0;
        double t0 = 0, t1 = 1, g0 = growth_[edge.first], g1 = growth_[edge.second];
        const double good = 0x1p-16 * std::max(std::abs(g0), std::abs(g1));
        glm::dvec3 p = a;
        for (int step = 0; step < kSteps; ++step) {
            const double secant = t0 + (t1 - t0) * (g0 / (g0 - g1));
            const double t =
                step % 3 != 2 && secant >= t0 && secant <= t1 ? secant : 0.5 * (t0 + t1);
            p = onto_surface(value, a + t * (b - a), reach);
            const double g = growth(value, p);
            if (!(std::abs(g) > good)) break;
            const bool at_start = (g >= 0) == first_sign;
            (at_start ? t0 : t1) = t;
            (at_start ? g0 : g1) = g;
        }
        return p;
    }

    const SectionMesh& mesh_;
    const Camera& camera_;
    Evaluators evaluators_;
    double cell_, step_ = 0, noise_ = 0;
    std::vector<double> growth_;            // of each vertex, see growth()
    std::vector<std::uint32_t> triangles_;  // that a contour crosses
    std::vector<MeshEdge> edges_;           // the same, in order
    std::vector<glm::dvec3> points_;        // theirs
};

/// Whether two coordinates lie in one of the planes.
bool in_plane(const std::vector<double>& planes, double a, double b, double tolerance) {
    const auto next = std::ranges::lower_bound(planes, a - tolerance);
    return next != planes.end() && std::abs(*next - a) <= tolerance &&
           std::abs(*next - b) <= tolerance;
}

}  // namespace

std::vector<FreeLine> find_contours(const Field& field, const SectionMesh& mesh,
                                    const SectionGrid& grid, const Camera& camera,
                                    const std::vector<double>& x_planes,
                                    const std::vector<double>& z_planes, int threads) {
    ContourFinder finder(field, mesh, grid, camera);
    in_arena(threads, [&] { finder.run(); });
    std::vector<FreeLine> lines;
    const double tolerance = kInPlane * finder.cell();
    finder.each_piece([&](glm::dvec3 p, glm::dvec3 q) {
        if (in_plane(x_planes, p.x, q.x, tolerance) || in_plane(z_planes, p.z, q.z, tolerance))
            return;
        lines.push_back({finder.lifted(p), finder.lifted(q), EdgeKind::outline});
    });
    return lines;
}

}  // namespace sightline
