#include "visibility/sampled_plane.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/predicates.hpp"

namespace sightline {

SampledPlane sampled_plane_of(const ScreenScene& screen, const SampleUnits& units,
                              std::uint32_t number) {
    SampledPlane s;  // every member is set below
    s.id = screen.id(number);
    s.shared = screen.shared_plane(s.id);
    const Plane plane = screen.plane(s.id);
    s.at_x = plane.at.x;
    s.at_y = plane.at.y;
    const double c = static_cast<double>(plane.c);
    const double x_slope = static_cast<double>(plane.a) / c,
                 y_slope = static_cast<double>(plane.b) / c;
    // The same quotients as depth_gradient(): one division serves both.
    s.stored = {static_cast<float>(x_slope), static_cast<float>(y_slope),
                static_cast<float>(plane.at.z)};
    s.gx = x_slope * units.step();
    s.gy = y_slope * units.step();
    const double rise_x = x_slope * (units.offset - plane.at.x);
    const double rise_y = y_slope * (units.offset - plane.at.y);
    s.z0 = plane.at.z + (rise_x + rise_y);
    constexpr double kUnit = 0x1p-53;
    s.slack = 8 * kUnit *
              (plane.at.z + std::abs(rise_x) + std::abs(rise_y) + std::abs(s.gx) * units.columns +
               std::abs(s.gy) * units.rows);
    return s;
}

bool DepthJudge::before_exactly(const SampledPlane& a, const SampledPlane& b, std::int32_t i,
                                std::int32_t j) {
    // One plane: a tie everywhere, which needs no arithmetic.
    if (a.id == b.id || (a.shared == b.shared && a.shared != kNone)) return a.id < b.id;
    ++exact;
    tell(StepKind::exact_comparison, a, b, i, j);
    const int order = compare_depth_exactly(screen_.plane(a.id), screen_.plane(b.id),
                                            units_.position(i), units_.position(j));
    return order != 0 ? order < 0 : a.id < b.id;
}

std::int32_t DepthJudge::crossing(const SampledPlane& a, const SampledPlane& b, std::int32_t first,
                                  std::int32_t last, std::int32_t j) {
    const double gap = b.depth(first, j) - a.depth(first, j);
    const double rest = a.depth(last, j) - b.depth(last, j);
    const double share = gap + rest > 0 ? gap / (gap + rest) : 0.5;
    std::int32_t low = first, high = last;  // a is before b at low, b before a at high
    // One division, then its neighbours: it is rarely off by more. Halving ends the search anyway.
    auto guess = first + static_cast<std::int32_t>(std::clamp(share, 0.0, 1.0) * (last - first));
    for (int probes = 0; high - low > 1; ++probes) {
        const std::int32_t i =
            probes < 3 ? std::clamp(guess, low + 1, high - 1) : low + (high - low) / 2;
        const bool still = before(a, b, i, j);
        (still ? low : high) = i;
        guess = still ? i + 1 : i - 1;
    }
    return high;
}

Stretch DepthJudge::part_before(const SampledPlane& a, const SampledPlane& b, Stretch stretch,
                                std::int32_t j) {
    const std::int32_t first = stretch.first, last = stretch.end - 1;
    const bool at_first = before(a, b, first, j);
    const bool at_last = last == first ? at_first : before(a, b, last, j);
    if (at_first == at_last) return {first, at_first ? stretch.end : first};
    if (at_first) return {first, crossing(a, b, first, last, j)};
    return {crossing(b, a, first, last, j), stretch.end};
}

void fill_run(const ScreenScene& screen, const SampleUnits& units, const SampledPlane& surface,
              std::int32_t j, std::int32_t first, std::int32_t end, std::uint32_t* ids,
              float* depth) {
    if (first >= end) return;
    std::fill(ids + first, ids + end, surface.id);
    const DepthGradient& g = surface.stored;
    const std::int32_t step = units.step();
    const std::int32_t dx0 = units.position(first) - surface.at_x;
    const std::int32_t dx1 = dx0 + (end - 1 - first) * step;
    const float ty = g.gy * static_cast<float>(units.position(j) - surface.at_y);
    // Rounding is monotone, so the ends of the run bound the rise of all its samples.
    const float rise = std::max(std::abs(g.gx * static_cast<float>(dx0)),
                                std::abs(g.gx * static_cast<float>(dx1)));
    if (rise + std::abs(ty) > kRegularRise) {
        const Plane plane = screen.plane(surface.id);
        for (std::int32_t i = first; i < end; ++i)
            depth[i] = stored_depth(plane, units.position(i), units.position(j));
        return;
    }
    for (std::int32_t i = first; i < end; ++i) {
        const float tx = g.gx * static_cast<float>(dx0 + (i - first) * step);
        depth[i] = std::clamp(g.z0 + (tx + ty), 0.0f, kStoredDepthMax);
    }
}

void fill_background(std::int32_t first, std::int32_t end, std::uint32_t* ids, float* depth) {
    if (first >= end) return;
    std::fill(ids + first, ids + end, kNone);
    std::fill(depth + first, depth + end, std::numeric_limits<float>::infinity());
}

}  // namespace sightline
