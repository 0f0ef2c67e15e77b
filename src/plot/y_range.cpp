// A surface has points where the field changes its sign between neighbours on a grid. Growing
// ranges of y are looked at until what is found stops growing; a root between the highest two nodes
// of a column then says how high it reaches there, and the range grows by margins until the surface
// does not cross its end.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "plot/root.hpp"
#include "sightline/sections.hpp"

namespace sightline {
namespace {

constexpr double kMargin = 1.0 / 32;  // of what was found

/// Nodes of the search on x and z, and on y, and the ranges that are looked at: when a surface
/// grows with every doubling, it counts as endless.
struct Sampling {
    int columns = 0, levels = 0;
    int smaller = 0, doublings = 0;
};
constexpr Sampling kCoarse{33, 65, 5, 16}, kFine{97, 193, 0, 1};

double at(glm::dvec2 range, int k, int n) { return range.x + (range.y - range.x) * k / (n - 1); }

struct Extent {
    double lo = HUGE_VAL, hi = -HUGE_VAL;

    [[nodiscard]] bool empty() const { return !(lo <= hi); }
    void add(double y) {
        lo = std::min(lo, y);
        hi = std::max(hi, y);
    }
};

class RangeFinder {
public:
    RangeFinder(const Field& field, glm::dvec2 x, glm::dvec2 z)
        : value_(field.make()), x_(x), z_(z), side_(0.5 * std::max(x.y - x.x, z.y - z.x)) {}

    std::optional<glm::dvec2> find() {
        for (const Sampling sampling : {kCoarse, kFine}) {
            const std::optional<Extent> found = grow(sampling);
            if (!found) return glm::dvec2(-side_, side_);
            if (!found->empty()) return with_margins(*found);
        }
        return std::nullopt;
    }

private:
    /// Nothing: it has no end.
    std::optional<Extent> grow(Sampling sampling) {
        // First within a cube; where there is nothing, in smaller and larger ones.
        double half = side_;
        Extent extent = search(half, sampling);
        for (int k = 1; k <= sampling.smaller && extent.empty(); ++k)
            extent = search(half = std::ldexp(side_, -4 * k), sampling);
        if (extent.empty()) half = side_;
        for (int k = 0; k < sampling.doublings; ++k) {
            half *= 2;
            Extent next = search(half, sampling);
            if (next.empty()) {
                if (!extent.empty()) return extent;
                continue;
            }
            // What is found with longer steps is no longer as exact.
            const double step = 2 * half / (sampling.levels - 1);
            const bool grown =
                extent.empty() || next.hi > extent.hi + step || next.lo < extent.lo - step;
            if (!grown) return extent;
            extent = next;
        }
        if (extent.empty()) return extent;
        return std::nullopt;
    }

    /// Where signs change on the edges of the grid within -half..half.
    Extent search(double half, Sampling sampling) {
        const int n = sampling.columns;
        Extent extent;
        noise_ = kNoise * usual_size(value_, {x_.x, -half, z_.x}, {x_.y, half, z_.y});
        std::vector<double> below, level(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
        for (int j = 0; j < sampling.levels; ++j) {
            const double y = at({-half, half}, j, sampling.levels);
            for (int k = 0; k < n; ++k)
                for (int i = 0; i < n; ++i)
                    level[index(i, k, n)] = value_({at(x_, i, n), y, at(z_, k, n)});
            if (crosses(level, y, n)) extent.add(y);
            if (!below.empty()) {
                const double before = at({-half, half}, j - 1, sampling.levels);
                add_roots(below, level, before, y, n, extent);
            }
            below = level;
        }
        return extent;
    }
    static std::size_t index(int i, int k, int n) {
        return static_cast<std::size_t>(k) * static_cast<std::size_t>(n) +
               static_cast<std::size_t>(i);
    }
    static bool differ(double a, double b) {
        return std::isfinite(a) && std::isfinite(b) && (a >= 0) != (b >= 0);
    }

    /// Whether the surface passes through a level.
    bool crosses(const std::vector<double>& level, double y, int n) {
        const auto root = [&](int i, int k, int i2, int k2) {
            const double a = level[index(i, k, n)], b = level[index(i2, k2, n)];
            if (!differ(a, b)) return false;
            return find_root(
                       value_,
                       {{at(x_, i, n), y, at(z_, k, n)}, {at(x_, i2, n), y, at(z_, k2, n)}, a, b},
                       noise_)
                .has_value();
        };
        for (int k = 0; k < n; ++k)
            for (int i = 0; i < n; ++i)
                if ((i + 1 < n && root(i, k, i + 1, k)) || (k + 1 < n && root(i, k, i, k + 1)))
                    return true;
        return false;
    }

    /// The roots between two levels. Only those that can make the extent larger are computed.
    void add_roots(const std::vector<double>& low, const std::vector<double>& high, double y0,
                   double y1, int n, Extent& extent) {
        for (int k = 0; k < n; ++k) {
            for (int i = 0; i < n; ++i) {
                const double a = low[index(i, k, n)], b = high[index(i, k, n)];
                if (!differ(a, b) || (extent.lo <= y0 && extent.hi >= y1)) continue;
                const double x = at(x_, i, n), z = at(z_, k, n);
                const auto t = find_root(value_, {{x, y0, z}, {x, y1, z}, a, b}, noise_);
                if (t) extent.add(y0 + *t * (y1 - y0));
            }
        }
    }

    /// A top between the columns is higher than what they say.
    glm::dvec2 with_margins(Extent extent) {
        constexpr int kColumns = 129, kRounds = 8;
        double step = kMargin * (extent.hi - extent.lo);
        if (!(step > 0)) step = kMargin * std::max(side_, std::abs(extent.hi));
        std::vector<double> level(std::size_t{kColumns} * kColumns);
        const auto passes = [&](double y) {
            for (int k = 0; k < kColumns; ++k)
                for (int i = 0; i < kColumns; ++i)
                    level[index(i, k, kColumns)] =
                        value_({at(x_, i, kColumns), y, at(z_, k, kColumns)});
            return crosses(level, y, kColumns);
        };
        extent.lo -= step;
        extent.hi += step;
        for (int k = 0; k < kRounds && passes(extent.lo); ++k) extent.lo -= step;
        for (int k = 0; k < kRounds && passes(extent.hi); ++k) extent.hi += step;
        return {extent.lo, extent.hi};
    }

    Evaluator value_;
    glm::dvec2 x_, z_;
    double side_;  // half of the larger extent
    double noise_ = 0;
};

}  // namespace

Result<glm::dvec2> find_y_range(const Field& field, glm::dvec2 x, glm::dvec2 z) {
    if (const std::optional<glm::dvec2> found = RangeFinder(field, x, z).find()) return *found;
    return Error{
        ErrorKind::bad_input,
        fmt::format("'{}' has no points over x {:g}..{:g}, z {:g}..{:g}; give other ranges "
                    "with --x and --z, or say where it is with --y",
                    field.name, x.x, x.y, z.x, z.y)};
}

}  // namespace sightline
