// Whole drawings: what holds of all of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>

#include "drawing/pages.hpp"

namespace sightline {
namespace {

using namespace testing;

TraceOptions everything() {
    TraceOptions options = with_hidden(kAllEdges);
    options.fill = FillStyle::lambert;
    return options;
}

bool equal_lines(const DrawnLines& a, const DrawnLines& b) {
    return a.from == b.from && a.to == b.to && a.kind == b.kind && a.visible == b.visible &&
           a.polygons == b.polygons && a.object == b.object;
}

bool equal_regions(const DrawnRegions& a, const DrawnRegions& b) {
    return a.polygon == b.polygon && a.object == b.object && a.color == b.color &&
           a.first_loop == b.first_loop && a.first_point == b.first_point && a.points == b.points;
}

TEST(Trace, DoesNotDependOnTheNumberOfThreads) {
    for (std::uint64_t seed = 0; seed < amount(25, 25, 4); ++seed) {
        const Scene scene = seed == 0 ? sphere_scene(60, 90) : hostile_scene(seed);
        const ScreenScene screen = page(scene, hostile_camera(scene, seed, {300, 200}));
        TraceOptions options = everything();
        options.threads = 1;
        const Drawing one = must(trace(screen, options));
        const auto areas = must(visible_areas(screen, options));
        for (const int threads : {2, 8}) {
            options.threads = threads;
            const Drawing many = must(trace(screen, options));
            EXPECT_TRUE(equal_lines(one.lines, many.lines)) << seed;
            EXPECT_TRUE(equal_regions(one.regions, many.regions)) << seed;
            EXPECT_EQ(one.counts.visible_length, many.counts.visible_length) << seed;
            EXPECT_EQ(one.counts.occluder_tests, many.counts.occluder_tests) << seed;
            EXPECT_EQ(one.counts.faces_partly, many.counts.faces_partly) << seed;
            const auto other = must(visible_areas(screen, options));
            EXPECT_TRUE(std::ranges::equal(areas, other, [](const FaceArea& a, const FaceArea& b) {
                return a.projected == b.projected && a.visible == b.visible;
            })) << seed;
        }
    }
}

/// Whether a point is one of the page's grid and within it.
bool on_page(const glm::dvec2& p, const ScreenScene& page) {
    const Resolution size = page.resolution();
    const glm::dvec2 units = std::ldexp(1.0, page.subpixel_bits()) * p;
    return p.x >= 0 && p.y >= 0 && p.x <= size.width && p.y <= size.height &&
           units == glm::dvec2(std::floor(units.x), std::floor(units.y));
}

void expect_well_formed(const Drawing& d, const ScreenScene& page) {
    for (std::size_t i = 0; i < d.lines.size(); ++i) {
        ASSERT_TRUE(on_page(d.lines.from[i], page) && on_page(d.lines.to[i], page));
        ASSERT_NE(d.lines.from[i], d.lines.to[i]);
        ASSERT_LT(d.lines.polygons[i].x, d.lines.polygons[i].y);
        ASSERT_LT(d.lines.object[i], page.scene().objects.size());
    }
    const DrawnRegions& r = d.regions;
    ASSERT_EQ(r.first_loop.size(), r.size() + 1);
    ASSERT_EQ(r.first_loop.back() + 1, r.first_point.size());
    ASSERT_EQ(r.first_point.back(), r.points.size());
    ASSERT_TRUE(std::ranges::adjacent_find(r.polygon, std::greater_equal{}) == r.polygon.end());
    ASSERT_TRUE(
        std::ranges::all_of(r.points, [&](const glm::dvec2& p) { return on_page(p, page); }));
    for (std::size_t l = 1; l < r.first_point.size(); ++l)
        ASSERT_GE(r.first_point[l], r.first_point[l - 1] + 3);
}

/// In units of the page squared, doubled; positive when it runs clockwise on the page.
double doubled_area(const DrawnRegions& r, std::uint32_t region) {
    double sum = 0;
    for (std::uint32_t l = r.first_loop[region]; l < r.first_loop[region + 1]; ++l)
        for (std::uint32_t k = r.first_point[l]; k < r.first_point[l + 1]; ++k) {
            const glm::dvec2 origin = r.points[r.first_point[l]];
            const glm::dvec2 p = r.points[k] - origin;
            const glm::dvec2 q =
                r.points[k + 1 == r.first_point[l + 1] ? r.first_point[l] : k + 1] - origin;
            sum += p.x * q.y - p.y * q.x;
        }
    return sum;
}

// Regions have the areas of their faces, but for the rounding of their corners.
void expect_areas_of_regions(const Drawing& d, const ScreenScene& page) {
    const auto areas = must(visible_areas(page, {}));
    std::vector<double> of_polygon(page.scene().counts.polygons, 0.0);
    for (std::size_t t = 0; t < areas.size(); ++t)
        of_polygon[page.scene().triangle_polygon[t]] += areas[t].visible;
    const double step = std::ldexp(1.0, -page.subpixel_bits());
    const double side = page.resolution().width + page.resolution().height;
    for (std::uint32_t r = 0; r < d.regions.size(); ++r) {
        const double points = d.regions.first_point[d.regions.first_loop[r + 1]] -
                              d.regions.first_point[d.regions.first_loop[r]];
        double& area = of_polygon[d.regions.polygon[r]];
        EXPECT_NEAR(0.5 * doubled_area(d.regions, r), area, step * side * points);
        area = 0;
    }
    // What has no region is thinner than a step.
    for (const double area : of_polygon) EXPECT_LE(area, 4 * step * side);
}

TEST(Trace, DrawingsAreWellFormedAndStayOnThePage) {
    std::uint64_t clipped = 0, lines = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const Scene scene = hostile_scene(seed);
        const ScreenScene screen = page(scene, hostile_camera(scene, seed, {300, 200}),
                                        seed % 2 == 0 ? Cull::none : Cull::automatic);
        clipped += screen.counts().clipped;
        const Drawing d = must(trace(screen, everything()));
        lines += d.lines.size();
        ASSERT_NO_FATAL_FAILURE(expect_well_formed(d, screen)) << seed;
        expect_areas_of_regions(d, screen);
        ASSERT_FALSE(HasFailure()) << "seed " << seed;
    }
    EXPECT_GT(clipped, 100u);
    EXPECT_GT(lines, 10000u);
}

TEST(Trace, NothingIsDrawnOutsideOfThePageOrBeforeTheNearPlane) {
    const Scene scene = sphere_scene(24, 36);
    CameraOptions options;
    options.eye = glm::dvec3(0, 0, 1.5);
    options.target = glm::dvec3(0, 0, 0);
    options.near_plane = 1.0;  // cuts the cap off
    options.fov = 30;
    const ScreenScene screen = page(scene, must(make_camera(options, scene.bounds, {200, 100})));
    EXPECT_GT(screen.counts().clipped, 0u);
    EXPECT_GT(screen.counts().outside, 0u);
    const Drawing d = must(trace(screen, everything()));
    expect_well_formed(d, screen);
    // Looking into the open sphere, the page is full.
    double area = 0;
    for (std::uint32_t r = 0; r < d.regions.size(); ++r) area += 0.5 * doubled_area(d.regions, r);
    EXPECT_NEAR(area, 200 * 100, 1);
    double sum = 0;
    for (const FaceArea& a : must(visible_areas(screen, {}))) sum += a.visible;
    EXPECT_NEAR(sum, 200 * 100, 1e-3);
}

// An edge of which nothing but the middle is on the page.
TEST(Trace, LinesAreCutAtTheBordersOfThePage) {
    SceneBuilder b;
    add_square(b, {-1000, 10}, {1000, 20}, 0);
    const Scene scene = b.build();
    const Drawing d = must(trace(page(scene, pixel_camera({100, 80})), with_hidden()));
    ASSERT_EQ(d.lines.size(), 2u);
    EXPECT_EQ(length_along(d, {0, 30}, {100, 30}, true), 100);
    EXPECT_EQ(length_along(d, {0, 20}, {100, 20}, true), 100);
}

TEST(Trace, AllProjectionsDraw) {
    const Scene scene = sphere_scene(10, 14);
    for (const Projection projection : {Projection::perspective, Projection::orthographic,
                                        Projection::cavalier, Projection::cabinet}) {
        CameraOptions options;
        options.projection = projection;
        const ScreenScene screen = page(scene, must(make_camera(options, scene.bounds, {99, 77})));
        const Drawing d = must(trace(screen, everything()));
        expect_well_formed(d, screen);
        EXPECT_GT(d.counts.visible_length, 100) << name_of(projection);
        EXPECT_GT(d.counts.faces_whole, 50u) << name_of(projection);
        EXPECT_EQ(d.counts.faces_whole + d.counts.faces_partly + d.counts.faces_hidden,
                  scene.triangles.size());
    }
}

TEST(Trace, FlatRegionsAreGreyAndMaterialsHaveTheirColour) {
    SceneBuilder b;
    b.scene.materials[0].base_color = {0.25f, 0.5f, 0.125f};
    add_square(b, {-20, -20}, {20, 20}, 0);
    const Scene scene = b.build();
    const ScreenScene screen = page(scene, pixel_camera({100, 100}));
    TraceOptions options;
    options.fill = FillStyle::material;
    const Drawing material = must(trace(screen, options));
    ASSERT_EQ(material.regions.size(), 1u);
    EXPECT_EQ(material.regions.color[0], glm::vec3(0.25f, 0.5f, 0.125f));
    EXPECT_EQ(material.regions.points.size(), 4u);
    options.fill = FillStyle::flat;
    const glm::vec3 grey = must(trace(screen, options)).regions.color[0];
    EXPECT_TRUE(grey.r == grey.g && grey.g == grey.b);
    options.fill = FillStyle::none;
    EXPECT_EQ(must(trace(screen, options)).regions.size(), 0u);
}

// -- progress
// --------------------------------------------------------------------------------------

TEST(Trace, EndsWhenTheProgressFunctionSaysSo) {
    const Scene scene = sphere_scene(30, 40);
    const ScreenScene screen = page(scene, must(make_camera({}, scene.bounds, {100, 100})));
    TraceOptions options = with_hidden(kAllEdges);
    options.progress = [](double) { return false; };
    const Result<Drawing> lines = trace(screen, options);
    ASSERT_FALSE(lines.ok());
    EXPECT_EQ(lines.error().kind, ErrorKind::cancelled);
    options.edges = {};
    options.fill = FillStyle::flat;
    const Result<Drawing> regions = trace(screen, options);
    ASSERT_FALSE(regions.ok());
    EXPECT_EQ(regions.error().kind, ErrorKind::cancelled);
    const auto areas = visible_areas(screen, options);
    ASSERT_FALSE(areas.ok());
    EXPECT_EQ(areas.error().kind, ErrorKind::cancelled);
}

TEST(Trace, ProgressRisesToOneAndIsToldFromOneThreadAtATime) {
    const Scene scene = sphere_scene(60, 80);
    const ScreenScene screen = page(scene, must(make_camera({}, scene.bounds, {100, 100})));
    for (const int threads : {1, 8}) {
        std::vector<double> told;
        std::atomic<int> inside = 0, together = 0;
        TraceOptions options = everything();
        options.threads = threads;
        options.progress = [&](double share) {
            if (++inside > 1) ++together;
            told.push_back(share);
            --inside;
            return true;
        };
        EXPECT_TRUE(trace(screen, options).ok());
        EXPECT_EQ(together, 0);
        ASSERT_GT(told.size(), 10u);
        EXPECT_TRUE(std::ranges::is_sorted(told)) << threads;
        EXPECT_GE(told.front(), 0.0);
        EXPECT_LE(told.back(), 1.0);
        EXPECT_TRUE(threads > 1 || told.back() == 1.0);
    }
}

// -- nothing to draw
// -------------------------------------------------------------------------------

TEST(Trace, WithoutFacesTheDrawingIsEmpty) {
    SceneBuilder degenerate, outside, behind;
    degenerate.triangle({0, 0, 0}, {1, 1, 1}, {2, 2, 2});
    // So large that they need no offset: the camera is made without the scene.
    outside.triangle({1000, 0, 0}, {1100, 0, 0}, {1000, 100, 0});
    behind.triangle({0, 0, 500}, {100, 0, 500}, {0, 100, 500});
    for (const SceneBuilder* b : {&degenerate, &outside, &behind})
        for (const TraceMethod method : {TraceMethod::fast, TraceMethod::pairwise}) {
            const Scene scene = b->build();
            const ScreenScene screen = page(scene, pixel_camera({100, 100}));
            TraceOptions options = everything();
            options.method = method;
            const Drawing d = must(trace(screen, options));
            EXPECT_EQ(d.resolution, (Resolution{100, 100}));
            EXPECT_EQ(d.lines.size(), 0u);
            EXPECT_EQ(d.regions.size(), 0u);
            const auto areas = must(visible_areas(screen, options));
            ASSERT_EQ(areas.size(), 1u);
            EXPECT_EQ(areas[0].visible, 0);
            EXPECT_EQ(areas[0].projected, 0);
        }
}

// The page has as many steps as fit: two to the 22nd to 23rd a side.
TEST(Page, HasAsManyStepsAsFit) {
    SceneBuilder b;
    add_square(b, {-1, -1}, {1, 1}, 0);
    const Scene scene = b.build();
    for (const Resolution size :
         {Resolution{1, 1}, {100, 50}, {1024, 768}, {640, 4096}, {65536, 300}}) {
        const ScreenScene screen = page(scene, pixel_camera(size));
        const double steps = std::ldexp(std::max(size.width, size.height), screen.subpixel_bits());
        EXPECT_GE(steps, 0x1p22) << size.width;
        EXPECT_LT(steps, 0x1p23) << size.width;
    }
}

TEST(Trace, FreeLinesAreHiddenByFaces) {
    SceneBuilder b;
    b.quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
    const Scene scene = b.build();
    CameraOptions camera_options;
    camera_options.direction = glm::dvec3(0, 0, -1);
    camera_options.projection = Projection::orthographic;
    const Camera camera = must(make_camera(camera_options, {{-2, -2, -1}, {2, 2, 1}}, {400, 400}));
    const ScreenScene screen = page(scene, camera);
    TraceOptions options;
    options.edges = {};
    options.hidden = true;
    options.free_lines = {{{-2, 0.5, -0.5}, {2, 0.5, -0.5}, EdgeKind::axis, 7},  // behind
                          {{-2, 0.2, 0.5}, {2, 0.2, 0.5}},                       // in front
                          {{0, 0, 9}, {0, 1, 9}},                                // out of view
                          {{0, 0, -0.5}, {0, 0, 0.5}}};                          // seen end-on
    const DrawnLines lines = must(trace(screen, options)).lines;
    ASSERT_EQ(lines.size(), 4u);
    EXPECT_EQ(lines.visible, (std::vector<std::uint8_t>{1, 0, 1, 1}));
    EXPECT_EQ(lines.object, (std::vector<std::uint32_t>{7, 7, 7, kNone}));
    EXPECT_EQ(lines.polygons, std::vector<glm::uvec2>(4, glm::uvec2(kNone)));
    const double step = std::ldexp(1.0, -screen.subpixel_bits());
    EXPECT_LE(glm::distance(lines.from[1], camera.pixel_of({-1, 0.5, 0})), step);
    EXPECT_LE(glm::distance(lines.to[1], camera.pixel_of({1, 0.5, 0})), step);
}

}  // namespace
}  // namespace sightline
