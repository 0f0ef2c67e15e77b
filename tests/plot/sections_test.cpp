// Plots of implicit surfaces: meshes against geometry, drawings against rays through the field.
#include "plot/sections.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>

#include "plot/section_grid.hpp"
#include "plot/section_mesh.hpp"
#include "plot/y_range.hpp"
#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

/// Of an equation, or of an expression in x, y and z.
Field field(const std::string& text) {
    if (text.find('=') == std::string::npos) return field_of(must(Expression::parse(text)), text);
    return field_of(must(parse_formula(text)).value, text);
}

const std::string kSphere = "x^2 + y^2 + z^2 = 1";
const std::string kTorus = "(sqrt(x^2 + z^2) - 2)^2 + y^2 = 0.5";

Box cube(double half) { return {glm::dvec3(-half), glm::dvec3(half)}; }

std::vector<double> planes(double half, int count) {
    std::vector<double> at;
    for (int k = 0; k < count; ++k) at.push_back(half * (2.0 * k / (count - 1) - 1));
    return at;
}

SectionMesh mesh_of(const std::string& text, double half, std::size_t cells, int threads = 0) {
    const SectionPlanes sections(cube(half), planes(half, 9), planes(half, 9));
    return must(mesh_of_field(field(text), grid_of(sections, cells), threads, {}));
}

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

// -- meshes ---------------------------------------------------------------------------------------

/// How many edges do not join two triangles that run along them in opposite directions.
std::size_t open_edges(const SectionMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance, uses;
    for (const Corners& c : mesh.triangles) {
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t a = c[k], b = c[(k + 1) % 3];
            balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
            ++uses[{std::min(a, b), std::max(a, b)}];
        }
    }
    std::size_t open = 0;
    for (const auto& [edge, sum] : balance) open += sum != 0 || uses[edge] != 2 ? 1 : 0;
    return open;
}

double volume(const SectionMesh& mesh) {
    double sum = 0;
    for (const Corners& c : mesh.triangles)
        sum += glm::dot(mesh.points[c.x], glm::cross(mesh.points[c.y], mesh.points[c.z]));
    return sum / 6;
}

TEST(SectionsMesh, ASphereIsClosedAndRound) {
    for (const double half : {1.2, 1.0, 1.5}) {  // with 1.0 and 1.5 nodes lie on it
        const SectionMesh mesh = mesh_of(kSphere, half, 24);
        for (const glm::dvec3& p : mesh.points) ASSERT_NEAR(glm::length(p), 1, 1e-9);
        EXPECT_NEAR(volume(mesh), 4.0 / 3 * std::numbers::pi, 0.06) << half;
        EXPECT_EQ(open_edges(mesh), 0u) << half;
    }
}

TEST(SectionsMesh, SectionsAreClosedCircles) {
    const SectionMesh mesh = mesh_of(kSphere, 1.2, 24);
    const SectionPlanes sections(cube(1.2), planes(1.2, 9), planes(1.2, 9));
    std::map<std::uint32_t, int> ends;
    std::size_t edges = 0;
    for (const Corners& c : mesh.triangles) {
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 a = mesh.points[c[k]], b = mesh.points[c[(k + 1) % 3]];
            // Each edge from one of its two triangles.
            if (c[k] > c[(k + 1) % 3] || !sections.contain(a, b, mesh.points[c[(k + 2) % 3]]))
                continue;
            ++edges;
            ++ends[c[k]];
            ++ends[c[(k + 1) % 3]];
            const double at = a.z == b.z ? a.z : a.x;
            const auto in_plane = [&](glm::dvec3 p) {
                return a.z == b.z ? std::hypot(p.x, p.y) : std::hypot(p.y, p.z);
            };
            ASSERT_NEAR(in_plane(a), std::sqrt(1 - at * at), 1e-6);
        }
    }
    EXPECT_GT(edges, 500u);
    for (const auto& [vertex, count] : ends)  // 4 where an x and a z section cross
        ASSERT_TRUE(count == 2 || count == 4) << vertex;
}

TEST(SectionsMesh, FacesInPlanesOfTheGrid) {
    // A cube whose faces consist of nodes.
    const SectionMesh mesh = mesh_of("max(max(abs(x), abs(y)), abs(z)) = 0.5", 1, 16);
    EXPECT_EQ(open_edges(mesh), 0u);
    EXPECT_NEAR(volume(mesh), 1, 0.05);  // some of its edges are bevelled
    // One side of a plane is positive with the plane itself.
    const SectionMesh plane = mesh_of("x", 1, 16);
    EXPECT_EQ(plane.triangles.size(), 2u * 16 * 16);
    for (const glm::dvec3& p : plane.points) ASSERT_EQ(p.x, 0);
    // Nothing is on the other side of a surface that only touches.
    EXPECT_TRUE(mesh_of("0 - abs(x)", 1, 16).triangles.empty());
    EXPECT_TRUE(mesh_of("x^2", 1, 16).triangles.empty());
}

TEST(SectionsMesh, PolesAndJumpsAreNoRoots) {
    for (const std::string text : {"y - 1/x", "y - tan(3 * x)", "y - floor(2 * x + 0.25)"}) {
        const SectionMesh mesh = mesh_of(text, 2, 32);
        EXPECT_GT(mesh.triangles.size(), 500u) << text;
        Evaluator value = field(text).make();
        for (const glm::dvec3& p : mesh.points) ASSERT_NEAR(value(p), 0, 1e-5) << text;
    }
}

TEST(SectionsMesh, EndsWhereThereAreNoValues) {
    const SectionMesh mesh = mesh_of("y - sqrt(x)", 2, 32);
    EXPECT_GT(mesh.triangles.size(), 500u);
    for (const glm::dvec3& p : mesh.points) ASSERT_GE(p.x, 0);
}

TEST(SectionsMesh, DoesNotDependOnThreads) {
    for (const std::string& text : {kSphere, std::string("sin(5*x)*cos(5*y) + sin(5*z)")}) {
        const SectionMesh one = mesh_of(text, 1.2, 48, 1);
        for (const int threads : {2, 8}) {
            const SectionMesh many = mesh_of(text, 1.2, 48, threads);
            EXPECT_EQ(one.points, many.points);
            EXPECT_EQ(one.triangles, many.triangles);
        }
    }
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
          "x > 0 ? 1 : 0 - 1", "sin(1e9 * x)", "1 / (x*y*z)", "ln(x) * ln(y)",
          "x^2 + y^2 + z^2"}) {
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

TEST(SectionsInput, RangesOfY) {
    const auto range = [](const std::string& text, double half) {
        return must(find_y_range(field(text), {-half, half}, {-half, half}));
    };
    const auto near = [](glm::dvec2 found, double lo, double hi) {
        const double spare = 0.15 * (hi - lo);
        return found.x <= lo && found.y >= hi && found.x >= lo - spare && found.y <= hi + spare;
    };
    EXPECT_TRUE(near(range(kSphere, 1.2), -1, 1));
    EXPECT_TRUE(near(range(kSphere, 10), -1, 1));
    EXPECT_TRUE(near(range(kTorus, 3), -std::sqrt(0.5), std::sqrt(0.5)));
    EXPECT_TRUE(near(range("y - x^4", 5), 0, 625));
    EXPECT_TRUE(near(range("y - 0.01*sin(x)", 5), -0.01, 0.01));
    EXPECT_TRUE(near(range("y + 1000 - x", 1), -1001, -999));
    EXPECT_TRUE(near(range("(y - 3)^2 + x^2 + z^2 - 1", 2), 2, 4));
    EXPECT_EQ(range("sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)", 4), glm::dvec2(-4, 4));
    EXPECT_EQ(range("x^2 + z^2 - 1 + 0*y", 2), glm::dvec2(-2, 2));
    const auto nothing = find_y_range(field("x^2 + y^2 + z^2 = 0 - 1"), {-1, 2}, {0, 3});
    ASSERT_FALSE(nothing.ok());
    EXPECT_EQ(nothing.error().kind, ErrorKind::bad_input);
    EXPECT_NE(nothing.error().message.find(
                  "'x^2 + y^2 + z^2 = 0 - 1' has no points over x -1..2, z 0..3"),
              std::string::npos);
}

}  // namespace
}  // namespace sightline
