// How a triangle lies to a rectangle of samples, in integers: what both stages of Warnock's
// subdivision ask.
#pragma once

#include <algorithm>
#include <cstdint>

#include "math/predicates.hpp"
#include "visibility/sample_units.hpp"
#include "visibility/sampled_plane.hpp"

namespace sightline::warnock {

/// Samples i0 .. i1 by j0 .. j1, both inclusive; empty when a first one exceeds its last.
struct Rect {
    std::int32_t i0 = 0, j0 = 0, i1 = -1, j1 = -1;

    [[nodiscard]] bool empty() const { return i0 > i1 || j0 > j1; }
    friend bool operator==(const Rect&, const Rect&) = default;
};

[[nodiscard]] inline Rect intersection(const Rect& a, const Rect& b) {
    return {std::max(a.i0, b.i0), std::max(a.j0, b.j0), std::min(a.i1, b.i1), std::min(a.j1, b.j1)};
}

/// A linear function of the samples that is not negative on the inner side of an edge, ownership
/// included: the edge function, less 1 where the edge does not own its points, divided by the step
/// of the samples and rounded down. Its increments are multiples of the step before the division,
/// so the sign at every sample stays what it was.
struct EdgeFunction {
    std::int64_t at = 0;  ///< at sample (0, 0)
    std::int32_t per_column = 0, per_row = 0;

    EdgeFunction() = default;
    EdgeFunction(const ScreenPoint& p, const ScreenPoint& q, const SampleUnits& units)
        : per_column(p.y - q.y), per_row(q.x - p.x) {
        const std::int64_t own = is_top_left(per_row, -per_column) ? 0 : 1;
        at = (side(p.x, p.y, q.x, q.y, units.offset, units.offset) - own) >> units.step_bits;
    }

    // |per_column|, |per_row| < 2^24 and fewer than 2^21 samples a side: far below 2^63.
    [[nodiscard]] std::int64_t value(std::int32_t i, std::int32_t j) const {
        return at + std::int64_t{per_column} * i + std::int64_t{per_row} * j;
    }
    [[nodiscard]] std::int64_t least(const Rect& r) const {
        return value(per_column < 0 ? r.i1 : r.i0, per_row < 0 ? r.j1 : r.j0);
    }
    [[nodiscard]] std::int64_t greatest(const Rect& r) const {
        return value(per_column < 0 ? r.i0 : r.i1, per_row < 0 ? r.j0 : r.j1);
    }
};

/// Warnock's four kinds. Disjoint may be said only where no sample is covered, surrounding only
/// where all are; what is said to intersect may still cover none.
enum class Relation { disjoint, intersecting, contained, surrounding };

/// A triangle over the samples.
struct Shape {
    EdgeFunction edges[3];
    Rect box;  ///< samples between its extreme coordinates, inside of the picture

    Shape() = default;
    Shape(const OrientedTriangle& t, const Rect& samples, const SampleUnits& units)
        : edges{{t.p, t.q, units}, {t.q, t.r, units}, {t.r, t.p, units}}, box(samples) {}

    [[nodiscard]] Relation relation(const Rect& quadrant) const {
        const Rect r = intersection(box, quadrant);
        if (r.empty()) return Relation::disjoint;
        if (r == box && r != quadrant) return Relation::contained;
        bool all_inside = true;
        for (const EdgeFunction& edge : edges) {
            if (edge.greatest(r) < 0) return Relation::disjoint;
            all_inside &= edge.least(r) >= 0;
        }
        // A half-plane that holds the corners of a rectangle holds all of it.
        if (all_inside && r == quadrant) return Relation::surrounding;
        return r == box ? Relation::contained : Relation::intersecting;
    }
};

/// The samples inside of the picture that lie between the extreme coordinates of three corners.
[[nodiscard]] inline Rect box_of(const ScreenPoint& p, const ScreenPoint& q, const ScreenPoint& r,
                                 const SampleUnits& units) {
    return {std::max(units.first_from(std::min({p.x, q.x, r.x})), 0),
            std::max(units.first_from(std::min({p.y, q.y, r.y})), 0),
            std::min(units.last_until(std::max({p.x, q.x, r.x})), units.columns - 1),
            std::min(units.last_until(std::max({p.y, q.y, r.y})), units.rows - 1)};
}

/// Bounds of the depth of a plane over the samples of a rectangle: it is linear, so they are those
/// of two corners, less and more the error of the evaluation.
[[nodiscard]] inline double nearest_depth(const SampledPlane& s, const Rect& r) {
    return s.depth(s.gx < 0 ? r.i1 : r.i0, s.gy < 0 ? r.j1 : r.j0) - s.slack;
}
[[nodiscard]] inline double farthest_depth(const SampledPlane& s, const Rect& r) {
    return s.depth(s.gx < 0 ? r.i0 : r.i1, s.gy < 0 ? r.j0 : r.j1) + s.slack;
}

}  // namespace sightline::warnock
