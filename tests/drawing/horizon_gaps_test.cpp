// Functions with holes, ends and jumps, through which one can look: against lines of sight that are
// followed step by step through the function itself.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <span>

#include "drawing/pages.hpp"
#include "sightline/plot.hpp"

namespace sightline {
namespace {

using Function = std::function<double(double, double)>;

/// Along a line of sight, the height above the surface.
struct Sight {
    const Function& height;
    const PlotDomain& domain;
    glm::dvec3 from, way;

    [[nodiscard]] double above(double t) const {
        const glm::dvec3 p = from + t * way;
        if (p.x < domain.x.x || p.x > domain.x.y || p.z < domain.z.x || p.z > domain.z.y)
            return NAN;
        const double y = height(p.x, p.z);
        return y < domain.y.x || y > domain.y.y ? NAN : p.y - y;
    }
    /// Whether it goes through the surface between two places, or only past an end or a jump.
    [[nodiscard]] bool pierces(double t0, double t1) const {
        const double a = above(t0), b = above(t1);
        if (!(a * b < 0)) return false;
        double low = t0, high = t1, last = a;
        for (int k = 0; k < 50; ++k) {
            const double middle = 0.5 * (low + high), m = above(middle);
            if (std::isnan(m)) return false;
            last = m;
            (m * a > 0 ? low : high) = middle;
        }
        return std::abs(last) < 1e-6;
    }
};

/// 1 hidden, 0 seen, -1 too close to tell.
int is_hidden(const Function& height, const PlotDomain& domain, glm::dvec3 p, glm::dvec3 way) {
    const Sight sight{height, domain, p, way};
    constexpr double kStep = 0.01, kBegin = 0.05, kClose = 0.03, kCloseToEnd = 0.2;
    bool close = false;
    for (double t = kBegin; t < 40; t += kStep) {
        if (sight.pierces(t, t + kStep)) return 1;
        const double above = sight.above(t);
        close = close || std::abs(above) < kClose;
        // Just beside an end one can't say on which side it is passed.
        const double next = sight.above(t + kStep);
        if (std::isnan(above) != std::isnan(next))
            close = close || std::abs(std::isnan(above) ? next : above) < kCloseToEnd;
    }
    return close ? -1 : 0;
}

struct Tally {
    int right = 0, wrong = 0;
};

/// The parts of curves of constant z that are long enough, at their middles.
Tally tally(const char* formula, const Camera& camera, const PlotDomain& domain) {
    const PlotField field = field_of(testing::must(parse_formula(formula)));
    PlotCurves curves;
    curves.count = 24;  // none of them on a jump
    const HeightGrid grid = sample({field}, domain, curves, camera, 0.02);
    PlotOptions options;
    options.hidden = true;
    const Drawing drawing = testing::must(floating_horizon(grid, camera, options));
    const std::vector<double> places = curve_places(domain.z, curves.count);
    const Function height = field.make();
    const glm::dvec3 way = -glm::normalize(camera.view_vector(camera.target));
    const glm::dvec2 zero = camera.pixel_of({0, 0, 0}), x = camera.pixel_of({1, 0, 0}) - zero,
                     y = camera.pixel_of({0, 1, 0}) - zero, z = camera.pixel_of({0, 0, 1}) - zero;
    Tally out;
    const std::size_t every = testing::amount(1, 5, 8);
    for (std::size_t k = 0; k < drawing.lines.size(); k += every) {
        const glm::dvec2 a = drawing.lines.from[k], b = drawing.lines.to[k];
        if (glm::length(b - a) < 4) continue;
        // In the curve's plane a point of the page is one of space.
        const double at_z = places[drawing.lines.polygons[k].x];
        const glm::dvec2 page = 0.5 * (a + b) - zero - at_z * z;
        const double at_x = (page.x * y.y - page.y * y.x) / (x.x * y.y - x.y * y.x);
        const glm::dvec3 p(at_x, height(at_x, at_z), at_z);
        if (std::isnan(p.y) || glm::length(camera.pixel_of(p) - 0.5 * (a + b)) > 0.5) continue;
        const int hidden = is_hidden(height, domain, p, way);
        if (hidden < 0) continue;
        ++((hidden == 1) == (drawing.lines.visible[k] == 0) ? out.right : out.wrong);
    }
    return out;
}

TEST(HorizonGaps, OneLooksThroughHolesAndJumps) {
    const char* const formulas[] = {
        "y = 2*floor((x + z)/4)",                     // jumps aslant
        "y = sqrt(30 - x^2 - z^2)",                   // ends
        "y = sqrt(x^2 + z^2 - 9) - 3",                // a hole
        "y = 2*floor(z/3)",                           // jumps across the view
        "y = 1/(x - 0.5*z)",                          // a pole
        "y = x^2 + z^2 < 16 ? 3*cos(x/2) : 0.1*x*z",  // an island
        "y = sqrt(sin(x)*cos(z)) * 3",                // many pieces
    };
    PlotDomain domain;
    domain.x = domain.z = {-8, 8};
    domain.y = {-6, 6};
    const Box box{{-8, -6, -8}, {8, 6, 8}};
    // Under the sanitizers one formula will do, else few views of each.
    const std::size_t some = testing::amount(std::size(formulas), std::size(formulas), 1);
    for (const char* formula : std::span(formulas).first(some)) {
        Tally all;
        const glm::dvec3 directions[] = {{0.6, -0.4, -1}, {-0.3, 0.3, -1}, {1, -0.5, 0.1},
                                         {0, -0.4, -1},   {0.2, -1.5, -1}, {0, -0.1, 1}};
        for (const glm::dvec3 direction :
             std::span(directions).first(testing::amount(std::size(directions), 2, 1))) {
            CameraOptions options;
            options.projection = Projection::orthographic;
            options.direction = direction;
            const Camera camera = testing::must(make_camera(options, box, {1024, 768}));
            const Tally one = tally(formula, camera, domain);
            all.right += one.right;
            all.wrong += one.wrong;
        }
        // Where a slope is steeper than chords follow, near a vertical end, a few are off.
        EXPECT_LE(200 * all.wrong, all.right) << formula << ": " << all.wrong << " wrong";
        EXPECT_GE(all.right, 5) << formula;
    }
}

}  // namespace
}  // namespace sightline
