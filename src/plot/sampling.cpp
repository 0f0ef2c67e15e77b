// Functions on a grid: as many columns and rows as their curves need, and the places where they
// end.
//
// A grid keeps all surfaces of a plot on common nodes, which is what lets the floating horizon tell
// in one sweep who is in front. So sampling adapts by columns and rows: an interval is halved while
// the middle of any curve across it is off its chord by more than the tolerance. A jump does not
// get smaller by halving; it is left alone once it is a few pixels narrow, and its place is then
// found on each edge of the grid by bisection.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "math/arena.hpp"
#include "sightline/plot.hpp"

namespace sightline {
namespace {

using Function = std::function<double(double, double)>;

constexpr std::size_t kMostNodes = 2000;  // of an axis, beside those that fields bring along
constexpr std::size_t kFirstIntervals = 48;
constexpr std::size_t kWatchedCurves = 64;  // that decide about an interval, of each field
constexpr int kRounds = 10;
constexpr double kNarrowestSmooth = 0.25, kNarrowestBreak = 3;  // of an interval, in pixels
/// Halving leaves a quarter of the error of a smooth curve, half of it at a corner.
constexpr double kHardlyLess = 0.7;
constexpr int kBisections = 60;
/// An edge that rises by so many pixels is looked at for jumps.
constexpr double kSuspectJump = 3;

/// A field between the limits of the domain.
double height(const Function& field, const PlotDomain& domain, double x, double z) {
    const double y = field(x, z);
    return std::isfinite(y) && y >= domain.y.x && y <= domain.y.y ? y : NAN;
}

/// Pixels that a unit has at a point, across and up.
class PageScale {
public:
    explicit PageScale(const Camera& camera) : camera_(camera) {
        const double up = std::hypot(camera.right.y, camera.up.y);
        up_ = std::max(up, 0.05);
    }
    [[nodiscard]] double across(glm::dvec3 at) const {
        if (!camera_.is_perspective()) return camera_.pixels_per_unit();
        // What is beside the eye is as large as one likes; it is off the page for the most part.
        const double far = glm::length(at - camera_.eye), depth = camera_.depth_of(at);
        return camera_.pixels_per_unit() / std::max(depth, 0.2 * far + 1e-300);
    }
    [[nodiscard]] double up(glm::dvec3 at) const { return up_ * across(at); }

private:
    const Camera& camera_;
    double up_;
};

// -- columns and rows -----------------------------------------------------------------------------

struct Interval {
    double from, to;
    double error = INFINITY;  // of the interval that it is a half of
};

/// What decides whether an interval of one axis is halved.
struct Axis {
    bool is_x;
    std::vector<double> others;  // where it is looked at on the other axis
};

struct Error2 {
    double pixels = 0;      // off the chord
    bool is_break = false;  // something begins or ends
    double width = 0;       // of the interval
};

Error2 error_of(const Interval& interval, const Axis& axis, const std::vector<Function>& fields,
                const PlotDomain& domain, const PageScale& scale) {
    Error2 out;
    const double middle = 0.5 * (interval.from + interval.to);
    for (const Function& field : fields) {
        for (const double other : axis.others) {
            const auto at = [&](double here) {
                return axis.is_x ? height(field, domain, here, other)
                                 : height(field, domain, other, here);
            };
            const double a = at(interval.from), m = at(middle), b = at(interval.to);
            const bool all = !std::isnan(a + m + b);
            const bool none = std::isnan(a) && std::isnan(m) && std::isnan(b);
            if (none) continue;
            const glm::dvec3 place = axis.is_x ? glm::dvec3(middle, std::isnan(m) ? 0 : m, other)
                                               : glm::dvec3(other, std::isnan(m) ? 0 : m, middle);
            out.width = std::max(out.width, scale.across(place) * (interval.to - interval.from));
            out.is_break = out.is_break || !all;
            if (all)
                out.pixels = std::max(out.pixels, scale.up(place) * std::abs(m - 0.5 * (a + b)));
        }
    }
    return out;
}

bool needs_halving(const Interval& interval, const Error2& error, double tolerance) {
    if (error.width <= kNarrowestSmooth) return false;
    const bool wide = error.width > kNarrowestBreak;
    if (error.is_break && wide) return true;
    return error.pixels > tolerance && (wide || error.pixels < kHardlyLess * interval.error);
}

class Refiner {
public:
    Refiner(const std::vector<PlotField>& fields, const PlotDomain& domain, const Camera& camera,
            double tolerance, int threads)
        : fields_(fields),
          domain_(domain),
          scale_(camera),
          tolerance_(tolerance),
          threads_(threads) {}

    /// Halves the intervals between nodes as often as it is worth it for fields without nodes of
    /// their own.
    void refine(std::vector<double>& nodes, const Axis& axis) const {
        std::vector<Interval> open;
        for (std::size_t k = 0; k + 1 < nodes.size(); ++k)
            open.push_back({nodes[k], nodes[k + 1], INFINITY});
        const std::size_t most = std::max(kMostNodes, nodes.size());
        for (int round = 0; round < kRounds && !open.empty(); ++round) {
            const std::vector<Error2> errors = errors_of(open, axis);
            std::vector<Interval> next;
            for (std::size_t k = 0; k < open.size() && nodes.size() < most; ++k) {
                if (!needs_halving(open[k], errors[k], tolerance_)) continue;
                const double middle = 0.5 * (open[k].from + open[k].to);
                nodes.push_back(middle);
                next.push_back({open[k].from, middle, errors[k].pixels});
                next.push_back({middle, open[k].to, errors[k].pixels});
            }
            open = std::move(next);
        }
        std::sort(nodes.begin(), nodes.end());
    }

private:
    [[nodiscard]] std::vector<Error2> errors_of(const std::vector<Interval>& open,
                                                const Axis& axis) const {
        std::vector<Error2> errors(open.size());
        in_arena(threads_, [&] {
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, open.size(), 8),
                              [&](const tbb::blocked_range<std::size_t>& range) {
                                  std::vector<Function> own;
                                  for (const PlotField& field : fields_)
                                      if (field.x.empty()) own.push_back(field.make());
                                  for (std::size_t k = range.begin(); k != range.end(); ++k)
                                      errors[k] = error_of(open[k], axis, own, domain_, scale_);
                              });
        });
        return errors;
    }

    const std::vector<PlotField>& fields_;
    const PlotDomain& domain_;
    PageScale scale_;
    double tolerance_;
    int threads_;
};

/// About `most` of the nodes, evenly.
std::vector<double> some_of(const std::vector<double>& nodes, std::size_t most) {
    if (nodes.size() <= most) return nodes;
    std::vector<double> out;
    for (std::size_t k = 0; k < most; ++k)
        out.push_back(nodes[k * (nodes.size() - 1) / (most - 1)]);
    return out;
}

void add_places(std::vector<double>& nodes, glm::dvec2 range, const std::vector<double>& places) {
    for (const double place : places)
        if (place > range.x && place < range.y) nodes.push_back(place);
}

/// Sorted, and no two so near that a cell between them would be nothing.
void tidy(std::vector<double>& nodes, const std::vector<double>& keep) {
    std::sort(nodes.begin(), nodes.end());
    const double least = 1e-9 * (nodes.back() - nodes.front());
    std::vector<double> out = {nodes.front()};
    for (const double node : nodes) {
        if (node - out.back() > least) {
            out.push_back(node);
        } else if (std::binary_search(keep.begin(), keep.end(), node)) {
            out.back() = node;
        }
    }
    out.back() = std::max(out.back(), nodes.back());
    nodes = std::move(out);
}

// -- breaks ---------------------------------------------------------------------------------------

/// Finds where a field breaks on the way from one node to the next.
class Breaks {
public:
    Breaks(const Function& field, const PlotDomain& domain, const PageScale& scale)
        : field_(field), domain_(domain), scale_(scale) {}

    /// Whether there is a cut between a (with height ya) and b.
    bool find(glm::dvec2 a, double ya, glm::dvec2 b, double yb, Cut& cut) const {
        const bool has_a = !std::isnan(ya), has_b = !std::isnan(yb);
        if (!has_a && !has_b) return false;
        const auto at = [&](double t) {
            const glm::dvec2 p = a + t * (b - a);
            return height(field_, domain_, p.x, p.y);
        };
        cut.end0 = 0;
        cut.end1 = 1;
        cut.y0 = ya;
        cut.y1 = yb;
        if (has_a && has_b) return find_jump(at, a, cut);
        approach(at, has_a, cut);
        return true;
    }

private:
    /// From the end that has a height to the last place that has one.
    template <class At>
    static void approach(const At& at, bool from_first, Cut& cut) {
        double inside = from_first ? 0 : 1, outside = 1 - inside;
        double& y = from_first ? cut.y0 : cut.y1;
        for (int k = 0; k < kBisections; ++k) {
            const double middle = 0.5 * (inside + outside);
            const double there = at(middle);
            if (std::isnan(there)) {
                outside = middle;
            } else {
                inside = middle;
                y = there;
            }
        }
        (from_first ? cut.end0 : cut.end1) = inside;
        (from_first ? cut.end1 : cut.end0) = inside;
    }

    /// Follows the half that rises more: over a jump that half has all of it.
    template <class At>
    bool find_jump(const At& at, glm::dvec2 place, Cut& cut) const {
        const double rise = std::abs(cut.y1 - cut.y0);
        if (rise * scale_.up({place.x, cut.y0, place.y}) < kSuspectJump) return false;
        for (int k = 0; k < kBisections; ++k) {
            const double middle = 0.5 * (cut.end0 + cut.end1);
            const double y = at(middle);
            if (std::isnan(y)) return find_gap(at, middle, cut);
            if (std::abs(y - cut.y0) < std::abs(cut.y1 - y)) {
                cut.end0 = middle;
                cut.y0 = y;
            } else {
                cut.end1 = middle;
                cut.y1 = y;
            }
            // Smooth curves lose half of the rise each time, nearly.
            if (k == 5 && std::abs(cut.y1 - cut.y0) < 0.2 * rise) return false;
        }
        return std::abs(cut.y1 - cut.y0) > 0.2 * rise;
    }

    /// There is nothing at `middle`, between two places where there is something.
    template <class At>
    static bool find_gap(const At& at, double middle, Cut& cut) {
        const auto part = [&](double from, double to, Cut& out) {
            approach([&](double t) { return at(from + t * (to - from)); }, true, out);
            return from + out.end0 * (to - from);
        };
        Cut near = cut, far = cut;
        far.y0 = cut.y1;
        const double end0 = part(cut.end0, middle, near), end1 = part(cut.end1, middle, far);
        cut = {cut.edge, end0, end1, near.y0, far.y0};
        return true;
    }

    const Function& field_;
    const PlotDomain& domain_;
    const PageScale& scale_;
};

HeightLayer sample_layer(const HeightGrid& grid, const PlotField& field, const PlotDomain& domain,
                         const PageScale& scale, int threads) {
    HeightLayer layer;
    layer.open_gaps = field.open_gaps;
    const std::size_t columns = grid.x.size(), rows = grid.z.size();
    layer.y.resize(columns * rows);
    std::vector<std::vector<Cut>> cuts(rows);
    const auto each_row = [&](const auto& work) {
        in_arena(threads, [&] {
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows, 8),
                              [&](const tbb::blocked_range<std::size_t>& range) {
                                  const Function own = field.make();
                                  for (std::size_t k = range.begin(); k != range.end(); ++k)
                                      work(own, k);
                              });
        });
    };
    each_row([&](const Function& own, std::size_t k) {
        for (std::size_t i = 0; i < columns; ++i)
            layer.y[k * columns + i] = height(own, domain, grid.x[i], grid.z[k]);
    });
    if (!field.open_gaps) return layer;
    each_row([&](const Function& own, std::size_t k) {
        const Breaks breaks(own, domain, scale);
        for (std::size_t i = 0; i < columns; ++i) {
            const double* here = &layer.y[k * columns + i];
            const glm::dvec2 at(grid.x[i], grid.z[k]);
            Cut cut;
            cut.edge = grid.edge_along_x(i, k);
            if (i + 1 < columns && breaks.find(at, here[0], {grid.x[i + 1], at.y}, here[1], cut))
                cuts[k].push_back(cut);
            cut.edge = grid.edge_along_z(i, k);
            if (k + 1 < rows && breaks.find(at, here[0], {at.x, grid.z[k + 1]}, here[columns], cut))
                cuts[k].push_back(cut);
        }
    });
    for (const std::vector<Cut>& row : cuts)
        layer.cuts.insert(layer.cuts.end(), row.begin(), row.end());
    return layer;
}

/// Curves, and hatching between them, in ascending order.
struct Places {
    std::vector<double> at;
    std::vector<LineUse> use;
};

Places places_of(glm::dvec2 range, bool drawn, const PlotCurves& curves) {
    Places out;
    if (!drawn) return out;
    const std::uint32_t parts = curves.hatch ? 4 : 1;
    out.at = curve_places(range, parts * (curves.count - 1) + 1);
    for (std::uint32_t k = 0; k < out.at.size(); ++k) {
        out.use.push_back(k % parts == 0   ? LineUse::curve
                          : k % parts == 2 ? LineUse::half_shade
                                           : LineUse::full_shade);
    }
    return out;
}

std::vector<LineUse> uses(const std::vector<double>& nodes, const Places& places) {
    std::vector<LineUse> out(nodes.size(), LineUse::none);
    for (std::size_t k = 0; k < places.at.size(); ++k) {
        const auto found = std::lower_bound(nodes.begin(), nodes.end(), places.at[k]);
        if (found != nodes.end() && *found == places.at[k])
            out[static_cast<std::size_t>(found - nodes.begin())] = places.use[k];
    }
    return out;
}

}  // namespace

HeightGrid sample(const std::vector<PlotField>& fields, const PlotDomain& domain,
                  const PlotCurves& curves, const Camera& camera, double tolerance, int threads) {
    HeightGrid grid;
    const Places in_x = places_of(domain.x, curves.along_z, curves),
                 in_z = places_of(domain.z, curves.along_x, curves);
    const auto begin = [&](glm::dvec2 range, const Places& places, bool is_x) {
        const bool all_have_nodes =
            std::ranges::none_of(fields, [](const PlotField& field) { return field.x.empty(); });
        std::vector<double> nodes = curve_places(range, all_have_nodes ? 2 : kFirstIntervals + 1);
        nodes.insert(nodes.end(), places.at.begin(), places.at.end());
        for (const PlotField& field : fields) add_places(nodes, range, is_x ? field.x : field.z);
        tidy(nodes, places.at);
        return nodes;
    };
    grid.x = begin(domain.x, in_x, true);
    grid.z = begin(domain.z, in_z, false);
    const Refiner refiner(fields, domain, camera, tolerance, threads);
    refiner.refine(grid.x, {true, some_of(grid.z, kWatchedCurves)});
    refiner.refine(grid.z, {false, some_of(grid.x, kWatchedCurves)});
    refiner.refine(grid.x, {true, some_of(grid.z, kWatchedCurves)});
    grid.column_use = uses(grid.x, in_x);
    grid.row_use = uses(grid.z, in_z);
    const PageScale scale(camera);
    for (const PlotField& field : fields)
        grid.layers.push_back(sample_layer(grid, field, domain, scale, threads));
    return grid;
}

}  // namespace sightline
