// Depths of what is in view, and near planes that are fitted to them.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;
using Rational = boost::multiprecision::cpp_rational;
using RationalPoint = std::array<Rational, 3>;

constexpr Resolution kPage{160, 100};

RationalPoint exact(const glm::dvec3& p) { return {Rational(p.x), Rational(p.y), Rational(p.z)}; }

Rational dot(const RationalPoint& a, const RationalPoint& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

RationalPoint cross(const RationalPoint& a, const RationalPoint& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// The oracle: the depth of a triangle in a pyramid is least at the eye, at a corner, where an edge
// meets a side, or where an edge of the pyramid meets the triangle. All of these are tried.
class Pyramid {
public:
    explicit Pyramid(const Camera& camera)
        : eye_(exact(camera.eye)), right_(exact(camera.right)), up_(exact(camera.up)) {
        back_ = exact(camera.back);
        half_height_ = Rational(camera.view_height) / 2;
        half_width_ = half_height_ * camera.resolution.width / camera.resolution.height;
    }

    [[nodiscard]] std::optional<Rational> least(const std::array<glm::dvec3, 3>& corners) {
        best_.reset();
        std::array<RationalPoint, 3> view;
        for (std::size_t k = 0; k < 3; ++k) view[k] = to_view(corners[k]);
        for (std::size_t k = 0; k < 3; ++k) {
            offer(view[k]);
            for (const Rational& x : {half_width_, Rational(-half_width_)}) {
                cut(view[k], view[(k + 1) % 3], {Rational(1), Rational(0), -x});
                for (const Rational& y : {half_height_, Rational(-half_height_)})
                    pierce(view, {x, y, Rational(1)});
            }
            for (const Rational& y : {half_height_, Rational(-half_height_)})
                cut(view[k], view[(k + 1) % 3], {Rational(0), Rational(1), -y});
        }
        return best_;
    }

private:
    /// To the right, upwards, and along the gaze.
    [[nodiscard]] RationalPoint to_view(const glm::dvec3& p) const {
        RationalPoint v = exact(p);
        for (std::size_t k = 0; k < 3; ++k) v[k] -= eye_[k];
        return {dot(v, right_), dot(v, up_), -dot(v, back_)};
    }

    void offer(const RationalPoint& p) {
        if (abs(p[0]) > half_width_ * p[2] || abs(p[1]) > half_height_ * p[2]) return;
        if (!best_ || p[2] < *best_) best_ = p[2];
    }

    /// Where an edge meets a plane through the eye. That side may have lost a digit, so the point
    /// is put onto it exactly.
    void cut(const RationalPoint& a, const RationalPoint& b, const RationalPoint& plane) {
        const Rational da = dot(a, plane), db = dot(b, plane);
        if (da.sign() * db.sign() >= 0) return;
        const Rational s = da / (da - db);
        offer({a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), a[2] + s * (b[2] - a[2])});
    }

    /// Where the triangle is met by a ray from the eye.
    void pierce(const std::array<RationalPoint, 3>& t, const RationalPoint& ray) {
        std::array<int, 3> sides{};
        for (std::size_t k = 0; k < 3; ++k) sides[k] = dot(cross(t[k], t[(k + 1) % 3]), ray).sign();
        const bool inside = (sides[0] >= 0 && sides[1] >= 0 && sides[2] >= 0) ||
                            (sides[0] <= 0 && sides[1] <= 0 && sides[2] <= 0);
        RationalPoint u, v;
        for (std::size_t k = 0; k < 3; ++k) {
            u[k] = t[1][k] - t[0][k];
            v[k] = t[2][k] - t[0][k];
        }
        const RationalPoint normal = cross(u, v);
        const Rational along = dot(normal, ray);
        if (!inside || along == 0) return;
        const Rational depth = dot(normal, t[0]) / along;
        if (depth >= 0) offer({depth * ray[0], depth * ray[1], depth * ray[2]});
    }

    RationalPoint eye_, right_, up_, back_;
    Rational half_height_, half_width_;
    std::optional<Rational> best_;
};

Camera looking(const glm::dvec3& eye, const glm::dvec3& gaze, double fov, const Scene& scene) {
    CameraOptions options;
    options.eye = eye;
    options.direction = gaze;
    options.fov = fov;
    options.up =
        std::abs(gaze.y) > 0.9 * glm::length(gaze) ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    return must(make_camera(options, scene, kPage));
}

TEST(Depths, NearestIsThatOfRationalArithmetic) {
    Random random(17);
    int in_view = 0, crossing = 0;
    for (int round = 0; round < 400; ++round) {
        const std::array<glm::dvec3, 3> corners{random.point(), random.point(), random.point()};
        const Scene scene = SceneBuilder().triangle(corners[0], corners[1], corners[2]).build();
        const Camera camera = looking(random.point(), random.point(),
                                      random.chance(0.3) ? 170 : random.uniform(1, 120), scene);
        const DepthRange range = depths_in_view(scene, camera);
        const auto least = Pyramid(camera).least(corners);
        ASSERT_EQ(range.empty(), !least) << round;
        if (!least) continue;
        ++in_view;
        EXPECT_NEAR(range.nearest, static_cast<double>(*least), 1e-11) << round;
        double nearest_corner = INFINITY;
        for (const glm::dvec3& p : corners)
            nearest_corner = std::min(nearest_corner, camera.depth_of(p));
        crossing += range.nearest > nearest_corner + 1e-9 ? 1 : 0;
    }
    EXPECT_GT(in_view, 100);
    EXPECT_GT(crossing, 50);
}

// A million triangles are not needed: more than one task is.
TEST(Depths, NoMatterHowManyThreads) {
    Random random(3);
    SceneBuilder builder;
    for (int i = 0; i < 20000; ++i) {
        const glm::dvec3 p = random.point(5);
        builder.triangle(p, p + random.point(0.2), p + random.point(0.2));
    }
    const Scene scene = builder.build();
    const Camera camera = looking({0, 0, 0}, {1, 0.2, 0.3}, 60, scene);
    tbb::task_arena one(1), four(4);
    const DepthRange alone = one.execute([&] { return depths_in_view(scene, camera); });
    EXPECT_EQ(alone, four.execute([&] { return depths_in_view(scene, camera); }));
    EXPECT_GT(alone.nearest, 0);
    EXPECT_LE(camera.near_plane, alone.nearest);
}

TEST(Depths, ParallelViewsTakeWhatIsBehindTheEyeToo) {
    const Scene scene = SceneBuilder()
                            .triangle({-9, -9, 3}, {9, -9, 3}, {0, 9, 3})
                            .triangle({20, 0, 50}, {21, 0, 50}, {20, 1, 50})
                            .build();
    CameraOptions options;
    options.eye = glm::dvec3(0);
    options.target = glm::dvec3(0, 0, -1);
    options.ortho_height = 4;
    for (const Projection projection : {Projection::orthographic, Projection::cabinet}) {
        options.projection = projection;
        const Camera camera = must(make_camera(options, scene, kPage));
        EXPECT_LT(camera.near_plane, -50);  // a parallel view has room for all
        const DepthRange range = depths_in_view(scene, camera);
        EXPECT_EQ(range.nearest, -3);
        EXPECT_EQ(range.farthest, -3);
    }
}

TEST(Depths, ASphereAroundTheEye) {
    Scene scene;
    add_quadric(scene, make_sphere({1, 2, 3}, 5), "sphere", {});
    finish_scene(scene);
    const Camera camera = looking({1, 2, 3}, {0, 0, -1}, 40, scene);
    // Nearest along the gaze where the picture's corner is.
    const double y = std::tan(20 * std::acos(-1.0) / 180), x = y * kPage.width / kPage.height;
    const double expected = 5 / std::sqrt(1 + x * x + y * y);
    const DepthRange range = depths_in_view(scene, camera);
    EXPECT_LE(range.nearest, expected);
    EXPECT_GE(range.nearest, 0.98 * expected);
    EXPECT_LE(camera.near_plane, expected);
    EXPECT_GE(camera.near_plane, 0.97 * expected);
    EXPECT_GE(range.farthest, 5);
}

TEST(Depths, WhatMovesCountsInAllFrames) {
    Scene scene = SceneBuilder().triangle({-1, -1, -50}, {1, -1, -50}, {0, 1, -50}).build();
    glm::dmat4 nearer(1.0);
    nearer[3].z = 40;
    scene.motions.push_back({0, 1, {glm::dmat4(1.0), nearer}});
    finish_scene(scene);
    const Camera camera = looking({0, 0, 0}, {0, 0, -1}, 40, scene);
    const DepthRange range = depths_in_view(scene, camera);
    EXPECT_EQ(range.nearest, 10);
    EXPECT_EQ(range.farthest, 50);
    EXPECT_EQ(depths_in_view(posed(scene, 0), camera).nearest, 50);
}

TEST(Depths, FacesSeenEdgeOnCanBeLeftOut) {
    const Scene scene = SceneBuilder()
                            .triangle({-9, 0, 9}, {9, 0, 9}, {0, 0, -9})
                            .triangle({-1, -1, -5}, {1, -1, -5}, {0, 1, -5})
                            .build();
    const Camera camera = looking({0, 0, 0}, {0, 0, -1}, 40, scene);
    EXPECT_EQ(depths_in_view(scene, camera).nearest, 0);
    EXPECT_EQ(depths_in_view(scene, camera, EdgeOn::is_left_out).nearest, 5);
}

// -- the near plane that is fitted
// -----------------------------------------------------------------

/// Seen from inside, 10 x 3 x 8.
Scene room() { return SceneBuilder().box({0, 0, 0}, {10, 3, 8}).build(); }

TEST(FittedNear, ACeilingAtTheEyeIsNotCut) {
    CameraOptions options;
    options.eye = glm::dvec3(5, 2.9999, 4);
    options.target = glm::dvec3(9, 0, 4.1);
    options.fov = 90;
    const Scene scene = room();
    const Camera camera = must(make_camera(options, scene, {320, 240}));
    EXPECT_LE(camera.near_plane, depths_in_view(scene, camera).nearest);
    // A closed room is seen at every pixel.
    const ScreenScene screen = must(project(scene, camera, {Cull::none, 0}));
    for (const std::uint32_t id : testing::run("zbuffer", screen).ids) ASSERT_NE(id, kNone);
}

TEST(FittedNear, GroundUnderTheEyeIsNotCut) {
    const Scene scene =
        SceneBuilder().quad({-5e4, 0, -5e4}, {-5e4, 0, 5e4}, {5e4, 0, 5e4}, {5e4, 0, -5e4}).build();
    const Camera camera = looking({0, 1.7, 0}, {0, 0, -1}, 40, scene);
    const double lowest = 1.7 / std::tan(20 * std::acos(-1.0) / 180);
    EXPECT_NEAR(depths_in_view(scene, camera).nearest, lowest, 1e-9);
    EXPECT_LE(camera.near_plane, lowest);
    EXPECT_GT(camera.near_plane, 0.99 * lowest);  // and no bits are wasted
}

TEST(FittedNear, IsAtLeastAHundredThousandthOfFar) {
    const Scene scene = SceneBuilder()
                            .triangle({-1, -1, -1e6}, {1, -1, -1e6}, {0, 1, -1e6})
                            .triangle({-1, -1, -0.5}, {1, -1, -0.5}, {0, 1, -0.5})
                            .build();
    Camera camera = looking({0, 0, 0}, {0, 0, -1}, 40, scene);
    EXPECT_NEAR(camera.near_plane, kLeastNear * camera.far_plane, 1e-9);
    EXPECT_GT(camera.near_plane, depths_in_view(scene, camera).nearest);
    CameraOptions options;  // a nearer far plane lets near be nearer
    options.eye = glm::dvec3(0);
    options.direction = glm::dvec3(0, 0, -1);
    options.far_plane = 100;
    camera = must(make_camera(options, scene, kPage));
    EXPECT_LT(camera.near_plane, 0.5);
    EXPECT_GT(camera.near_plane, 0.49);
}

TEST(FittedNear, OfAnEyeOutsideIsThatOfTheBox) {
    Random random(5);
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Scene scene = hostile_scene(seed);
        CameraOptions options;
        options.direction = random.point();
        options.fov = random.uniform(5, 120);
        const Camera of_box = must(make_camera(options, scene.bounds, kPage));
        const Camera of_scene = must(make_camera(options, scene, kPage));
        EXPECT_EQ(of_box.near_plane, of_scene.near_plane) << seed;
        EXPECT_EQ(of_box.far_plane, of_scene.far_plane) << seed;
    }
}

// The property itself, with eyes among the faces of hostile scenes.
TEST(FittedNear, CutsNothingThatIsInView) {
    Random random(6);
    int looked = 0;
    for (std::uint64_t seed = 0; seed < 150; ++seed) {
        const Scene scene = hostile_scene(seed);
        const glm::dvec3 half = 0.5 * scene.bounds.extent();
        const glm::dvec3 eye = scene.bounds.centre() + half * random.point();
        const Camera camera = looking(eye, random.point(), random.uniform(1, 150), scene);
        const DepthRange range = depths_in_view(scene, camera);
        if (range.empty() || range.nearest < kLeastNear * camera.far_plane) continue;
        ++looked;
        EXPECT_LE(camera.near_plane, range.nearest) << seed;
        EXPECT_GE(camera.far_plane, range.farthest) << seed;
    }
    EXPECT_GT(looked, 80);
}

}  // namespace
}  // namespace sightline
