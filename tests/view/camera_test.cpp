// Cameras: named views, projections, fitting, vanishing points and wrong use.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

const Box kCube{{-1, -1, -1}, {1, 1, 1}};
constexpr Resolution kPage{400, 300};

Camera camera_with(const CameraOptions& options, const Box& box = kCube) {
    return must(make_camera(options, box, kPage));
}

CameraOptions view_of(NamedView view, Projection projection = Projection::orthographic) {
    CameraOptions options;
    options.view = view;
    options.projection = projection;
    return options;
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-12) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Camera, NamedViewsLookWhereTheyShould) {
    expect_near(camera_with(view_of(NamedView::front)).gaze(), {0, 0, -1});
    expect_near(camera_with(view_of(NamedView::back)).gaze(), {0, 0, 1});
    expect_near(camera_with(view_of(NamedView::left)).gaze(), {1, 0, 0});
    expect_near(camera_with(view_of(NamedView::right)).gaze(), {-1, 0, 0});
    const Camera top = camera_with(view_of(NamedView::top));
    expect_near(top.gaze(), {0, -1, 0});
    expect_near(top.up, {0, 0, -1});
    expect_near(camera_with(view_of(NamedView::bottom)).gaze(), {0, 1, 0});
    expect_near(camera_with({}).gaze(), glm::normalize(glm::dvec3{-1, -1, -1}));
}

TEST(Camera, TheSetOfViewsTurnsWithUp) {
    CameraOptions options = view_of(NamedView::front);
    options.up = glm::dvec3{0, 0, 2};
    Camera camera = camera_with(options);
    expect_near(camera.gaze(), {0, 1, 0});
    expect_near(camera.up, {0, 0, 1});
    options.view = NamedView::top;
    camera = camera_with(options);
    expect_near(camera.gaze(), {0, 0, -1});
    expect_near(camera.up, {0, 1, 0});
}

// Axonometry: the lengths of the axes on the page.
TEST(Camera, AxonometricForeshortening) {
    const auto axis_length = [](const Camera& camera, const glm::dvec3& axis) {
        return glm::length(camera.pixel_of(axis) - camera.pixel_of({0, 0, 0})) /
               camera.pixels_per_unit();
    };
    const Camera iso = camera_with(view_of(NamedView::isometric));
    for (const glm::dvec3& axis : {glm::dvec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}})
        EXPECT_NEAR(axis_length(iso, axis), std::sqrt(2.0 / 3), 1e-12);
    const Camera di = camera_with(view_of(NamedView::dimetric));
    EXPECT_NEAR(axis_length(di, {1, 0, 0}), axis_length(di, {0, 0, 1}), 1e-12);
    EXPECT_GT(std::abs(axis_length(di, {1, 0, 0}) - axis_length(di, {0, 1, 0})), 0.1);
    const Camera tri = camera_with(view_of(NamedView::trimetric));
    EXPECT_GT(std::abs(axis_length(tri, {1, 0, 0}) - axis_length(tri, {0, 0, 1})), 0.05);
    EXPECT_GT(std::abs(axis_length(tri, {1, 0, 0}) - axis_length(tri, {0, 1, 0})), 0.05);
}

// Oblique: the front plane in its true shape; receding axes at the angle, whole or halved.
TEST(Camera, ObliqueProjections) {
    for (const Projection projection : {Projection::cavalier, Projection::cabinet}) {
        for (const double angle : {30.0, 45.0, 135.0}) {
            CameraOptions options = view_of(NamedView::front, projection);
            options.oblique_angle = angle;
            const Camera camera = camera_with(options);
            const glm::dvec2 origin = camera.pixel_of({0, 0, 0});
            const double unit = camera.pixels_per_unit();
            EXPECT_NEAR(camera.pixel_of({1, 0, 0}).x - origin.x, unit, 1e-9);
            EXPECT_NEAR(camera.pixel_of({0, 1, 0}).y - origin.y, -unit, 1e-9);
            const glm::dvec2 receding = camera.pixel_of({0, 0, -1}) - origin;
            const double scale = projection == Projection::cavalier ? 1 : 0.5;
            EXPECT_NEAR(glm::length(receding), scale * unit, 1e-9);
            EXPECT_NEAR(std::atan2(-receding.y, receding.x), angle * std::acos(-1.0) / 180, 1e-12);
        }
    }
}

TEST(Camera, EverythingIsInViewByDefault) {
    for (const Projection projection : {Projection::perspective, Projection::orthographic,
                                        Projection::cavalier, Projection::cabinet})
        for (const Resolution page : {Resolution{400, 300}, Resolution{100, 700}}) {
            CameraOptions options;
            options.projection = projection;
            const Camera camera = must(make_camera(options, kCube, page));
            for (int k = 0; k < 8; ++k) {
                const glm::dvec3 corner{k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1};
                const glm::dvec2 p = camera.pixel_of(corner);
                EXPECT_TRUE(p.x > 0 && p.y > 0 && p.x < page.width && p.y < page.height);
                EXPECT_GT(camera.depth_of(corner), camera.near_plane);
                EXPECT_LT(camera.depth_of(corner), camera.far_plane);
            }
        }
}

TEST(Camera, ZoomEnlargesAboutTheCentre) {
    CameraOptions options = view_of(NamedView::front, Projection::perspective);
    const glm::dvec2 once = camera_with(options).pixel_of({0.5, 0.2, 0});
    options.zoom = 3;
    const glm::dvec2 thrice = camera_with(options).pixel_of({0.5, 0.2, 0});
    const glm::dvec2 centre{200, 150};
    EXPECT_NEAR(thrice.x - centre.x, 3 * (once.x - centre.x), 1e-9);
    EXPECT_NEAR(thrice.y - centre.y, 3 * (once.y - centre.y), 1e-9);
}

TEST(Camera, UnprojectInvertsPixelOf) {
    Random random(3);
    for (const Projection projection : {Projection::perspective, Projection::orthographic,
                                        Projection::cavalier, Projection::cabinet}) {
        CameraOptions options;
        options.projection = projection;
        options.view = NamedView::trimetric;
        const Camera camera = camera_with(options);
        for (int i = 0; i < 100; ++i) {
            const glm::dvec3 p = random.point();
            expect_near(camera.unproject(camera.pixel_of(p), camera.depth_of(p)), p, 1e-9);
            // All points along the line of sight have one picture.
            const glm::dvec3 further = p + 0.3 * glm::normalize(camera.view_vector(p));
            EXPECT_NEAR(glm::length(camera.pixel_of(further) - camera.pixel_of(p)), 0, 1e-9);
        }
    }
}

TEST(Camera, FlatSceneThatFacesTheCameraHasDepth) {
    const Box flat{{-1, -1, 2}, {1, 1, 2}};
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
        const Camera camera = must(make_camera(view_of(NamedView::front, projection), flat, kPage));
        EXPECT_LT(camera.near_plane, camera.depth_of({0, 0, 2}));
        EXPECT_GT(camera.far_plane, camera.depth_of({0, 0, 2}));
    }
}

int finite_count(const Camera& camera) {
    int n = 0;
    for (const VanishingPoint& p : principal_vanishing_points(camera)) n += p.has_value();
    return n;
}

TEST(VanishingPoints, OneTwoAndThreePointPerspective) {
    EXPECT_EQ(finite_count(camera_with(view_of(NamedView::front, Projection::perspective))), 1);
    CameraOptions options;
    options.direction = glm::dvec3{-1, 0, -2};
    EXPECT_EQ(finite_count(camera_with(options)), 2);
    EXPECT_EQ(finite_count(camera_with({})), 3);
    EXPECT_EQ(finite_count(camera_with(view_of(NamedView::isometric))), 0);
    EXPECT_EQ(finite_count(camera_with(view_of(NamedView::front, Projection::cabinet))), 0);
}

TEST(VanishingPoints, LinesConvergeThere) {
    const Camera camera = camera_with({});
    const glm::dvec3 direction{-0.3, 0.1, -1};
    const VanishingPoint v = vanishing_point(camera, direction);
    ASSERT_TRUE(v.has_value());
    for (const glm::dvec3& start : {glm::dvec3{0, 0, 0}, {1, -1, 0.5}}) {
        const glm::dvec2 far_away = camera.pixel_of(start + 1e7 * direction);
        EXPECT_NEAR(far_away.x, v->x, 1e-3);
        EXPECT_NEAR(far_away.y, v->y, 1e-3);
    }
}

TEST(Camera, WrongUseIsNamed) {
    const auto fails = [](const CameraOptions& options, const std::string& word) {
        const Result<Camera> camera = make_camera(options, kCube, kPage);
        ASSERT_FALSE(camera.ok()) << word;
        EXPECT_EQ(camera.error().kind, ErrorKind::bad_option);
        EXPECT_NE(camera.error().message.find(word), std::string::npos) << camera.error().message;
    };
    CameraOptions o;
    for (const double fov : {0.0, 180.0, -5.0, std::nan("")}) {
        o = {};
        o.fov = fov;
        fails(o, "--fov");
    }
    o = {};
    o.near_plane = 2, o.far_plane = 2;
    fails(o, "--near");
    o = {};
    o.near_plane = 0;
    fails(o, "--near");
    o = {};
    o.eye = o.target = glm::dvec3{1, 2, 3};
    fails(o, "same point");
    o = {};
    o.direction = glm::dvec3{0, -1, 0};
    fails(o, "up is parallel");
    o = {};
    o.zoom = 0;
    fails(o, "--zoom");
    o = {};
    o.ortho_height = -1;
    fails(o, "--ortho-height");
    o = {};
    o.eye = glm::dvec3{std::numeric_limits<double>::infinity(), 0, 0};
    fails(o, "--eye");
    EXPECT_FALSE(make_camera({}, kCube, {0, 10}).ok());
    EXPECT_FALSE(make_camera({}, kCube, {70000, 10}).ok());
}

}  // namespace
}  // namespace sightline
