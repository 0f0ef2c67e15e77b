// Growing scenes: positions bit for bit, and polygons, objects and sides that stay consistent.
#include "sightline/generate.hpp"

#include <gtest/gtest.h>

namespace sightline {
namespace {

/// A square in two triangles and a lone triangle, two objects.
Scene two_objects() {
    Scene scene;
    scene.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {5, 5, 5}, {6, 5, 5}, {5, 6, 5}};
    scene.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}};
    scene.triangle_polygon = {0, 0, 1};
    scene.polygon_edges = {0b011, 0b110, 0b111};
    scene.materials.emplace_back();
    Object square, lone;
    square.triangle_count = 2;
    square.polygon_count = 1;
    lone.first_triangle = 2;
    lone.triangle_count = 1;
    lone.first_polygon = 1;
    lone.polygon_count = 1;
    scene.objects = {square, lone};
    finish_scene(scene);
    return scene;
}

TEST(Subdivide, ChildrenKeepTheirPolygonAndShareTheMiddles) {
    const Scene scene = two_objects();
    const auto finer = subdivide(scene, 1);
    ASSERT_TRUE(finer.ok());
    ASSERT_EQ(finer->triangle_count(), 12u);
    EXPECT_EQ(finer->positions.size(), 7u + 5u + 3u);  // the diagonal's middle is shared
    EXPECT_EQ(finer->triangle_polygon,
              (std::vector<std::uint32_t>{0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1}));
    EXPECT_EQ(finer->objects[1].first_triangle, 8u);
    EXPECT_EQ(finer->objects[1].triangle_count, 4u);
    EXPECT_EQ(finer->counts.polygons, 2u);
    EXPECT_EQ(finer->bounds, scene.bounds);
    // The diagonal of the square (side 2 of triangle 0) stays no edge; the middle child has none.
    EXPECT_EQ(finer->polygon_edges[0], 0b001);
    EXPECT_EQ(finer->polygon_edges[1], 0b011);
    EXPECT_EQ(finer->polygon_edges[2], 0b010);
    EXPECT_EQ(finer->polygon_edges[3], 0);
    EXPECT_EQ(finer->positions[finer->triangles[0].y], glm::dvec3(0.5, 0, 0));
}

TEST(Subdivide, MiddlesAreThoseOfSinglePrecision) {
    Scene scene = two_objects();
    scene.positions[0].x = 0.1f;
    scene.positions[1].x = 0.7f;
    const auto finer = subdivide(scene, 1);
    ASSERT_TRUE(finer.ok());
    EXPECT_EQ(finer->positions[finer->triangles[0].y].x, double{0.5f * (0.1f + 0.7f)});
}

TEST(Subdivide, TooManyTrianglesAreAnError) {
    EXPECT_FALSE(subdivide(two_objects(), -1).ok());
    const auto huge = subdivide(two_objects(), 15);
    ASSERT_FALSE(huge.ok());
    EXPECT_EQ(huge.error().kind, ErrorKind::bad_option);
    EXPECT_EQ(subdivide(two_objects(), 0)->triangle_count(), 3u);
}

TEST(Repeat, CopiesAreNumberedOnAndMoved) {
    const Scene scene = two_objects();
    const auto copies = repeat(scene, {3, {0, 0, 0.1}, false});
    ASSERT_TRUE(copies.ok());
    EXPECT_EQ(copies->triangle_count(), 9u);
    ASSERT_EQ(copies->objects.size(), 6u);
    EXPECT_EQ(copies->objects[5].first_triangle, 8u);
    EXPECT_EQ(copies->objects[5].first_polygon, 5u);
    EXPECT_EQ(copies->triangle_polygon[8], 5u);
    EXPECT_EQ(copies->counts.polygons, 6u);
    EXPECT_EQ(copies->positions[7].z, double{static_cast<float>(0.1)});
    EXPECT_EQ(copies->triangles[3], Corners(7, 8, 9));
    const auto reversed = repeat(scene, {3, {0, 0, 0.1}, true});
    ASSERT_TRUE(reversed.ok());
    EXPECT_EQ(reversed->positions[0], copies->positions[14]);
    EXPECT_FALSE(repeat(scene, {0, {}, false}).ok());
    EXPECT_FALSE(repeat(scene, {0xFFFFFFFFu, {}, false}).ok());
}

TEST(RandomTriangles, AreTheSameEachTimeAndInTheCube) {
    const auto a = random_triangles(100), b = random_triangles(100), c = random_triangles(100, 2);
    ASSERT_TRUE(a.ok() && b.ok() && c.ok());
    EXPECT_EQ(a->positions, b->positions);
    EXPECT_NE(a->positions, c->positions);
    EXPECT_EQ(a->triangle_count(), 100u);
    for (const glm::dvec3& p : a->positions) {
        for (int k = 0; k < 3; ++k) EXPECT_TRUE(p[k] >= 0 && p[k] <= 1);
    }
    EXPECT_FALSE(random_triangles(0).ok());
    EXPECT_EQ(random_triangles(1)->triangle_count(), 1u);
}

}  // namespace
}  // namespace sightline
