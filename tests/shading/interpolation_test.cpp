// Attributes are interpolated in the world: right in perspective, finite everywhere.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "shading/surface.hpp"
#include "shading/view_of.hpp"
#include "support/scenes.hpp"

namespace {

using namespace sightline;
using sightline::testing::SceneBuilder;
using test::forward_camera;
using test::View;
using test::view_of;

/// A floor that recedes to depth 20; its red is (depth - 1) / 19, its green (x + 5) / 10.
SceneBuilder receding_floor() {
    SceneBuilder builder;
    builder.polygon({{-5, -1, -1}, {5, -1, -1}, {5, -1, -20}, {-5, -1, -20}});
    builder.vertex_colors({{0, 0, 0, 1}, {0, 1, 0, 1}, {1, 1, 0, 1}, {1, 0, 0, 1}});
    builder.scene.materials[0].base_color = {1, 1, 1};
    return builder;
}

/// Compares every visible pixel with the colour of the floor's point that a ray through it meets.
void expect_true_colors(const View& view, std::uint32_t at_least) {
    const ColorImage image = view.shade(Shading::unlit);
    std::uint32_t seen = 0;
    for (std::uint32_t y = 0; y < image.height; ++y) {
        for (std::uint32_t x = 0; x < image.width; ++x) {
            if (image.at(x, y).a == 0) continue;
            ++seen;
            const glm::dvec2 pixel{x + 0.5, y + 0.5};
            const glm::dvec3 a = view.camera.unproject(pixel, 1);
            const glm::dvec3 b = view.camera.unproject(pixel, 2);
            const glm::dvec3 hit = a + (b - a) * ((-1 - a.y) / (b.y - a.y));
            // At the rim a sample may lie up to a snapping error outside of the floor.
            ASSERT_NEAR(image.at(x, y).r, (-hit.z - 1) / 19, 2e-3) << x << ' ' << y;
            ASSERT_NEAR(image.at(x, y).g, (hit.x + 5) / 10, 2e-3) << x << ' ' << y;
        }
    }
    EXPECT_GE(seen, at_least);
}

TEST(Interpolation, IsRightInPerspective) {
    SceneBuilder floor = receding_floor();
    expect_true_colors(view_of(floor.scene, forward_camera(), {64, 64}), 1'000);
}

TEST(Interpolation, IsRightInParallelViews) {
    for (const Projection projection :
         {Projection::orthographic, Projection::cavalier, Projection::cabinet}) {
        SceneBuilder floor = receding_floor();
        CameraOptions options;
        options.direction = glm::dvec3(0.2, -0.5, -1);
        options.projection = projection;
        expect_true_colors(view_of(floor.scene, options, {64, 64}), 400);
    }
}

TEST(Interpolation, IsRightWhereTheNearPlaneCutsATriangle) {
    SceneBuilder floor = receding_floor();
    for (glm::dvec3& p : floor.scene.positions) p.z += p.z > -2 ? 6 : 0;  // now behind the eye
    CameraOptions options = forward_camera();
    options.near_plane = 0.5;
    options.far_plane = 30;
    const View view = view_of(floor.scene, options, {64, 64});
    ASSERT_GT(view.screen.counts().clipped, 0u);
    const ColorImage image = view.shade(Shading::unlit);
    std::uint32_t seen = 0;
    for (std::uint32_t y = 40; y < 64; ++y) {
        for (std::uint32_t x = 0; x < 64; ++x) {
            if (image.at(x, y).a == 0) continue;
            ++seen;
            const double depth = 32.0 / (y + 0.5 - 32.0);  // where the ray meets y = -1
            ASSERT_NEAR(image.at(x, y).r, (depth + 5) / 25, 2e-3);
        }
    }
    EXPECT_GT(seen, 500u);
}

TEST(Interpolation, BarycentricsAreThoseOfTheWorld) {
    Camera camera;  // at the origin, along -z
    camera.resolution = {100, 100};
    const std::array<glm::dvec3, 3> corners = {glm::dvec3{-1, -1, -2}, glm::dvec3{3, -2, -9},
                                               glm::dvec3{0, 2, -4}};
    const BarycentricMap map(camera, corners);
    for (int i = 0; i <= 10; ++i) {
        for (int j = 0; i + j <= 10; ++j) {
            const glm::dvec3 b{i / 10.0, j / 10.0, (10 - i - j) / 10.0};
            const glm::dvec3 point = b.x * corners[0] + b.y * corners[1] + b.z * corners[2];
            const glm::dvec3 got = map.at(camera.pixel_of(point));
            EXPECT_NEAR(glm::length(got - b), 0, 1e-12);
        }
    }
}

TEST(Interpolation, TinyDistantTrianglesKeepTheirDigits) {
    Camera camera;
    camera.resolution = {1000, 1000};
    const glm::dvec3 base{100, 70, -1000};
    const std::array<glm::dvec3, 3> corners = {base, base + glm::dvec3{1e-4, 0, 1e-5},
                                               base + glm::dvec3{0, 1e-4, -1e-5}};
    const BarycentricMap map(camera, corners);
    const glm::dvec3 b{0.2, 0.3, 0.5};
    const glm::dvec3 point = b.x * corners[0] + b.y * corners[1] + b.z * corners[2];
    EXPECT_NEAR(glm::length(map.at(camera.pixel_of(point)) - b), 0, 1e-4);
}

TEST(Interpolation, SamplesOutsideAreClampedAndEdgeOnTrianglesHaveAMiddle) {
    Camera camera;
    camera.resolution = {100, 100};
    const std::array<glm::dvec3, 3> face = {glm::dvec3{-1, -1, -2}, glm::dvec3{1, -1, -2},
                                            glm::dvec3{0, 1, -2}};
    const std::array<glm::dvec3, 3> edge_on = {glm::dvec3{0, 0, -2}, glm::dvec3{0, 0, -3},
                                               glm::dvec3{0, 0, -4}};
    for (const auto& corners : {face, edge_on}) {
        const BarycentricMap map(camera, corners);
        for (const glm::dvec2 pixel : {glm::dvec2{-900, 50}, {50, 50}, {1e9, -1e9}, {49, 1e4}}) {
            const glm::dvec3 b = map.at(pixel);
            EXPECT_NEAR(b.x + b.y + b.z, 1, 1e-12);
            for (int k = 0; k < 3; ++k) {
                EXPECT_GE(b[k], 0);
                EXPECT_LE(b[k], 1);
            }
        }
    }
}

// Needles, points, edge-on faces, normals of any kind: whatever is visible gets a sensible colour.
TEST(Interpolation, DegenerateInputGivesFiniteColors) {
    SceneBuilder builder;
    std::mt19937 random(11);
    const auto next = [&random] { return static_cast<double>(random() % 2001) / 1000.0 - 1.0; };
    std::vector<glm::vec3> normals;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (int i = 0; i < 300; ++i) {
        const glm::dvec3 a{next(), next(), next() - 3}, along{next(), next(), next()};
        const double thin = std::pow(10.0, -(i % 12));
        builder.polygon({a, a + along, a + along * 0.5 + glm::dvec3{thin, 0, 0}});
        for (int k = 0; k < 3; ++k) {
            normals.push_back(i % 3 == 0   ? glm::vec3(0.0f)
                              : i % 3 == 1 ? glm::vec3(nan)
                                           : glm::vec3(glm::dvec3{next(), next(), next()}));
        }
    }
    builder.vertex_normals(normals);
    builder.scene.materials[0].opacity = 0;
    builder.scene.materials[0].specular = 1;
    builder.scene.materials[0].shininess = 0;
    const View view = view_of(builder.scene, forward_camera(), {48, 48}, 2);
    for (const Shading shading : {Shading::flat, Shading::gouraud, Shading::phong, Shading::unlit,
                                  Shading::depth, Shading::normals, Shading::ids}) {
        for (const glm::vec4& p : view.shade(shading).pixels) {
            for (int k = 0; k < 4; ++k) ASSERT_TRUE(p[k] >= 0 && p[k] <= 4) << name_of(shading);
        }
    }
}

}  // namespace
