// Brute force: the trivial image-precision algorithm, and the oracle of every test.
//
// Source: Foley, van Dam, Feiner, Hughes, "Computer Graphics: Principles and Practice", 2nd ed.,
// section 15.1: for each pixel, determine the object closest to the viewer.
//
// How this version differs: at each sample every triangle is asked, in integers only: is the sample
// covered (top-left rule), and is the depth, a rational number, smaller than that of the best so
// far (or equal, with a lower id). Then every quadric is asked for its z. No approximation, no
// cleverness that could be wrong. The one liberty: triangles that do not reach a row of samples are
// not asked again at each sample of it.
// Time O(rows * triangles + samples * triangles of the row), memory O(triangles) a thread.
#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "math/predicates.hpp"
#include "visibility/algorithms.hpp"
#include "visibility/parallel.hpp"
#include "visibility/quadrics.hpp"

namespace sightline {

namespace {

struct Candidate {
    OrientedTriangle triangle;
    std::int32_t x_min, x_max;
    std::uint32_t id;
};

std::vector<Candidate> triangles_of_row(const ScreenScene& screen, std::int32_t y) {
    std::vector<Candidate> row;
    for (std::uint32_t k = 0; k < screen.triangle_count(); ++k) {
        const Corners c = screen.corners(k);
        const ScreenPoint p = screen.point(c.x), q = screen.point(c.y), r = screen.point(c.z);
        if (std::min({p.y, q.y, r.y}) > y || std::max({p.y, q.y, r.y}) < y) continue;
        if (!screen.drawable(k)) continue;
        row.push_back({OrientedTriangle(p, q, r), std::min({p.x, q.x, r.x}),
                       std::max({p.x, q.x, r.x}), screen.id(k)});
    }
    return row;
}

// Nearer in exact depth, or equally near with the lower id.
bool comes_before(const ScreenScene& screen, std::uint32_t a, std::uint32_t b, std::int32_t x,
                  std::int32_t y) {
    const int order = compare_depth_exactly(screen.plane(a), screen.plane(b), x, y);
    return order != 0 ? order < 0 : a < b;
}

std::uint32_t nearest_at(const ScreenScene& screen, const std::vector<Candidate>& row,
                         std::int32_t x, std::int32_t y, std::uint64_t& comparisons) {
    std::uint32_t best = kNone;
    for (const Candidate& candidate : row) {
        if (x < candidate.x_min || x > candidate.x_max) continue;
        if (!covers(candidate.triangle, x, y) || candidate.id == best) continue;
        if (best != kNone) ++comparisons;
        if (best == kNone || comes_before(screen, candidate.id, best, x, y)) best = candidate.id;
    }
    return best;
}

/// The winner at a sample, and its depth.
struct Winner {
    std::uint32_t id = kNone;
    float depth = std::numeric_limits<float>::infinity();
};

Winner winner_at(const ScreenScene& screen, std::uint32_t triangle, std::int32_t x,
                 std::int32_t y) {
    const auto quadric = nearest_quadric(screen, x, y);
    if (triangle == kNone)
        return quadric ? Winner{quadric->id, static_cast<float>(quadric->z)} : Winner{};
    const Plane plane = screen.plane(triangle);
    if (quadric && is_before_triangle(quadric->z, plane, x, y))
        return {quadric->id, static_cast<float>(quadric->z)};
    return {triangle, stored_depth(plane, x, y)};
}

}  // namespace

void resolve_brute(const ScreenScene& screen, const ResolveOptions& options, Visibility& out) {
    const SampleGrid grid = out.grid;
    const std::int32_t step = grid.step(screen.subpixel_bits());
    const std::int32_t offset = grid.offset(screen.subpixel_bits());
    std::vector<std::uint64_t> comparisons(grid.rows(), 0);

    for_each_index(grid.rows(), options, [&](std::uint32_t j) {
        const std::int32_t y = offset + static_cast<std::int32_t>(j) * step;
        const std::vector<Candidate> row = triangles_of_row(screen, y);
        for (std::uint32_t i = 0; i < grid.columns(); ++i) {
            const std::int32_t x = offset + static_cast<std::int32_t>(i) * step;
            const std::uint32_t triangle = nearest_at(screen, row, x, y, comparisons[j]);
            const auto [id, depth] = winner_at(screen, triangle, x, y);
            const std::size_t at = std::size_t{j} * grid.columns() + i;
            out.ids[at] = id;
            out.depth[at] = depth;
            if (options.observer != nullptr)
                options.observer->step({StepKind::sample_decided, id, kNone, i, j, i + 1, j + 1});
        }
    });

    std::uint64_t total = 0;
    for (const std::uint64_t count : comparisons) total += count;
    count(options, "samples decided", grid.count());
    count(options, "exact comparisons", total);
}

}  // namespace sightline
