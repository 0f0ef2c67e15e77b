// Quadrics in the scene: their equations, boxes and tessellations.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "math/frame.hpp"
#include "sightline/generate.hpp"
#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

glm::dvec3 own_of(const Quadric& quadric, glm::dvec3 world) {
    return math::Frame(quadric.frame).own_point(world);
}

double value_of(const Quadric& quadric, glm::dvec3 world) {
    return quadric.value_at(own_of(quadric, world));
}

Scene scene_of(const Quadric& quadric) {
    Scene scene;
    add_quadric(scene, quadric, "surface", {});
    finish_scene(scene);
    return scene;
}

const glm::dmat4 kSheared{2, 0.5, 0, 0, 0, -1, 0.25, 0, 0.5, 0, 1.5, 0, 3, -2, 7, 1};

TEST(Quadric, PointsOfTheWorldAreOnTheirSurfaces) {
    const Quadric sphere = make_sphere({1, 2, 3}, 2);
    EXPECT_NEAR(value_of(sphere, {3, 2, 3}), 0, 1e-12);
    EXPECT_LT(value_of(sphere, {1, 2, 3}), 0);
    EXPECT_GT(value_of(sphere, {1, 5, 3}), 0);
    const Quadric cylinder = make_cylinder({0, 0, 0}, {4, 0, 0}, 1);
    EXPECT_NEAR(value_of(cylinder, {1, 0.6, -0.8}), 0, 1e-12);
    EXPECT_NEAR(own_of(cylinder, {4, 0, 0}).z, 1, 1e-12);
    const Quadric cone = make_cone({0, 3, 0}, {0, 0, 0}, 1);
    EXPECT_NEAR(value_of(cone, {0.5, 1.5, 0}), 0, 1e-12);
    EXPECT_NEAR(own_of(cone, {0, 3, 0}).z, 0, 1e-12);
    // 2x^2 + y - 3xz = 4 has (1, 5, 1) and (2, 2, 1) on it.
    const Quadric general = make_quadric({2, 0, 0, 0, -3, 0, 0, 1, 0, -4}, {{0, 0, 0}, {3, 9, 2}});
    EXPECT_NEAR(value_of(general, {1, 5, 1}), 0, 1e-12);
    EXPECT_NEAR(value_of(general, {2, 2, 1}), 0, 1e-12);
    EXPECT_EQ(own_of(general, {0, 0, 0}), glm::dvec3(-1));
    EXPECT_EQ(own_of(general, {3, 9, 2}), glm::dvec3(1));
}

TEST(Quadric, TheGradientIsTheSlopeOfTheValue) {
    Random random(3);
    Quadric quadric;
    for (double& factor : quadric.coefficients) factor = random.uniform(-1, 1);
    const glm::dvec3 p = random.point(), gradient = quadric.gradient_at(p);
    for (int k = 0; k < 3; ++k) {
        glm::dvec3 step{0, 0, 0};
        step[k] = 1e-3;  // central differences of a quadric are exact
        EXPECT_NEAR(gradient[k], (quadric.value_at(p + step) - quadric.value_at(p - step)) / 2e-3,
                    1e-9);
    }
}

TEST(Quadric, BoundsHoldTheTessellationTightly) {
    for (const Quadric& plain :
         {make_sphere({1, 0, -1}, 2), make_cylinder({0, 0, 0}, {1, 2, 3}, 0.5),
          make_cone({0, 0, 0}, {1, -2, 3}, 1.5)}) {
        for (const glm::dmat4& by : {glm::dmat4(1.0), kSheared}) {
            const Quadric quadric = transformed(plain, by);
            const Box bounds = bounds_of(quadric);
            const Box mesh = tessellate_quadrics(scene_of(quadric), 256).bounds;
            for (int k = 0; k < 3; ++k) {
                EXPECT_NEAR(bounds.lo[k], mesh.lo[k], 2e-3 * bounds.extent()[k]);
                EXPECT_NEAR(bounds.hi[k], mesh.hi[k], 2e-3 * bounds.extent()[k]);
                EXPECT_LE(bounds.lo[k], mesh.lo[k] + 1e-12);
                EXPECT_GE(bounds.hi[k], mesh.hi[k] - 1e-12);
            }
        }
    }
}

TEST(Quadric, WhatIsFlatOrHugeIsNotRegular) {
    EXPECT_TRUE(is_regular(make_sphere({0, 0, 0}, 1e-20)));
    EXPECT_TRUE(is_regular(make_cylinder({0, 0, 0}, {1e6, 0, 0}, 1e-6)));
    EXPECT_FALSE(is_regular(make_sphere({0, 0, 0}, 1e31)));
    EXPECT_FALSE(is_regular(make_sphere({0, 0, 0}, 1e-40)));
    glm::dmat4 flat(1.0);
    flat[1][1] = 0;
    EXPECT_FALSE(is_regular(transformed(make_sphere({0, 0, 0}, 1), flat)));
    Quadric broken = make_sphere({0, 0, 0}, 1);
    broken.coefficients[3] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(is_regular(broken));
}

TEST(Tessellation, VerticesLieOnTheSurfaceAndFrontsFaceOutwards) {
    const std::array<double, 10> saddle{1, -1, 0, 0, 0, 0, 0, 0, -1, 0.1};
    const std::array<double, 10> ellipsoid{1, 2, 3, 0.5, 0, 0.2, 0, 0, 0, -1};
    for (const Quadric& plain :
         {make_sphere({1, 0, -1}, 2), make_cylinder({0, 0, 0}, {1, 2, 3}, 0.5),
          make_cone({0, 0, 0}, {1, -2, 3}, 1.5), make_quadric(saddle, {{-1, -1, -1}, {1, 1, 1}}),
          make_quadric(ellipsoid, {{-2, -2, -2}, {2, 2, 2}})}) {
        for (const glm::dmat4& by : {glm::dmat4(1.0), kSheared}) {  // the second one mirrors
            const Quadric quadric = transformed(plain, by);
            const Scene mesh = tessellate_quadrics(scene_of(quadric));
            ASSERT_GT(mesh.triangle_count(), 500u);
            EXPECT_TRUE(mesh.quadrics.empty());
            for (const glm::dvec3& p : mesh.positions) ASSERT_NEAR(value_of(quadric, p), 0, 1e-12);
            for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
                if (!mesh.degenerate.empty() && mesh.degenerate[t] != 0) continue;
                const Corners c = mesh.triangles[t], n = mesh.triangle_normals[t];
                const glm::dvec3 a = mesh.positions[c.x], b = mesh.positions[c.y],
                                 d = mesh.positions[c.z];
                const glm::dvec3 face = glm::cross(b - a, d - a);
                const glm::dvec3 mean(mesh.normals[n.x] + mesh.normals[n.y] + mesh.normals[n.z]);
                ASSERT_GT(glm::dot(face, mean), -1e-15) << t;
            }
        }
    }
}

TEST(Tessellation, ClosedSurfacesCloseAndHaveTheirArea) {
    const auto area = [](const Scene& mesh) {
        double sum = 0;
        for (const Corners& c : mesh.triangles) {
            const glm::dvec3 a = mesh.positions[c.x];
            sum += 0.5 * glm::length(glm::cross(mesh.positions[c.y] - a, mesh.positions[c.z] - a));
        }
        return sum;
    };
    using std::numbers::pi;
    const Scene sphere = tessellate_quadrics(scene_of(make_sphere({1, 2, 3}, 2)));
    EXPECT_TRUE(sphere.objects[0].closed);
    EXPECT_NEAR(area(sphere), 16 * pi, 0.15);
    const Scene marched = tessellate_quadrics(scene_of(
        make_quadric({1, 1, 1, 0, 0, 0, 0, 0, 0, -1}, {{-1.1, -1.2, -1.3}, {1.4, 1.5, 1.6}})));
    EXPECT_TRUE(marched.objects[0].closed);
    EXPECT_NEAR(area(marched), 4 * pi, 0.03);
    EXPECT_NEAR(area(tessellate_quadrics(scene_of(make_cylinder({0, 0, 0}, {0, 3, 0}, 1)))), 6 * pi,
                0.05);
    EXPECT_NEAR(area(tessellate_quadrics(scene_of(make_cone({0, 4, 0}, {0, 0, 0}, 3)))), 15 * pi,
                0.1);
}

TEST(Tessellation, WhatWasThereKeepsItsNumbers) {
    Scene scene = SceneBuilder().box({0, 0, 0}, {1, 1, 1}).build();
    add_quadric(scene, make_sphere({3, 0, 0}, 1), "ball", {});
    add_quadric(scene, make_cone({0, 3, 0}, {0, 0, 0}, 1), "hat", {});
    finish_scene(scene);
    EXPECT_EQ(scene.object_of(11), 0u);
    EXPECT_EQ(scene.object_of(12), 1u);
    EXPECT_EQ(scene.object_of(13), 2u);
    EXPECT_EQ(scene.bounds.hi.x, 4);
    const Scene mesh = tessellate_quadrics(scene);
    ASSERT_EQ(mesh.objects.size(), 3u);
    EXPECT_EQ(mesh.objects[1].name, "ball");
    EXPECT_EQ(mesh.objects[1].first_triangle, 12u);
    EXPECT_EQ(mesh.objects[2].first_triangle, 12 + mesh.objects[1].triangle_count);
    EXPECT_EQ(mesh.objects[2].first_polygon,
              mesh.objects[1].first_polygon + mesh.objects[1].polygon_count);
    EXPECT_EQ(mesh.triangle_polygon.size(), mesh.triangles.size());
    EXPECT_EQ(mesh.polygon_edges.size(), mesh.triangles.size());
    EXPECT_EQ(mesh.triangle_normals[11].x, kNone);
    EXPECT_EQ(mesh.object_of(mesh.triangle_count() - 1), 2u);
    EXPECT_EQ(mesh.objects[1].material, scene.objects[1].material);
    EXPECT_TRUE(std::equal(scene.triangles.begin(), scene.triangles.end(), mesh.triangles.begin()));
}

TEST(Tessellation, GrownScenesKeepTheirQuadrics) {
    Scene scene = SceneBuilder().box({0, 0, 0}, {1, 1, 1}).build();
    add_quadric(scene, make_sphere({3, 0, 0}, 1), "ball", {});
    finish_scene(scene);
    const Scene finer = must(subdivide(scene, 1));
    EXPECT_EQ(finer.quadrics.size(), 1u);
    EXPECT_EQ(finer.object_of(48), 1u);
    const Scene row = must(repeat(scene, {3, {10, 0, 0}, false}));
    ASSERT_EQ(row.quadrics.size(), 3u);
    EXPECT_EQ(row.objects.size(), 6u);
    EXPECT_EQ(row.object_of(35), 2u);
    EXPECT_EQ(row.object_of(38), 5u);
    EXPECT_EQ(row.bounds.hi.x, 24);
}

// The picture of the tessellation is that of the sphere, but for a rim.
TEST(Tessellation, LooksLikeTheSurface) {
    constexpr Resolution kSize{200, 200};
    const Scene exact = scene_of(make_sphere({0, 0, 0}, 1));
    const Scene mesh = tessellate_quadrics(exact, 256);
    const Camera camera = must(make_camera({}, exact.bounds, kSize));
    const ScreenScene a = must(project(exact, camera)), b = must(project(mesh, camera));
    const Visibility va = run("zbuffer", a), vb = run("zbuffer", b);
    std::uint32_t seen = 0, differ = 0;
    for (std::size_t i = 0; i < va.ids.size(); ++i) {
        const bool in_a = va.ids[i] != kNone, in_b = vb.ids[i] != kNone;
        seen += in_a;
        differ += in_a != in_b;
        EXPECT_TRUE(in_a || !in_b);  // the mesh is inside of the sphere
        if (in_a && in_b) {
            ASSERT_NEAR(a.metric_depth(va.depth[i]), b.metric_depth(vb.depth[i]), 0.03);
        }
    }
    EXPECT_GT(seen, 8000u);
    EXPECT_LT(differ, 20u);
}

}  // namespace
}  // namespace sightline
