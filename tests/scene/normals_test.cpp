#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <set>

#include "scene/meshes.hpp"
#include "sightline/scene.hpp"

namespace sightline {
namespace {

using scene_test::cube_scene;
using scene_test::make_one_object;

glm::dvec3 face_normal(const Scene& scene, std::uint32_t t) {
    const Corners& c = scene.triangles[t];
    const glm::dvec3 n = glm::cross(scene.positions[c.y] - scene.positions[c.x],
                                    scene.positions[c.z] - scene.positions[c.x]);
    return n / std::sqrt(glm::dot(n, n));
}

TEST(MakeNormals, ACubeIsFlatBelowItsCrease) {
    Scene scene = cube_scene();
    make_normals(scene, 30);
    ASSERT_EQ(scene.triangle_normals.size(), 12u);
    EXPECT_EQ(scene.normals.size(), 24u) << "one a corner and side, shared by the side's halves";
    for (std::uint32_t t = 0; t < 12; ++t) {
        for (int k = 0; k < 3; ++k) {
            EXPECT_EQ(glm::dvec3(scene.normals[scene.triangle_normals[t][k]]),
                      face_normal(scene, t));
        }
    }
}

TEST(MakeNormals, ACubeSharesNormalsAboveItsCrease) {
    Scene scene = cube_scene();
    make_normals(scene, 100);
    EXPECT_EQ(scene.normals.size(), 8u);
    for (std::uint32_t t = 0; t < 12; ++t) {
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 expected =
                (scene.positions[scene.triangles[t][k]] * 2.0 - 1.0) / std::sqrt(3.0);
            const glm::dvec3 normal(scene.normals[scene.triangle_normals[t][k]]);
            // Weighted by angle, the diagonals of the sides make no difference.
            EXPECT_LT(glm::dot(normal - expected, normal - expected), 1e-12);
        }
    }
}

TEST(MakeNormals, ExactlyTheCreaseAngleIsSmooth) {
    Scene scene = cube_scene();
    make_normals(scene, 90);
    EXPECT_EQ(scene.normals.size(), 8u);
    make_normals(scene, 89.9);
    EXPECT_EQ(scene.normals.size(), 24u) << "made anew, without leftovers";
}

TEST(MakeNormals, AFlatQuadIsSmoothAtZero) {
    Scene scene;
    scene.positions = {{0.1, 0.7, 0.3}, {1.3, 0.2, 0.9}, {1.9, 1.1, 0.2}, {0.7, 1.6, -0.4}};
    scene.triangles = {{0, 1, 2}, {0, 2, 3}};
    make_one_object(scene);
    make_normals(scene, 0);
    EXPECT_EQ(scene.normals.size(), 4u);
}

TEST(MakeNormals, ASphereIsSmooth) {
    Scene scene;
    const unsigned rings = 16, sectors = 32;
    for (unsigned i = 0; i <= rings; ++i) {
        for (unsigned j = 0; j < sectors; ++j) {
            const double theta = i * 3.141592653589793 / rings,
                         phi = j * 6.283185307179586 / sectors;
            const double r = i == 0 || i == rings ? 0 : std::sin(theta);
            scene.positions.emplace_back(r * std::cos(phi), r * std::sin(phi),
                                         i == 0       ? 1
                                         : i == rings ? -1
                                                      : std::cos(theta));
        }
    }
    for (unsigned i = 0; i < rings; ++i) {
        for (unsigned j = 0; j < sectors; ++j) {
            const unsigned k = (j + 1) % sectors, a = i * sectors, b = a + sectors;
            scene.triangles.emplace_back(a + j, b + j, b + k);
            scene.triangles.emplace_back(a + j, b + k, a + k);
        }
    }
    make_one_object(scene);
    finish_scene(scene);
    EXPECT_TRUE(scene.objects[0].closed) << "the collapsed triangles at the poles do not count";
    make_normals(scene, 30);
    EXPECT_EQ(scene.normals.size(), (rings - 1) * sectors + 2) << "one a point";
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
        for (int k = 0; k < 3; ++k) {
            if (scene.degenerate[t] != 0) {
                EXPECT_EQ(scene.triangle_normals[t][k], kNone);
                continue;
            }
            const glm::dvec3 normal(scene.normals[scene.triangle_normals[t][k]]);
            EXPECT_GT(glm::dot(normal, scene.positions[scene.triangles[t][k]]), 0.999);
        }
    }
}

TEST(MakeNormals, NormalsOfFilesStayUnlessReplaced) {
    Scene scene = cube_scene();
    scene.objects[0].has_file_normals = true;
    scene.normals = {{0, 0, 1}};
    scene.triangle_normals.assign(12, Corners(0));
    scene.triangle_normals[3] = Corners(kNone);  // broken in the file
    make_normals(scene, 30);
    EXPECT_EQ(scene.triangle_normals[0], Corners(0));
    for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(glm::dvec3(scene.normals[scene.triangle_normals[3][k]]), face_normal(scene, 3));
    }
    make_normals(scene, 30, true);
    EXPECT_EQ(scene.normals.size(), 24u);
}

}  // namespace
}  // namespace sightline
