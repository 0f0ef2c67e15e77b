// Source: A. Hertzmann, D. Zorin, "Illustrating Smooth Surfaces", SIGGRAPH 2000, section 4: the
// outline of a smooth surface crosses the edges of its mesh where the product of normal and view
// direction changes its sign. (The edges between front and back faces of a mesh zigzag, and thin
// triangles add specks.) A curve in which two surfaces cross is found on the mesh of one of them in
// the same way, where the other one's field changes its sign.
//
// How this version differs: the fields are at hand, so points are moved onto the surface and to
// where the second function is 0; and what is seen is decided by lifting the curve off the mesh
// along the lines of sight. An outline in front of a hollow, which can't be seen, is inside of the
// surface then.
#include "plot/surface_curves.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "math/arena.hpp"
#include "plot/root.hpp"

namespace sightline {
namespace {

constexpr double kGood = 0x1p-16;  // of a value next to it: small enough to be a zero
constexpr double kZero = 0x1p-8;   // the same: too large to be near one
// Of a cell. Derivatives are differences over this length: their error is of its square, and of
// 2^-52 through its inverse.
constexpr double kDifference = 0x1p-10;
// Of a cell. A surface with curvature k falls away from a line that touches it by k d^2 / 2 over a
// length d, and the mesh is off the surface by k d^2 / 8 for edges of that length, the longest of
// which are diagonals. A crossing touches lines of sight at its ends only.
constexpr double kLiftOfOutline = 1.75, kLiftOfCrossing = 1;
constexpr double kOnSide = 1e-6;  // of a cell: a point so near to a side lies on it

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

/// How a field grows along the line of sight, but for a factor; 0 where that is rounding.
Field growth_of(const Field& field, const Camera& camera, double step, double noise) {
    const auto make = [=, make = field.make, &camera]() -> Evaluator {
        return [=, value = make(), &camera](glm::dvec3 p) {
            const glm::dvec3 view = step * glm::normalize(camera.view_vector(p));
            const double behind = value(p + view), before = value(p - view);
            // At a border of the domain: one side, as the value here is 0.
            const double g = std::isfinite(behind) && std::isfinite(before) ? behind - before
                             : std::isfinite(behind)                        ? 2 * behind
                                                                            : -2 * before;
            return std::abs(g) <= noise ? 0 : g;
        };
    };
    return {make, field.name};
}

/// What becomes of a change of sign without a zero.
enum class Jumps { count, are_ignored };

/// Follows the zeros of a second function on a meshed surface.
class CurveFinder {
public:
    CurveFinder(const MeshedField& surface, const Field& second, Jumps jumps)
        : mesh_(surface.mesh),
          evaluators_(surface.field),
          second_(second),
          jumps_(jumps),
          step_(kDifference * largest_cell(surface.grid)),
          noise_(noise_of(surface)) {}

    static double noise_of(const MeshedField& surface) {
        Evaluator value = surface.field.make();
        return kNoise * usual_size(value, surface.grid.lo(), surface.grid.hi());
    }

    void run() {
        find_values();
        collect_edges();
        points_.resize(edges_.size());
        for_each_of(edges_.size(), [&](std::size_t k) { points_[k] = curve_point(edges_[k]); });
    }
    /// Calls body(triangle, p, q) for each piece.
    template <class Body>
    void each_piece(const Body& body) const {
        for (const std::uint32_t t : triangles_) {
            glm::dvec3 ends[2];
            int count = 0;
            each_crossed_side(t, [&](const MeshEdge& edge) {
                const auto at = std::ranges::lower_bound(edges_, edge) - edges_.begin();
                if (count < 2) ends[count++] = points_[static_cast<std::size_t>(at)];
            });
            if (count == 2 && std::isfinite(ends[0].x + ends[1].x))
                body(mesh_.triangles[t], ends[0], ends[1]);
        }
    }

private:
    void find_values() {
        value_.resize(mesh_.points.size());
        for_each_of(value_.size(),
                    [&](std::size_t v) { value_[v] = second_.local()(mesh_.points[v]); });
    }
    [[nodiscard]] bool is_crossed(std::uint32_t a, std::uint32_t b) const {
        return std::isfinite(value_[a]) && std::isfinite(value_[b]) &&
               (value_[a] >= 0) != (value_[b] >= 0);
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
        edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
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

    /// Not finite where there is no zero.
    [[nodiscard]] glm::dvec3 curve_point(const MeshEdge& edge) {
        // Twelve halvings would do; the secant takes fewer where the field is smooth.
        constexpr int kSteps = 12;
        Evaluator &value = evaluators_.local(), &second = second_.local();
        const glm::dvec3 a = mesh_.points[edge.first], b = mesh_.points[edge.second];
        const double reach = glm::distance(a, b);
        const bool first_sign = value_[edge.first] >= 0;
        double t0 = 0, t1 = 1, g0 = value_[edge.first], g1 = value_[edge.second];
        const double largest = std::max(std::abs(g0), std::abs(g1));
        double g = g0;
        glm::dvec3 p = a;
        for (int step = 0; step < kSteps; ++step) {
            const double secant = t0 + (t1 - t0) * (g0 / (g0 - g1));
            const double t =
                step % 3 != 2 && secant >= t0 && secant <= t1 ? secant : 0.5 * (t0 + t1);
            p = onto_surface(value, a + t * (b - a), reach);
            g = second(p);
            if (!(std::abs(g) > kGood * largest)) break;
            const bool at_start = (g >= 0) == first_sign;
            (at_start ? t0 : t1) = t;
            (at_start ? g0 : g1) = g;
        }
        if (jumps_ == Jumps::are_ignored && !(std::abs(g) <= kZero * largest))
            p = glm::dvec3(std::numeric_limits<double>::quiet_NaN());
        return p;
    }

    const SectionMesh& mesh_;
    Evaluators evaluators_, second_;
    Jumps jumps_;
    double step_, noise_;
    std::vector<double> value_;             // of the second function at each vertex
    std::vector<std::uint32_t> triangles_;  // that the curve crosses
    std::vector<MeshEdge> edges_;           // the same, in order
    std::vector<glm::dvec3> points_;        // theirs
};

/// Whether a piece runs along a side of its triangle that is part of a section.
bool is_section(const std::array<glm::dvec3, 3>& corners, glm::dvec3 p, glm::dvec3 q,
                const SectionPlanes& planes, double tolerance) {
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 a = corners[k], b = corners[(k + 1) % 3];
        if (!planes.contain(a, b, corners[(k + 2) % 3])) continue;
        const glm::dvec3 way = glm::normalize(b - a);
        if (glm::length(glm::cross(way, p - a)) <= tolerance &&
            glm::length(glm::cross(way, q - a)) <= tolerance)
            return true;
    }
    return false;
}

/// Lifts points off surfaces.
class Lifter {
public:
    Lifter(const CurveView& view, double by, double step)
        : camera_(view.camera), by_(by), step_(step) {
        for (const Field& other : view.others) others_.push_back(other.make());
    }

    /// The point of the same line of sight that is nearer to the viewer by a length (or half as far
    /// away as the near plane, if that is less). It stays where that leads through one of the other
    /// surfaces, which hides it then.
    [[nodiscard]] glm::dvec3 lifted(glm::dvec3 p) {
        const glm::dvec3 view = glm::normalize(camera_.view_vector(p));
        const double room = camera_.depth_of(p) - camera_.near_plane;
        const double length = std::min(by_, 0.5 * room / glm::dot(view, camera_.gaze()));
        if (!(length > 0)) return p;
        const glm::dvec3 lifted = p - length * view;
        for (Evaluator& other : others_) {
            const double here = other(p - std::min(step_, length) * view), there = other(lifted);
            if ((here < 0 && there > 0) || (here > 0 && there < 0)) return p;
        }
        return lifted;
    }

private:
    const Camera& camera_;
    double by_, step_;
    std::vector<Evaluator> others_;
};

std::vector<FreeLine> curves_of(const MeshedField& surface, const Field& second, Jumps jumps,
                                EdgeKind kind, const CurveView& view) {
    CurveFinder finder(surface, second, jumps);
    in_arena(view.threads, [&] { finder.run(); });
    std::vector<FreeLine> lines;
    const double cell = largest_cell(surface.grid);
    Lifter lifter(view, cell * (kind == EdgeKind::outline ? kLiftOfOutline : kLiftOfCrossing),
                  kDifference * cell);
    finder.each_piece([&](Corners c, glm::dvec3 p, glm::dvec3 q) {
        const auto& at = surface.mesh.points;
        if (p == q || is_section({at[c.x], at[c.y], at[c.z]}, p, q, view.planes, kOnSide * cell))
            return;
        lines.push_back({.from = lifter.lifted(p), .to = lifter.lifted(q), .kind = kind});
    });
    return lines;
}

}  // namespace

std::vector<FreeLine> find_outlines(const MeshedField& surface, const CurveView& view) {
    const double step = kDifference * largest_cell(surface.grid);
    const Field growth =
        growth_of(surface.field, view.camera, step, CurveFinder::noise_of(surface));
    // Jumps of the gradient are creases, and outlines as well.
    return curves_of(surface, growth, Jumps::count, EdgeKind::outline, view);
}

std::vector<FreeLine> find_common_curves(const MeshedField& surface, const Field& second,
                                         const CurveView& view) {
    return curves_of(surface, second, Jumps::are_ignored, EdgeKind::intersection, view);
}

}  // namespace sightline
