// Curves in which surfaces cross: where they are known, they are found once; where surfaces only
// touch, there are none. The point (x, y) of the scene stands at pixel (50 + x, 50 - y).
#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "drawing/pages.hpp"

namespace sightline {
namespace {

using namespace testing;

constexpr EdgeKinds kCurves = {EdgeKind::intersection};

glm::dvec2 at(double x, double y) { return {50 + x, 50 - y}; }

Drawing curves_of(const SceneBuilder& b) {
    const Scene scene = b.build();
    return must(trace(page(scene, pixel_camera({100, 100})), with_hidden(kCurves)));
}

/// Slopes in x, so that it crosses the plane z = 0 at x = 0.
void add_slope(SceneBuilder& b, double x0, double x1, double y0, double y1) {
    b.quad({x0, y0, x0}, {x1, y0, x1}, {x1, y1, x1}, {x0, y1, x0});
}

void expect_one_curve(const Drawing& d, glm::dvec2 from, glm::dvec2 to) {
    const double length = glm::length(to - from);
    EXPECT_GT(d.counts.intersections, 0u);
    EXPECT_NEAR(length_along(d, from, to, true), length, 1e-3);
    EXPECT_NEAR(length_of(d, kCurves, true), length, 1e-3);
    EXPECT_EQ(length_of(d, kCurves, false), 0);
}

TEST(Crossings, TwoSquaresCrossInOneLine) {
    SceneBuilder b;
    add_square(b, {-30, -30}, {30, 30}, 0);
    add_slope(b, -20, 20, -10, 10);
    const Drawing d = curves_of(b);
    expect_one_curve(d, at(0, -10), at(0, 10));
    for (std::size_t i = 0; i < d.lines.size(); ++i) {
        EXPECT_EQ(d.lines.kind[i], EdgeKind::intersection);
        EXPECT_EQ(d.lines.polygons[i], glm::uvec2(0, 1));
    }
}

// The line leaves one square through its side and ends within the other.
TEST(Crossings, ALineEndsWhereTheShorterSurfaceEnds) {
    SceneBuilder b;
    add_square(b, {-30, -5}, {30, 30}, 0);
    add_slope(b, -20, 20, -10, 10);
    expect_one_curve(curves_of(b), at(0, -5), at(0, 10));
}

// An edge of one surface, or of both, runs along the line: its faces lie on both sides.
TEST(Crossings, AlongEdgesOfOneSurfaceTheyAreFoundOnce) {
    SceneBuilder b;
    add_square(b, {-30, -30}, {0, 30}, 0);
    add_square(b, {0, -30}, {30, 30}, 0);
    add_slope(b, -20, 20, -10, 10);
    expect_one_curve(curves_of(b), at(0, -10), at(0, 10));

    SceneBuilder c;
    add_square(c, {-30, -30}, {30, 30}, 0);
    add_slope(c, -20, 0, -10, 10);
    add_slope(c, 0, 20, -10, 10);
    expect_one_curve(curves_of(c), at(0, -10), at(0, 10));
}

TEST(Crossings, AlongEdgesOfBothSurfacesTheyAreFoundOnce) {
    for (const double top : {10.0, 30.0, 35.0}) {  // within, equal, beyond
        SceneBuilder b;
        add_square(b, {-30, -30}, {0, 30}, 0);
        add_square(b, {0, -30}, {30, 30}, 0);
        add_slope(b, -20, 0, -10, top);
        add_slope(b, 0, 20, -10, top);
        SCOPED_TRACE(top);
        expect_one_curve(curves_of(b), at(0, -10), at(0, std::min(top, 30.0)));
    }
}

// Both halves of a roof below the plane, or only one half of a slope: nothing crosses.
TEST(Crossings, SurfacesThatTouchDoNotCross) {
    SceneBuilder roof;
    add_square(roof, {-30, -30}, {30, 30}, 0);
    roof.quad({-20, -10, -20}, {0, -10, 0}, {0, 10, 0}, {-20, 10, -20});
    roof.quad({0, -10, 0}, {20, -10, -20}, {20, 10, -20}, {0, 10, 0});
    EXPECT_EQ(curves_of(roof).counts.intersections, 0u);

    SceneBuilder ramp;
    add_square(ramp, {-30, -30}, {30, 30}, 0);
    add_slope(ramp, 0, 20, -10, 10);
    EXPECT_EQ(curves_of(ramp).counts.intersections, 0u);

    SceneBuilder corner;
    add_square(corner, {-30, -30}, {30, 30}, 0);
    corner.triangle({0, 0, 0}, {10, 0, 5}, {5, 10, 5});
    EXPECT_EQ(curves_of(corner).counts.intersections, 0u);
}

// Two valleys with one bottom line, one in the other: of the faces on either side the same surface
// is in front, though the planes beyond the line say otherwise.
TEST(Crossings, SurfacesThatTouchAlongEdgesOfBothDoNotCross) {
    const auto valley = [](SceneBuilder& b, double y, double left, double right) {
        b.quad({-10, -y, -10 * left}, {0, -y, 0}, {0, y, 0}, {-10, y, -10 * left});
        b.quad({0, -y, 0}, {10, -y, 10 * right}, {10, y, 10 * right}, {0, y, 0});
    };
    SceneBuilder touch;
    valley(touch, 10, 0, 3);
    valley(touch, 12, 5, 1);
    EXPECT_EQ(curves_of(touch).counts.intersections, 0u);

    SceneBuilder cross;
    valley(cross, 10, 0, 3);
    valley(cross, 12, 5, 4);
    expect_one_curve(curves_of(cross), at(0, -10), at(0, 10));
}

TEST(Crossings, NeighboursInAMeshDoNotCross) {
    const Scene sphere = sphere_scene(20, 30);
    for (const Cull cull : {Cull::none, Cull::automatic}) {
        const Camera camera = must(make_camera({}, sphere.bounds, {300, 300}));
        const Drawing d = must(trace(page(sphere, camera, cull), with_hidden(kCurves)));
        EXPECT_EQ(d.counts.intersections, 0u);
    }
}

TEST(Crossings, CoplanarFacesDoNotCross) {
    SceneBuilder b;
    const auto on = [](double x, double y) { return glm::dvec3(x, y, 0.37 * x - 0.21 * y); };
    b.quad(on(-30, -30), on(30, -30), on(30, 30), on(-30, 30));
    b.quad(on(-10, -20), on(35, -10), on(20, 15), on(-15, 10));
    EXPECT_EQ(curves_of(b).counts.intersections, 0u);
}

// A box sunk into a plane, seen from all around: the curve is the outline of its section, of which
// the fronts show their part.
TEST(Crossings, ABoxSunkIntoAPlaneHasAClosedCurve) {
    SceneBuilder b;
    const glm::dvec3 lo(-1, -0.5, -0.5), hi(1, 1.5, 0.7);
    b.quad({-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3});
    b.box(lo, hi);
    const Scene scene = b.build();
    for (int k = 0; k < 16; ++k) {
        CameraOptions options;
        const double turn = 0.15 + 0.4 * k;
        options.direction = glm::dvec3(std::cos(turn), -0.5, std::sin(turn));
        const Camera camera = must(make_camera(options, scene.bounds, {400, 300}));
        const Drawing d = must(trace(page(scene, camera), with_hidden(kCurves)));
        const glm::dvec3 corners[] = {
            {lo.x, 0, lo.z}, {hi.x, 0, lo.z}, {hi.x, 0, hi.z}, {lo.x, 0, hi.z}};
        const glm::dvec3 normals[] = {{0, 0, -1}, {1, 0, 0}, {0, 0, 1}, {-1, 0, 0}};
        for (int i = 0; i < 4; ++i) {
            const glm::dvec3 p = corners[i], q = corners[(i + 1) % 4];
            const glm::dvec2 from = camera.pixel_of(p), to = camera.pixel_of(q);
            const bool front = glm::dot(camera.view_vector(p), normals[i]) < 0;
            EXPECT_NEAR(length_along(d, from, to, front), glm::length(to - from), 1e-2) << k;
            // Where it ends in a corner of the page's grid a step may be left over.
            EXPECT_LT(length_along(d, from, to, !front), 1e-3) << k;
        }
    }
}

/// From all around, what crosses along edges in the world crosses there on the page, whatever
/// snapping does.
TEST(Crossings, AlongEdgesTheyAreFoundFromEverywhere) {
    SceneBuilder b;
    const glm::dvec3 o(0.1, 0.2, 0.3), u = glm::normalize(glm::dvec3(1, 0.31, 0.17));
    const glm::dvec3 v = glm::normalize(glm::cross(u, glm::dvec3(0.12, 0.23, 1)));
    const glm::dvec3 w = glm::normalize(glm::cross(u, v) + 0.4 * v);
    for (const double side : {-1.0, 1.0}) {
        b.quad(o - 2.0 * u, o + 2.0 * u, o + 2.0 * u + side * v, o - 2.0 * u + side * v);
        b.quad(o - u, o + u, o + u + side * w, o - u + side * w);
    }
    const Scene scene = b.build();
    for (int k = 0; k < 24; ++k) {
        CameraOptions options;
        options.direction =
            glm::dvec3(std::cos(0.1 + 0.4 * k), 0.1 * (k % 5) - 0.2, std::sin(0.1 + 0.4 * k));
        const Camera camera = must(make_camera(options, scene.bounds, {400, 300}));
        const Drawing d = must(trace(page(scene, camera), with_hidden(kCurves)));
        const double length = glm::length(camera.pixel_of(o + u) - camera.pixel_of(o - u));
        EXPECT_NEAR(length_of(d, kCurves, true) + length_of(d, kCurves, false), length, 0.02) << k;
    }
}

}  // namespace
}  // namespace sightline
