// Functions and maps as fields, their range of heights, and maps as grids.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "sightline/plot.hpp"
#include "sightline/sections.hpp"

namespace sightline {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// The cell of ascending nodes that a place is in.
std::size_t cell_of(const std::vector<double>& nodes, double at) {
    const auto after = std::upper_bound(nodes.begin(), nodes.end(), at) - nodes.begin();
    return static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(after - 1, 0, static_cast<std::ptrdiff_t>(nodes.size()) - 2));
}

/// On the triangle of the map that a place is in; see HeightLayer.
double height_at(const HeightMap& map, double x, double z) {
    if (!(x >= map.x.front() && x <= map.x.back() && z >= map.z.front() && z <= map.z.back()))
        return kNothing;
    const std::size_t i = cell_of(map.x, x), k = cell_of(map.z, z);
    const double s = (x - map.x[i]) / (map.x[i + 1] - map.x[i]),
                 t = (z - map.z[k]) / (map.z[k + 1] - map.z[k]);
    const double* low = map.y.data() + k * map.x.size() + i;
    const double* high = low + map.x.size();
    // Nodes that have no share in it may be missing.
    const auto part = [](double share, double y) { return share > 0 ? share * y : 0.0; };
    if (s >= t) return part(1 - s, low[0]) + part(s - t, low[1]) + part(t, high[1]);
    return part(1 - t, low[0]) + part(t - s, high[0]) + part(s, high[1]);
}

// -- range ----------------------------------------------------------------------------------------

/// What a sample of a field shows.
struct Extremes {
    std::vector<double> heights;
    double low = INFINITY, high = -INFINITY;
    glm::dvec2 at_low{0, 0}, at_high{0, 0};
};

using Function = std::function<double(double, double)>;

Extremes extremes_of(const Function& field, const PlotDomain& domain) {
    constexpr int kSteps = 192;
    Extremes out;
    for (int k = 0; k <= kSteps; ++k) {
        for (int i = 0; i <= kSteps; ++i) {
            const double s = double(i) / kSteps, t = double(k) / kSteps;
            const glm::dvec2 at((1 - s) * domain.x.x + s * domain.x.y,
                                (1 - t) * domain.z.x + t * domain.z.y);
            const double y = field(at.x, at.y);
            if (!std::isfinite(y) || y < domain.y.x || y > domain.y.y) continue;
            out.heights.push_back(y);
            if (y < out.low) {
                out.low = y;
                out.at_low = at;
            }
            if (y > out.high) {
                out.high = y;
                out.at_high = at;
            }
        }
    }
    return out;
}

/// The greatest value of sign * field around a place, by looking ever closer. Near a pole it is
/// beyond everything.
double climbed(const Function& field, const PlotDomain& domain, glm::dvec2 at, double sign) {
    const auto value = [&](glm::dvec2 p) {
        const double y = sign * field(p.x, p.y);
        return std::isfinite(y) ? y : -INFINITY;
    };
    glm::dvec2 reach(0.01 * (domain.x.y - domain.x.x), 0.01 * (domain.z.y - domain.z.x));
    double best = value(at);
    for (int round = 0; round < 60; ++round, reach *= 0.7) {
        const glm::dvec2 centre = at;
        for (int k = -2; k <= 2; ++k) {
            for (int i = -2; i <= 2; ++i) {
                const glm::dvec2 p(
                    std::clamp(centre.x + 0.5 * i * reach.x, domain.x.x, domain.x.y),
                    std::clamp(centre.y + 0.5 * k * reach.y, domain.z.x, domain.z.y));
                const double y = value(p);
                if (y > best) {
                    best = y;
                    at = p;
                }
            }
        }
    }
    return best;
}

}  // namespace

PlotField field_of(const Formula& formula) {
    PlotField field;
    field.make = [shared = formula.value] {
        return Function([own = shared](double x, double z) mutable { return own({x, 0, z}); });
    };
    return field;
}

PlotField field_of(const HeightMap& map) {
    const auto shared = std::make_shared<const HeightMap>(map);
    PlotField field;
    field.make = [shared] {
        return Function([shared](double x, double z) { return height_at(*shared, x, z); });
    };
    field.x = shared->x;
    field.z = shared->z;
    field.open_gaps = false;
    return field;
}

Field field_of(const Expression& expression, std::string name) {
    return {[expression]() -> Evaluator {
                return [own = expression](glm::dvec3 at) mutable { return own(at); };
            },
            std::move(name)};
}

Result<glm::dvec2> height_range(const std::vector<PlotField>& fields, const PlotDomain& domain) {
    double low = INFINITY, high = -INFINITY;
    for (const PlotField& field : fields) {
        const Function function = field.make();
        Extremes found = extremes_of(function, domain);
        if (found.heights.empty()) continue;
        const auto share = [&](double part) {
            const auto at =
                found.heights.begin() +
                static_cast<std::ptrdiff_t>(part * static_cast<double>(found.heights.size() - 1));
            std::nth_element(found.heights.begin(), at, found.heights.end());
            return *at;
        };
        const double few = share(0.05), most = share(0.95), spread = most - few;
        // A field without limit exceeds what the sample has shown by far.
        const double size = std::max({found.high - found.low, spread, 1e-300});
        const double top = climbed(function, domain, found.at_high, 1),
                     bottom = -climbed(function, domain, found.at_low, -1);
        const double up = top > found.high + 3 * size ? most + spread : top,
                     down = bottom < found.low - 3 * size ? few - spread : bottom;
        low = std::min(low, std::max(down, domain.y.x));
        high = std::max(high, std::min(up, domain.y.y));
    }
    if (!(low <= high)) {
        return Error{ErrorKind::bad_input,
                     "there is no height anywhere; choose another --x, --z or --y"};
    }
    return glm::dvec2(low, high);
}

std::vector<double> curve_places(glm::dvec2 range, std::uint32_t count) {
    std::vector<double> out;
    for (std::uint32_t k = 0; k < count; ++k) {
        const double t = double(k) / double(count - 1);
        out.push_back((1 - t) * range.x + t * range.y);
    }
    return out;
}

namespace {

/// Marks the nodes nearest to where curves and hatching between them are wanted.
std::vector<LineUse> uses(const std::vector<double>& nodes, bool drawn, const PlotCurves& curves) {
    std::vector<LineUse> out(nodes.size(), LineUse::none);
    if (!drawn) return out;
    const auto last = static_cast<double>(nodes.size() - 1);
    const double step = last / static_cast<double>(curves.count - 1);
    const auto mark = [&](double at, LineUse use) {
        if (at > last) return;
        LineUse& there = out[static_cast<std::size_t>(std::round(at))];
        if (there == LineUse::none || use == LineUse::curve) there = use;
    };
    for (std::uint32_t k = 0; k < curves.count; ++k) {
        const double at = step * k;
        mark(at, LineUse::curve);
        if (!curves.hatch || k + 1 == curves.count) continue;
        mark(at + 0.5 * step, LineUse::half_shade);
        mark(at + 0.25 * step, LineUse::full_shade);
        mark(at + 0.75 * step, LineUse::full_shade);
    }
    return out;
}

}  // namespace

HeightGrid grid_of(HeightMap map, const PlotCurves& curves) {
    HeightGrid grid;
    grid.x = std::move(map.x);
    grid.z = std::move(map.z);
    grid.row_use = uses(grid.z, curves.along_x, curves);
    grid.column_use = uses(grid.x, curves.along_z, curves);
    HeightLayer layer;
    layer.y = std::move(map.y);
    layer.open_gaps = false;
    grid.layers.push_back(std::move(layer));
    return grid;
}

}  // namespace sightline
