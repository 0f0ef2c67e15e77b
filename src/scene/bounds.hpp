// Boxes around many points.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <cstdint>
#include <glm/common.hpp>
#include <limits>

#include "sightline/scene.hpp"

namespace sightline {

/// The box around point(0) .. point(count - 1), on all cores.
template <class Point>
Box bounds_of_points(std::uint32_t count, const Point& point) {
    struct Extent {
        glm::dvec3 lo{std::numeric_limits<double>::infinity()};
        glm::dvec3 hi{-std::numeric_limits<double>::infinity()};
    };
    if (count == 0) return {};
    using Range = tbb::blocked_range<std::uint32_t>;
    const Extent extent = tbb::parallel_reduce(
        Range(0, count, 4096), Extent{},
        [&](const Range& range, Extent partial) {
            for (std::uint32_t i = range.begin(); i != range.end(); ++i) {
                const glm::dvec3& p = point(i);
                partial = {glm::min(partial.lo, p), glm::max(partial.hi, p)};
            }
            return partial;
        },
        [](const Extent& a, const Extent& b) {
            return Extent{glm::min(a.lo, b.lo), glm::max(a.hi, b.hi)};
        });
    // -0 becomes +0: which zero a minimum keeps depends on the order.
    return {extent.lo + 0.0, extent.hi + 0.0};
}

/// The smallest box around both.
[[nodiscard]] inline Box joined(const Box& a, const Box& b) {
    if (a.empty()) return b;
    if (b.empty()) return a;
    return {glm::min(a.lo, b.lo), glm::max(a.hi, b.hi)};
}

}  // namespace sightline
