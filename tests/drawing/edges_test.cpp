// Which edges of a scene are drawn, and why.
#include "drawing/edges.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drawing/pages.hpp"

namespace sightline {
namespace {

using namespace testing;

constexpr Resolution kPage{100, 100};

std::vector<EdgeKind> kinds_of(const Scene& scene, const Camera& camera, double crease_angle = 30,
                               EdgeKinds wanted = kMeshEdges) {
    std::vector<EdgeKind> kinds;
    for (const SceneEdge& edge : find_edges(page(scene, camera), wanted, crease_angle, 0).edges)
        kinds.push_back(edge.kind);
    return kinds;
}

std::ptrdiff_t count(const std::vector<EdgeKind>& kinds, EdgeKind kind) {
    return std::ranges::count(kinds, kind);
}

TEST(DrawnEdges, KindsHaveNames) {
    EXPECT_EQ(name_of(EdgeKind::silhouette), "silhouette");
    EXPECT_EQ(name_of(EdgeKind::mesh), "mesh");
    EXPECT_FALSE(kFeatureEdges.has(EdgeKind::mesh));
    EXPECT_FALSE(kMeshEdges.has(EdgeKind::intersection));
    EXPECT_TRUE(EdgeKinds{}.empty());
}

TEST(DrawnEdges, DiagonalsOfFlatPolygonsAreNone) {
    SceneBuilder b;
    b.polygon({{-30, -20, 0}, {10, -30, 0}, {30, 0, 0}, {10, 30, 0}, {-30, 20, 0}});
    EXPECT_EQ(kinds_of(b.build(), pixel_camera(kPage)),
              std::vector<EdgeKind>(5, EdgeKind::boundary));
    SceneBuilder tilted;  // whatever rounding makes of it
    const glm::dvec3 u(0.31, 0.2, 0.7), v(-0.4, 0.63, 0.11), o(0.1, 0.7, 0.3);
    tilted.quad(o, o + u, o + u + v, o + v);
    const Scene scene = tilted.build();
    for (std::uint64_t seed = 0; seed < 200; ++seed)
        EXPECT_EQ(kinds_of(scene, hostile_camera(scene, seed, kPage)).size(), 4u) << seed;
}

// Seen edge-on, each half of the square may seem to show another side.
TEST(DrawnEdges, DiagonalsOfFlatPolygonsSeenEdgeOnAreNone) {
    SceneBuilder b;
    const glm::dvec3 u(1, 0.3, 0.1), v(0.2, -0.7, 0.9);
    b.quad(-u - v, u - v, u + v, v - u);
    const Scene scene = b.build();
    for (int k = 0; k < 50; ++k) {
        CameraOptions options;
        options.direction = std::cos(0.1 * k) * u + std::sin(0.1 * k) * v;
        options.up = glm::dvec3(0.1, 1, 0.2);
        options.projection = k % 2 == 0 ? Projection::orthographic : Projection::perspective;
        EXPECT_EQ(kinds_of(scene, must(make_camera(options, scene.bounds, kPage))).size(), 4u) << k;
    }
}

/// Two squares that meet at an angle along the y axis.
Scene fold(double degrees) {
    const double a = degrees * std::acos(-1.0) / 180;
    SceneBuilder b;
    b.quad({-20, -20, 0}, {0, -20, 0}, {0, 20, 0}, {-20, 20, 0});
    const double x = 20 * std::cos(a), z = -20 * std::sin(a);
    b.quad({0, -20, 0}, {x, -20, z}, {x, 20, z}, {0, 20, 0});
    return b.build();
}

TEST(DrawnEdges, CreasesBeginAboveTheAngle) {
    const Camera camera = pixel_camera(kPage);
    for (const double angle : {1.0, 20.0, 45.0, 80.0}) {
        EXPECT_EQ(count(kinds_of(fold(angle), camera, angle), EdgeKind::crease), 0) << angle;
        EXPECT_EQ(count(kinds_of(fold(angle), camera, angle), EdgeKind::mesh), 1) << angle;
        EXPECT_EQ(count(kinds_of(fold(angle), camera, angle - 0.01), EdgeKind::crease), 1) << angle;
        EXPECT_EQ(count(kinds_of(fold(angle), camera, angle + 0.01), EdgeKind::crease), 0) << angle;
    }
    EXPECT_EQ(count(kinds_of(fold(0), camera, 0), EdgeKind::crease), 0);
    EXPECT_EQ(count(kinds_of(fold(80), camera, 180), EdgeKind::crease), 0);
    // Beyond the right angle the fold is the contour.
    EXPECT_EQ(count(kinds_of(fold(120), camera), EdgeKind::silhouette), 1);
}

TEST(DrawnEdges, ASphereShowsItsContour) {
    const Scene scene = sphere_scene(24, 36);
    const Camera camera = must(make_camera({}, scene.bounds, {300, 300}));
    const auto kinds = kinds_of(scene, camera, 30, kFeatureEdges);
    EXPECT_EQ(count(kinds, EdgeKind::silhouette), static_cast<std::ptrdiff_t>(kinds.size()));
    EXPECT_GT(kinds.size(), 30u);
    EXPECT_LT(kinds.size(), 100u);
    // Once around: the perimeter of a circle, nearly.
    const Drawing d = must(trace(page(scene, camera), with_hidden()));
    double area = 0;
    for (const FaceArea& a : must(visible_areas(page(scene, camera), {}))) area += a.visible;
    const double circle = 2 * std::sqrt(std::acos(-1.0) * area);
    EXPECT_NEAR(length_of(d, kFeatureEdges, true), circle, 0.02 * circle);
    EXPECT_NEAR(length_of(d, kFeatureEdges, false), 0, 0.01);
}

/// Objects of two quads each.
void split_objects(Scene& scene) {
    const Object whole = scene.objects[0];
    scene.objects.clear();
    for (std::uint32_t k = 0; k < whole.polygon_count; k += 2) {
        Object part = whole;
        part.first_polygon = k;
        part.first_triangle = 2 * k;
        part.polygon_count = 2;
        part.triangle_count = 4;
        scene.objects.push_back(part);
    }
    finish_scene(scene);
}

TEST(DrawnEdges, ObjectsHaveABorderBetweenThem) {
    SceneBuilder b;
    for (int k = 0; k < 4; ++k) add_square(b, {-40 + 20 * k, -10}, {-20 + 20 * k, 10}, 0);
    Scene scene = b.build();
    const Camera camera = pixel_camera(kPage);
    EXPECT_EQ(count(kinds_of(scene, camera), EdgeKind::mesh), 3);
    split_objects(scene);
    const auto kinds = kinds_of(scene, camera);
    EXPECT_EQ(count(kinds, EdgeKind::mesh), 2);
    EXPECT_EQ(count(kinds, EdgeKind::border), 1);
    EXPECT_EQ(count(kinds, EdgeKind::boundary), 10);
    // The same where the objects have positions of their own.
    Scene apart = b.scene;
    split_objects(apart);
    const auto unjoined = kinds_of(apart, camera);
    EXPECT_EQ(count(unjoined, EdgeKind::border), 1);
}

TEST(DrawnEdges, EdgesOfThreeFacesAreDrawn) {
    SceneBuilder b;
    b.quad({0, -20, 0}, {20, -20, -2}, {20, 20, -2}, {0, 20, 0});
    b.quad({-20, -20, -2}, {0, -20, 0}, {0, 20, 0}, {-20, 20, -2});
    b.quad({0, -20, 0}, {3, -20, -20}, {3, 20, -20}, {0, 20, 0});
    const Scene scene = b.build();
    const ScreenScene screen = page(scene, pixel_camera(kPage));
    const SceneEdges edges = find_edges(screen, kFeatureEdges, 180, 0);
    EXPECT_EQ(std::ranges::count(edges.edges, 3u, &SceneEdge::face_count), 1);
    const Drawing d = must(trace(screen, with_hidden()));
    EXPECT_EQ(length_along(d, {50, 30}, {50, 70}, true), 40);
}

TEST(DrawnEdges, DegenerateTrianglesHaveNoEdges) {
    SceneBuilder b;
    b.triangle({0, 0, 0}, {10, 0, 0}, {20, 0, 0});
    b.triangle({5, 5, 0}, {5, 5, 0}, {20, 8, 0});
    EXPECT_TRUE(kinds_of(b.build(), pixel_camera(kPage)).empty());
    b.triangle({0, 0, 0}, {10, 0, 0}, {0, 10, 0});
    EXPECT_EQ(kinds_of(b.build(), pixel_camera(kPage)),
              std::vector<EdgeKind>(3, EdgeKind::boundary));
}

TEST(DrawnEdges, DoNotDependOnTheNumberOfThreads) {
    const Scene scene = sphere_scene(100, 120);
    const ScreenScene screen = page(scene, must(make_camera({}, scene.bounds, {300, 300})));
    const SceneEdges one = find_edges(screen, kMeshEdges, 1, 1);
    for (const int threads : {2, 8}) {
        const SceneEdges many = find_edges(screen, kMeshEdges, 1, threads);
        EXPECT_EQ(one.faces, many.faces);
        EXPECT_TRUE(std::ranges::equal(one.edges, many.edges, [](auto& e, auto& f) {
            return e.a == f.a && e.b == f.b && e.kind == f.kind && e.first_face == f.first_face;
        }));
    }
    EXPECT_EQ(one.edges.size(), scene.positions.size() + 98u * 120 + 240 - 2);  // Euler
}

}  // namespace
}  // namespace sightline
