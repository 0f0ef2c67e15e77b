// Faces whose plane contains the eye, or the direction of projection, cover no sample, however thin
// a needle snapping makes of them: with every algorithm and on every vector width.
#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "drawing/pages.hpp"
#include "math/predicates.hpp"

namespace sightline {
namespace {

using namespace testing;

glm::dvec3 lattice_point(Random& random, std::uint32_t reach) {
    const auto number = [&] {
        return static_cast<double>(random.below(2 * reach + 1)) - static_cast<double>(reach);
    };
    return {number(), number(), number()};
}

/// Triangles in planes through a point, all in front of it, of many sizes; with `behind` some of
/// their corners lie behind it.
Scene planes_through(const glm::dvec3& eye, Random& random, int count, bool behind) {
    SceneBuilder b;
    for (int k = 0; k < count;) {
        const glm::dvec3 u = lattice_point(random, 64), v = lattice_point(random, 64);
        const auto combined = [&](double s, double t) { return eye + s * u + t * v; };
        const auto factor = [&] { return 1.0 + random.below(k % 2 == 0 ? 3 : 40); };
        const glm::dvec3 p = combined(factor(), factor()), q = combined(factor(), factor());
        glm::dvec3 r = combined(factor(), factor());
        if (behind && k % 3 == 0) r = combined(-factor(), factor());
        if (glm::cross(q - p, r - p) == glm::dvec3(0)) continue;
        b.triangle(p, q, r);
        ++k;
    }
    return b.build();
}

Scene planes_along(const glm::dvec3& direction, Random& random, int count) {
    SceneBuilder b;
    for (int k = 0; k < count;) {
        // r stands a third of the way from p to q on the page.
        const glm::dvec3 p = lattice_point(random, 500);
        const glm::dvec3 third = lattice_point(random, k % 2 == 0 ? 9 : 150);
        const glm::dvec3 q = p + 3.0 * third;
        const glm::dvec3 r = p + third + direction * (1.0 + random.below(20));
        if (glm::cross(q - p, r - p) == glm::dvec3(0)) continue;
        b.triangle(p, q, r);
        ++k;
    }
    return b.build();
}

/// Triangles that snapping gives an area.
std::uint32_t count_needles(const ScreenScene& screen) {
    std::uint32_t needles = 0;
    for (std::uint32_t t = 0; t < screen.scene().triangle_count(); ++t) {
        if (!screen.skip().empty() && screen.skip()[t] != 0) continue;
        const Corners c = screen.scene().triangles[t];
        const ScreenPoint &p = screen.point(c.x), &q = screen.point(c.y), &r = screen.point(c.z);
        needles += side(p.x, p.y, q.x, q.y, r.x, r.y) != 0 ? 1 : 0;
    }
    return needles;
}

void expect_nothing(const Scene& scene, const Camera& camera, const std::string& what) {
    const ScreenScene screen = must(project(scene, camera, {Cull::none, 0}));
    EXPECT_EQ(screen.pieces().size(), 0u) << what;
    EXPECT_GT(count_needles(screen), 3u) << what;
    for (const Algorithm& algorithm : algorithms()) {
        if (algorithm.exhaustive && algorithm.name != "brute") continue;
        ResolveOptions options;
        options.samples_per_axis = 4;
        const Visibility seen = run(std::string(algorithm.name), screen, options);
        EXPECT_TRUE(std::ranges::all_of(seen.ids, [](std::uint32_t id) { return id == kNone; }))
            << what << ", " << algorithm.name;
    }
    for (const FaceArea& area : must(visible_areas(page(scene, camera), {})))
        EXPECT_EQ(area.visible, 0) << what;
}

TEST(EdgeOn, FacesCoverNothingInPerspective) {
    Random random(3);
    for (int trial = 0; trial < 4; ++trial) {
        const glm::dvec3 eye = lattice_point(random, 100);
        const Scene scene = planes_through(eye, random, 150, trial % 2 == 1);
        CameraOptions options;
        options.eye = eye;
        options.fov = trial == 3 ? 120 : 50;
        const Camera camera = must(make_camera(options, scene.bounds, {96, 72}));
        expect_nothing(scene, camera, "trial " + std::to_string(trial));
    }
}

TEST(EdgeOn, FacesCoverNothingInParallelProjections) {
    Random random(4);
    for (int trial = 0; trial < 4; ++trial) {
        CameraOptions options;
        glm::dvec3 direction{1, -2, 3};
        if (trial < 2) {
            if (trial == 1) direction = {-1, -1, -1};
            options.direction = direction;
            options.projection = Projection::orthographic;
        } else {
            // At 180 degrees a point one unit behind moves by one unit, or by half of one.
            options.projection = trial == 2 ? Projection::cavalier : Projection::cabinet;
            options.oblique_angle = 180;
            direction = trial == 2 ? glm::dvec3{1, 0, -1} : glm::dvec3{1, 0, -2};
        }
        const Scene scene = planes_along(direction, random, 150);
        const Camera camera = must(make_camera(options, scene.bounds, {96, 72}));
        expect_nothing(scene, camera, "trial " + std::to_string(trial));
    }
}

// What stands beside such a face is drawn as ever, and its edges are still lines of a drawing.
TEST(EdgeOn, ADrawingKeepsTheEdges) {
    SceneBuilder b;
    b.quad({0, 0, 0}, {0, 0, -8}, {7, 3, -8}, {7, 3, 0});  // holds the gaze
    CameraOptions options;
    options.projection = Projection::orthographic;
    options.view = NamedView::front;
    const Scene scene = b.build();
    const Camera camera = must(make_camera(options, scene.bounds, {96, 72}));
    TraceOptions drawn;
    const Drawing drawing = must(trace(page(scene, camera), drawn));
    const double length = glm::length(glm::dvec2(7, 3)) * camera.pixels_per_unit();
    EXPECT_NEAR(length_of(drawing, kFeatureEdges, true), 2 * length, 1e-2);
}

}  // namespace
}  // namespace sightline
