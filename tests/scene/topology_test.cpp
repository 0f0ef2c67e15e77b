#include "scene/topology.hpp"

#include <gtest/gtest.h>

#include "scene/meshes.hpp"
#include "sightline/scene.hpp"

namespace sightline {
namespace {

using scene_test::append_cube;
using scene_test::cube_scene;
using scene_test::make_one_object;

bool closed(Scene scene) {
    make_one_object(scene);
    find_closed_objects(scene);
    return scene.objects[0].closed;
}

void turn_over(Corners& triangle) { std::swap(triangle.y, triangle.z); }

TEST(Closedness, ACubeIsClosed) { EXPECT_TRUE(closed(cube_scene())); }

TEST(Closedness, ACubeWhoseFacesShareNoIndicesIsClosed) {
    Scene apart;
    const Scene cube = cube_scene();
    for (const Corners& t : cube.triangles) {
        const auto base = static_cast<std::uint32_t>(apart.positions.size());
        for (int k = 0; k < 3; ++k) apart.positions.push_back(cube.positions[t[k]]);
        apart.triangles.emplace_back(base, base + 1, base + 2);
    }
    apart.positions[0] = -apart.positions[0];  // (-0, -0, -0) equals (0, 0, 0)
    EXPECT_TRUE(closed(apart));
}

TEST(Closedness, AMissingFaceOpens) {
    for (std::size_t t = 0; t < 12; ++t) {
        Scene scene = cube_scene();
        scene.triangles.erase(scene.triangles.begin() + static_cast<std::ptrdiff_t>(t));
        EXPECT_FALSE(closed(scene));
    }
}

TEST(Closedness, AFlippedFaceOpens) {
    for (std::size_t t = 0; t < 12; ++t) {
        Scene scene = cube_scene();
        turn_over(scene.triangles[t]);
        EXPECT_FALSE(closed(scene));
    }
}

TEST(Closedness, InsideOutIsNotClosed) {
    Scene scene = cube_scene();
    for (Corners& t : scene.triangles) turn_over(t);
    EXPECT_FALSE(closed(scene));
}

TEST(Closedness, PartsCountOneByOne) {
    Scene two = cube_scene();
    append_cube(two, {3, 0, 0});
    EXPECT_TRUE(closed(two));
    for (std::size_t t = 12; t < 24; ++t) turn_over(two.triangles[t]);
    EXPECT_FALSE(closed(two)) << "the second cube is inside out";
}

TEST(Closedness, AnEdgeOfFourFacesIsNotClosed) {
    Scene scene = cube_scene();
    append_cube(scene, {1, 1, 0});
    EXPECT_FALSE(closed(scene));
}

TEST(Closedness, TwoFacesBackToBackEncloseNothing) {
    Scene scene;
    scene.positions = {{0.1, 0.2, 0.3}, {1.7, 0.1, 0.9}, {0.3, 1.3, 2.7}};
    scene.triangles = {{0, 1, 2}, {0, 2, 1}};
    EXPECT_FALSE(closed(scene));
}

TEST(Closedness, CollapsedTrianglesDoNotCount) {
    Scene scene = cube_scene();
    scene.triangles.emplace_back(0, 0, 1);
    EXPECT_TRUE(closed(scene));
}

TEST(Closedness, ADroppedSliverLeavesAHole) {
    // The middle of an edge is inserted into one of its faces only, filled up by a triangle
    // without area.
    Scene scene = cube_scene();
    const Corners first = scene.triangles[0];
    scene.positions.push_back(0.5 * (scene.positions[first.x] + scene.positions[first.y]));
    const auto middle = static_cast<std::uint32_t>(scene.positions.size() - 1);
    scene.triangles[0] = {first.x, middle, first.z};
    scene.triangles.emplace_back(middle, first.y, first.z);
    scene.triangles.emplace_back(first.x, first.y, middle);
    EXPECT_FALSE(closed(scene));
}

TEST(Closedness, AFanOfManyFacesIsQuick) {
    Scene scene;
    const std::uint32_t n = 200000;
    scene.positions = {{0, 0, 1}, {0, 0, -1}};
    for (std::uint32_t i = 0; i < n; ++i) {
        // Any positions around the axis do; they need not be evenly spaced.
        const double x = 2.0 * i / n - 1;
        const double y = 1 - x * x;
        scene.positions.emplace_back(x, i % 2 == 0 ? y : -y, 0.0);
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t a = 2 + i, b = 2 + (i + 1) % n;
        scene.triangles.emplace_back(a, b, 0u);
        scene.triangles.emplace_back(b, a, 1u);
    }
    make_one_object(scene);
    find_closed_objects(scene);
    make_normals(scene, 30);
    EXPECT_EQ(scene.triangle_normals.size(), scene.triangles.size());
}

TEST(FinishScene, FindsDegenerateTrianglesAndBounds) {
    Scene scene = cube_scene();
    finish_scene(scene);
    EXPECT_TRUE(scene.degenerate.empty());
    EXPECT_EQ(scene.counts.polygons, 12u);
    EXPECT_EQ(scene.bounds.lo, glm::dvec3(0, 0, 0));
    EXPECT_EQ(scene.bounds.hi, glm::dvec3(1, 1, 1));
    EXPECT_TRUE(scene.objects[0].closed);

    scene.positions.emplace_back(9, 9, 9);    // used by no triangle
    scene.positions.emplace_back(0.5, 0, 0);  // on an edge
    scene.triangles.emplace_back(0, 1, 9);    // without area
    scene.triangles.emplace_back(0, 1, 0);    // two corners equal
    make_one_object(scene);
    finish_scene(scene);
    ASSERT_EQ(scene.degenerate.size(), 14u);
    EXPECT_EQ(scene.degenerate[11], 0);
    EXPECT_EQ(scene.degenerate[12], 1);
    EXPECT_EQ(scene.degenerate[13], 1);
    EXPECT_EQ(scene.counts.degenerate_triangles, 2u);
    EXPECT_EQ(scene.bounds.hi, glm::dvec3(1, 1, 1));
}

TEST(FinishScene, ObjectOfSkipsEmptyObjects) {
    Scene scene = cube_scene();
    Object empty;
    Object second = scene.objects[0];
    scene.objects[0].triangle_count = 5;
    empty.first_triangle = second.first_triangle = 5;
    second.triangle_count = 7;
    scene.objects.push_back(empty);
    scene.objects.push_back(second);
    EXPECT_EQ(scene.object_of(4), 0u);
    EXPECT_EQ(scene.object_of(5), 2u);
    EXPECT_EQ(scene.object_of(11), 2u);
}

}  // namespace
}  // namespace sightline
