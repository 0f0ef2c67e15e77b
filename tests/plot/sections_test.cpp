// Plots of implicit surfaces against rays through their fields.
#include "sightline/sections.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "plot/fields.hpp"
#include "plot/section_grid.hpp"
#include "plot/section_mesh.hpp"

namespace sightline {
namespace {

using namespace testing;

Camera view_of(const Box& box, glm::dvec3 direction, Projection projection) {
    CameraOptions options;
    options.direction = direction;
    options.projection = projection;
    return must(make_camera(options, box, {640, 480}));
}

SectionOptions sections_of(double half, int count) {
    SectionOptions options;
    options.box = cube(half);
    options.x_planes = options.z_planes = planes(half, count);
    options.hidden = true;
    return options;
}

Drawing draw(const std::vector<std::string>& texts, const Camera& camera,
             const SectionOptions& options) {
    std::vector<Field> fields;
    for (const std::string& text : texts) fields.push_back(field(text));
    return must(trace_sections(fields, camera, options));
}

// -- visibility -----------------------------------------------------------------------------------

double distance(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
    const glm::dvec2 way = b - a;
    const double t = std::clamp(glm::dot(p - a, way) / glm::dot(way, way), 0.0, 1.0);
    return glm::distance(p, a + t * way);
}

double distance(glm::dvec2 p, const DrawnLines& lines, bool visible) {
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if ((lines.visible[i] != 0) != visible || lines.kind[i] != EdgeKind::upper) continue;
        least = std::min(least, distance(p, lines.from[i], lines.to[i]));
    }
    return least;
}

double length_of(const DrawnLines& lines, EdgeKind kind, bool visible) {
    double sum = 0;
    for (std::size_t i = 0; i < lines.size(); ++i)
        if (lines.kind[i] == kind && (lines.visible[i] != 0) == visible)
            sum += glm::distance(lines.from[i], lines.to[i]);
    return sum;
}

enum class Seen { yes, no, unclear };

/// Follows the field from a point of the surface to the viewer, within the box.
Seen march(Evaluator& value, const Camera& camera, const Box& box, glm::dvec3 from) {
    constexpr double kStart = 0.01, kStep = 0.02, kClear = 0.005, kSlope = 0.2;
    const glm::dvec3 way = -glm::normalize(camera.view_vector(from));
    const double slope = (value(from + kStart * way) - value(from - kStart * way)) / (2 * kStart);
    if (std::abs(slope) < kSlope) return Seen::unclear;  // near the outline
    Seen seen = Seen::yes;
    for (double t = 4 * kStart;; t += kStep) {
        const glm::dvec3 p = from + t * way;
        if (glm::any(glm::lessThan(p, box.lo)) || glm::any(glm::greaterThan(p, box.hi)))
            return seen;
        const double f = value(p);
        if (std::abs(f) < kClear)
            seen = Seen::unclear;
        else if ((f > 0) != (slope > 0))
            return Seen::no;
    }
}

/// Compares the curves of a drawing with points of a mesh and rays from them.
void expect_rightly_hidden(const std::string& text, double half, glm::dvec3 direction,
                           Projection projection) {
    const Camera camera = view_of(cube(half), direction, projection);
    const SectionOptions options = sections_of(half, 9);
    const Drawing drawing = draw({text}, camera, options);
    const SectionPlanes sections(options.box, options.x_planes, options.z_planes);
    const SectionMesh mesh = must(mesh_of_field(field(text), grid_of(sections, 64), 0, {}));
    Evaluator value = field(text).make();
    double seen = 0, behind = 0, unclear = 0;
    std::size_t k = 0;
    for (const Corners& c : mesh.triangles) {
        for (int side = 0; side < 3; ++side) {
            const glm::dvec3 a = mesh.points[c[side]], b = mesh.points[c[(side + 1) % 3]];
            if (!sections.contain(a, b, mesh.points[c[(side + 2) % 3]])) continue;
            const double flat = std::abs(a.x == b.x ? a.x : a.z);
            const double length = (flat == half ? 2 : 1) *  // in one triangle, else in two
                                  glm::distance(camera.pixel_of(a), camera.pixel_of(b));
            const glm::dvec3 middle = 0.5 * (a + b);
            const Seen expected = march(value, camera, options.box, middle);
            (expected == Seen::unclear ? unclear : expected == Seen::yes ? seen : behind) += length;
            if (expected == Seen::unclear || ++k % 29 != 0) continue;
            ASSERT_LT(distance(camera.pixel_of(middle), drawing.lines, expected == Seen::yes), 0.25)
                << text << " at " << middle.x << ' ' << middle.y << ' ' << middle.z;
        }
    }
    ASSERT_GT(k, 500u);
    const double visible = length_of(drawing.lines, EdgeKind::upper, true);
    const double hidden = length_of(drawing.lines, EdgeKind::upper, false);
    const double all = seen + behind + unclear;
    EXPECT_NEAR(visible + hidden, all / 2, 0.005 * all) << text;
    EXPECT_GE(visible, 0.49 * seen) << text;
    EXPECT_GE(hidden, 0.49 * behind) << text;
    EXPECT_LT(unclear, 0.3 * all) << text;
}

TEST(SectionsVisibility, AgreesWithRays) {
    const std::string two = "min((x-0.8)^2 + y^2 + z^2, (x+0.8)^2 + y^2 + (z-0.5)^2) = 0.5";
    expect_rightly_hidden(kSphere, 1.2, {-1, -0.6, -1.2}, Projection::orthographic);
    expect_rightly_hidden(kTorus, 3, {-1, -0.6, -1.2}, Projection::perspective);
    expect_rightly_hidden(kTorus, 3, {-1, -0.1, 0.3}, Projection::orthographic);
    expect_rightly_hidden(two, 1.8, {-1, -0.4, 0.2}, Projection::perspective);
    expect_rightly_hidden("x^2*z^2 + y^2 = 1", 2, {-0.5, -0.6, -1.2}, Projection::perspective);
}

TEST(SectionsVisibility, HalfOfASphereIsSeen) {
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
        const Camera camera = view_of(cube(1.2), {-1, -0.6, -1.2}, projection);
        const Drawing drawing = draw({kSphere}, camera, sections_of(1.2, 9));
        double seen = 0;
        constexpr int kSteps = 2000;
        for (const double at : planes(1.2, 9)) {
            if (std::abs(at) >= 1) continue;
            for (int family = 0; family < 2; ++family) {
                const auto point = [&](int k) {
                    const double angle = 2 * std::numbers::pi * k / kSteps;
                    const double r = std::sqrt(1 - at * at);
                    const double u = r * std::cos(angle), v = r * std::sin(angle);
                    return family == 0 ? glm::dvec3(at, u, v) : glm::dvec3(u, v, at);
                };
                for (int k = 0; k < kSteps; ++k) {
                    const glm::dvec3 p = point(k);
                    if (glm::dot(p, camera.view_vector(p)) < 0)
                        seen += glm::distance(camera.pixel_of(p), camera.pixel_of(point(k + 1)));
                }
            }
        }
        EXPECT_NEAR(length_of(drawing.lines, EdgeKind::upper, true), seen, 0.01 * seen);
    }
}

TEST(SectionsVisibility, DrawingsDoNotDependOnThreads) {
    const Camera camera = view_of(cube(3), {-1, -0.6, -1.2}, Projection::perspective);
    SectionOptions options = sections_of(3, 9);
    options.threads = 1;
    const Drawing one = draw({kTorus, "y = x/3"}, camera, options);
    options.threads = 8;
    const Drawing many = draw({kTorus, "y = x/3"}, camera, options);
    EXPECT_EQ(one.lines.from, many.lines.from);
    EXPECT_EQ(one.lines.to, many.lines.to);
    EXPECT_EQ(one.lines.kind, many.lines.kind);
    EXPECT_EQ(one.lines.visible, many.lines.visible);
    EXPECT_EQ(one.lines.object, many.lines.object);
}

// -- other lines ----------------------------------------------------------------------------------

TEST(SectionsLines, OutlineOfASphere) {
    // The view is along no axis of the grid, and then along one: there a section is the outline.
    const Camera camera = view_of(cube(1.2), {-1, -0.6, -1.2}, Projection::orthographic);
    const double pixels = camera.pixels_per_unit();
    const Drawing drawing = draw({kSphere}, camera, sections_of(1.2, 9));
    const glm::dvec2 centre = camera.pixel_of({0, 0, 0});
    for (std::size_t i = 0; i < drawing.lines.size(); ++i) {
        if (drawing.lines.kind[i] != EdgeKind::outline) continue;
        ASSERT_NEAR(glm::distance(drawing.lines.from[i], centre), pixels, 0.02);
        ASSERT_EQ(drawing.lines.visible[i], 1);
        ASSERT_EQ(drawing.lines.object[i], 0u);
        ASSERT_EQ(drawing.lines.polygons[i], glm::uvec2(kNone));
    }
    EXPECT_NEAR(length_of(drawing.lines, EdgeKind::outline, true), 2 * std::numbers::pi * pixels,
                0.002 * pixels);
    SectionOptions none = sections_of(1.2, 9);
    none.outline = false;
    EXPECT_EQ(length_of(draw({kSphere}, camera, none).lines, EdgeKind::outline, true), 0);
    const Camera front = view_of(cube(1.2), {0, 0, -1}, Projection::orthographic);
    const Drawing flat = draw({kSphere}, front, sections_of(1.2, 9));
    EXPECT_EQ(length_of(flat.lines, EdgeKind::outline, true), 0);
}

TEST(SectionsLines, AxesAreHiddenBySurfaces) {
    const Camera camera = view_of(cube(2), {0, 0, -1}, Projection::orthographic);
    SectionOptions options = sections_of(2, 5);
    options.axes = {{glm::dvec3(-2, 0.1, 0), glm::dvec3(2, 0.1, 0)},      // through the sphere
                    {glm::dvec3(-2, 0.2, 1.5), glm::dvec3(2, 0.2, 1.5)},  // in front of it
                    {glm::dvec3(-2, 1.5, 0), glm::dvec3(2, 1.5, 0)}};     // above it
    const Drawing drawing = draw({kSphere}, camera, options);
    const double hidden = 2 * std::sqrt(1 - 0.01) * camera.pixels_per_unit();
    EXPECT_NEAR(length_of(drawing.lines, EdgeKind::axis, false), hidden, 0.3);
    EXPECT_NEAR(length_of(drawing.lines, EdgeKind::axis, true),
                12 * camera.pixels_per_unit() - hidden, 0.3);
    for (std::size_t i = 0; i < drawing.lines.size(); ++i)
        if (drawing.lines.kind[i] == EdgeKind::axis) {
            ASSERT_EQ(drawing.lines.object[i], 1u);
        }
    // Also when there is nothing else.
    const Drawing alone = draw({"1 + 0*x"}, camera, options);
    EXPECT_EQ(alone.lines.size(), 3u);
}

TEST(SectionsLines, CrossingSpheres) {
    const Camera camera = view_of(cube(1.6), {-1, -0.6, -0.4}, Projection::orthographic);
    SectionOptions options = sections_of(1.6, 8);
    const Drawing drawing =
        draw({"(x-0.5)^2 + y^2 + z^2 = 1", "(x+0.5)^2 + y^2 + z^2 = 1"}, camera, options);
    const double radius = std::sqrt(0.75);
    double perimeter = 0, half = 0;
    for (int k = 0; k < 3600; ++k) {
        const auto point = [&](int at) {
            const double angle = std::numbers::pi * at / 1800;
            return glm::dvec3(0, radius * std::cos(angle), radius * std::sin(angle));
        };
        const double step = glm::distance(camera.pixel_of(point(k)), camera.pixel_of(point(k + 1)));
        const glm::dvec3 p = point(k), view = camera.view_vector(p);
        perimeter += step;
        if (glm::dot(p - glm::dvec3(0.5, 0, 0), view) < 0 &&
            glm::dot(p + glm::dvec3(0.5, 0, 0), view) < 0)
            half += step;
    }
    EXPECT_NEAR(length_of(drawing.lines, EdgeKind::intersection, true), half, 0.015 * perimeter);
    EXPECT_NEAR(length_of(drawing.lines, EdgeKind::intersection, false), perimeter - half,
                0.015 * perimeter);
}

TEST(SectionsLines, BordersAtTheBox) {
    const Camera camera = view_of(cube(1), {-1, -0.6, -1.2}, Projection::orthographic);
    SectionOptions options = sections_of(1, 5);
    const Drawing without = draw({"y = 2*x"}, camera, options);
    EXPECT_EQ(length_of(without.lines, EdgeKind::boundary, true), 0);
    options.boundary = true;
    const Drawing with = draw({"y = 2*x"}, camera, options);
    const double side = glm::distance(camera.pixel_of({0.5, 1, -1}), camera.pixel_of({0.5, 1, 1}));
    EXPECT_NEAR(length_of(with.lines, EdgeKind::boundary, true), 2 * side, 0.1);
    EXPECT_NEAR(length_of(with.lines, EdgeKind::upper, true),
                length_of(without.lines, EdgeKind::upper, true), 0.1);
}

// -- what people type -----------------------------------------------------------------------------

TEST(SectionsInput, HostileFormulas) {
    const Camera camera = view_of(cube(1), {-1, -0.6, -1.2}, Projection::perspective);
    SectionOptions options = sections_of(1, 3);
    options.hidden = false;
    for (const std::string text :
         {"1 + 0*x", "0*x", "sqrt(0 - 1 - x^2)", "1e300 * 1e300 * x", "1e300 * x * 1e300 * y",
          "1e300 * (x + y)", "exp(1000 * x) - y", "1e-300 * x", "1e-200 * x * 1e-200", "sign(x)",
          "x > 0 ? 1 : 0 - 1", "sin(1e9 * x)", "1 / (x*y*z)", "ln(x) * ln(y)", "x^2 + y^2 + z^2"}) {
        const Field one[] = {field(text)};
        EXPECT_TRUE(trace_sections(one, camera, options).ok()) << text;
    }
    for (const std::string text : {"1e300 * 1e300 * x", "1e300 * (x + y)", "sign(x)", "ln(y)"}) {
        const auto range = find_y_range(field(text), {-1, 1}, {-1, 1});
        if (range.ok()) {
            EXPECT_LT(range->x, range->y) << text;
        }
    }
    EXPECT_TRUE(trace_sections({}, camera, options).ok());
}

TEST(SectionsInput, WrongOptions) {
    const Camera camera = view_of(cube(1), {-1, -0.6, -1.2}, Projection::perspective);
    const std::vector<Field> fields = {field(kSphere)};
    const auto kind_of = [&](const auto& change) {
        SectionOptions options = sections_of(1, 3);
        change(options);
        const auto drawing = trace_sections(fields, camera, options);
        return drawing.ok() ? "fine" : drawing.error().message;
    };
    EXPECT_NE(kind_of([](auto& o) { o.box = {}; }).find("the box of the plot"), std::string::npos);
    EXPECT_NE(kind_of([](auto& o) { o.box.hi.y = NAN; }).find("the box"), std::string::npos);
    EXPECT_NE(kind_of([](auto& o) { o.tolerance = 0; }).find("tolerance"), std::string::npos);
    EXPECT_NE(kind_of([](auto& o) { o.x_planes.resize(2000); }).find("2000"), std::string::npos);
    EXPECT_NE(kind_of([](auto& o) { o.progress = [](double) { return false; }; }).find("stopped"),
              std::string::npos);
    // Planes that are outside, twice there or no numbers do no harm.
    EXPECT_EQ(kind_of([](auto& o) { o.x_planes = {5, NAN, 0.5, 0.5, -1, -7, HUGE_VAL}; }), "fine");
}

}  // namespace
}  // namespace sightline
