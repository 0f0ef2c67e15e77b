// Visible areas: against known ones, against the silhouette, and against each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "drawing/pages.hpp"
#include "math/predicates.hpp"
#include "support/models.hpp"

namespace sightline {
namespace {

using namespace testing;

struct Sums {
    double projected = 0, visible = 0;
};

Sums sums_of(const std::vector<FaceArea>& areas) {
    Sums sums;
    for (const FaceArea& area : areas) {
        sums.projected += area.projected;
        sums.visible += area.visible;
    }
    return sums;
}

std::vector<FaceArea> areas_of(const Scene& scene, const Camera& camera, Cull cull = Cull::none) {
    return must(visible_areas(page(scene, camera, cull), {}));
}

// -- the silhouette, found in another way
// ----------------------------------------------------------

struct Segment {
    glm::dvec2 low, high;  // low.y < high.y
};
using FlatTriangle = std::array<glm::dvec2, 3>;

std::vector<FlatTriangle> flat_triangles(const ScreenScene& page) {
    std::vector<FlatTriangle> all;
    for (std::uint32_t k = 0; k < page.triangle_count(); ++k) {
        if (!page.drawable(k)) continue;
        const Corners c = page.corners(k);
        const auto at = [&](std::uint32_t i) {
            return glm::dvec2(page.point(i).x, page.point(i).y);
        };
        all.push_back({at(c.x), at(c.y), at(c.z)});
    }
    return all;
}

std::vector<Segment> sides_of(const std::vector<FlatTriangle>& triangles) {
    std::vector<Segment> all;
    for (const FlatTriangle& t : triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec2 &p = t[k], &q = t[(k + 1) % 3];
            if (p.y != q.y) all.push_back(p.y < q.y ? Segment{p, q} : Segment{q, p});
        }
    return all;
}

/// Heights at which something begins, ends or crosses: between two of them all is straight.
std::vector<double> heights_of(const std::vector<Segment>& sides,
                               const std::vector<FlatTriangle>& triangles) {
    std::vector<double> heights;
    for (const FlatTriangle& t : triangles)
        for (const glm::dvec2& p : t) heights.push_back(p.y);
    for (std::size_t i = 0; i < sides.size(); ++i)
        for (std::size_t j = i + 1; j < sides.size(); ++j) {
            const glm::dvec2 u = sides[i].high - sides[i].low, v = sides[j].high - sides[j].low;
            const double cross = u.x * v.y - u.y * v.x;
            if (cross == 0) continue;
            const glm::dvec2 d = sides[j].low - sides[i].low;
            const double s = (d.x * v.y - d.y * v.x) / cross, t = (d.x * u.y - d.y * u.x) / cross;
            if (s > 0 && s < 1 && t > 0 && t < 1) heights.push_back(sides[i].low.y + s * u.y);
        }
    std::ranges::sort(heights);
    return heights;
}

/// How much of a level line lies in triangles.
double covered_length(const std::vector<FlatTriangle>& triangles, double y) {
    std::vector<std::pair<double, double>> spans;
    for (const FlatTriangle& t : triangles) {
        double left = 1e300, right = -1e300;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec2 &p = t[k], &q = t[(k + 1) % 3];
            if ((p.y > y) == (q.y > y)) continue;
            const double x = p.x + (y - p.y) / (q.y - p.y) * (q.x - p.x);
            left = std::min(left, x);
            right = std::max(right, x);
        }
        if (left < right) spans.emplace_back(left, right);
    }
    std::ranges::sort(spans);
    double sum = 0, at = -1e300;
    for (const auto& [left, right] : spans) {
        sum += std::max(0.0, right - std::max(left, at));
        at = std::max(at, right);
    }
    return sum;
}

/// In pixels^2.
double silhouette_area(const ScreenScene& page) {
    const std::vector<FlatTriangle> triangles = flat_triangles(page);
    const std::vector<double> heights = heights_of(sides_of(triangles), triangles);
    double sum = 0;
    for (std::size_t i = 1; i < heights.size(); ++i)
        if (heights[i] > heights[i - 1])
            sum += (heights[i] - heights[i - 1]) *
                   covered_length(triangles, 0.5 * (heights[i] + heights[i - 1]));
    return std::ldexp(sum, -2 * page.subpixel_bits());
}

TEST(VisibleAreas, SumUpToTheSilhouetteOfHostileScenes) {
    int done = 0;
    for (std::uint64_t seed = 0; done < (std::getenv("SIGHTLINE_FULL") != nullptr ? 300 : 25);
         ++seed) {
        const Scene scene = hostile_scene(seed);
        const ScreenScene screen = page(scene, hostile_camera(scene, seed, {300, 200}));
        if (flat_triangles(screen).size() > 45) continue;
        ++done;
        const double expected = silhouette_area(screen);
        EXPECT_NEAR(sums_of(must(visible_areas(screen, {}))).visible, expected, 1e-9 * expected)
            << "seed " << seed;
    }
}

/// The page itself as a scene: every triangle at one depth, so that all are one sheet.
Scene flattened(const ScreenScene& page) {
    const double step = std::ldexp(1.0, -page.subpixel_bits());
    const double w = 0.5 * page.resolution().width, h = 0.5 * page.resolution().height;
    SceneBuilder b;
    for (const FlatTriangle& t : flat_triangles(page)) {
        const auto at = [&](const glm::dvec2& p) {
            return glm::dvec3(step * p.x - w, h - step * p.y, 0);
        };
        b.triangle(at(t[0]), at(t[1]), at(t[2]));
    }
    return b.build();
}

// In one plane nothing but ids tells what is in front: the union is the same.
void expect_area_of_flattened(const ScreenScene& screen, const std::string& what) {
    const double visible = sums_of(must(visible_areas(screen, {}))).visible;
    const Scene flat = flattened(screen);
    const double expected = sums_of(areas_of(flat, pixel_camera(screen.resolution()))).visible;
    EXPECT_GT(expected, 0) << what;
    EXPECT_NEAR(visible, expected, 1e-9 * expected) << what;
}

TEST(VisibleAreas, SumUpToThoseOfTheFlattenedScene) {
    for (std::uint64_t seed = 0; seed < amount(100, 100, 20); ++seed) {
        const Scene scene = hostile_scene(seed);
        const ScreenScene screen = page(scene, hostile_camera(scene, seed, {256, 256}));
        if (sums_of(must(visible_areas(screen, {}))).visible > 1)
            expect_area_of_flattened(screen, "seed " + std::to_string(seed));
    }
    const Scene sphere = sphere_scene(24, 36);
    expect_area_of_flattened(page(sphere, must(make_camera({}, sphere.bounds, {256, 256}))),
                             "sphere");
}

TEST(VisibleAreas, SumUpToTheFlattenedOnesOfAModel) {
    const std::optional<Scene> scene = real_model("cow.obj");
    if (!scene) GTEST_SKIP() << "cow.obj is not there; set SIGHTLINE_MODELS";
    expect_area_of_flattened(page(*scene, must(make_camera({}, scene->bounds, {256, 256}))), "cow");
}

// -- known areas
// -----------------------------------------------------------------------------------

TEST(VisibleAreas, OfASquareBehindASmallerOne) {
    SceneBuilder b;
    add_square(b, {-40, -40}, {40, 40}, -5);
    add_square(b, {-10, -20}, {20, 30}, 5);
    const auto areas = areas_of(b.build(), pixel_camera({100, 100}));
    EXPECT_NEAR(areas[0].visible + areas[1].visible, 80 * 80 - 30 * 50, 1e-9);
    EXPECT_NEAR(areas[2].visible + areas[3].visible, 30 * 50, 1e-9);
    EXPECT_EQ(areas[0].projected, 3200);
}

TEST(VisibleAreas, OfTwoThatOverlapInOnePlaneTheFirstHasThePart) {
    SceneBuilder b;
    add_square(b, {-40, -40}, {10, 10}, 0);
    add_square(b, {-10, -10}, {40, 40}, 0);
    const auto areas = areas_of(b.build(), pixel_camera({100, 100}));
    EXPECT_NEAR(areas[0].visible + areas[1].visible, 2500, 1e-9);
    EXPECT_NEAR(areas[2].visible + areas[3].visible, 2500 - 400, 1e-9);
}

TEST(VisibleAreas, OfASquareSeenThroughAHole) {
    SceneBuilder b;
    add_square(b, {-40, -40}, {40, -10}, 5);
    add_square(b, {-40, 10}, {40, 40}, 5);
    add_square(b, {-40, -10}, {-10, 10}, 5);
    add_square(b, {10, -10}, {40, 10}, 5);
    add_square(b, {-30, -30}, {30, 30}, -5);
    const auto areas = areas_of(b.build(), pixel_camera({100, 100}));
    EXPECT_NEAR(areas[8].visible + areas[9].visible, 20 * 20, 1e-9);
    EXPECT_NEAR(sums_of(areas).visible, 80 * 80, 1e-9);
}

TEST(VisibleAreas, OfSquaresThatCrossHalfOfEach) {
    SceneBuilder b;
    b.quad({-40, -20, -20}, {40, -20, 20}, {40, 20, 20}, {-40, 20, -20});
    b.quad({-40, -20, 20}, {40, -20, -20}, {40, 20, -20}, {-40, 20, 20});
    const auto areas = areas_of(b.build(), pixel_camera({100, 100}));
    EXPECT_NEAR(areas[0].visible + areas[1].visible, 1600, 1e-4);  // depths are snapped
    EXPECT_NEAR(areas[2].visible + areas[3].visible, 1600, 1e-4);
}

TEST(VisibleAreas, OfACubeFromTheFrontAndFromACorner) {
    SceneBuilder b;
    b.box({-20, -20, -20}, {20, 20, 20});
    const Scene cube = b.build();
    EXPECT_NEAR(sums_of(areas_of(cube, pixel_camera({100, 100}))).visible, 1600, 1e-9);
    CameraOptions options;
    options.view = NamedView::isometric;
    options.projection = Projection::orthographic;
    options.ortho_height = 100;
    for (const Cull cull : {Cull::none, Cull::automatic}) {
        const auto areas =
            areas_of(cube, must(make_camera(options, cube.bounds, {100, 100})), cull);
        // A hexagon: three faces, each shortened by the square root of 3.
        EXPECT_NEAR(sums_of(areas).visible, 3 * 1600 / std::sqrt(3.0), 0.01);
        EXPECT_NEAR(sums_of(areas).projected, 6 * 1600 / std::sqrt(3.0), 0.02);
        // Backs that snapping shows along the silhouette are hidden all the same.
        EXPECT_EQ(std::ranges::count_if(areas, [](const FaceArea& a) { return a.visible > 0; }), 6);
    }
}

TEST(VisibleAreas, OfASphereAreThoseOfItsFronts) {
    const Scene sphere = sphere_scene(24, 36);
    const Camera camera = must(make_camera({}, sphere.bounds, {200, 200}));
    const auto all = areas_of(sphere, camera), fronts = areas_of(sphere, camera, Cull::back);
    EXPECT_NEAR(sums_of(all).projected / 2, sums_of(all).visible, 1e-4 * sums_of(all).visible);
    EXPECT_NEAR(sums_of(all).visible, sums_of(fronts).visible, 1e-9 * sums_of(all).visible);
    EXPECT_NEAR(sums_of(all).projected, sums_of(fronts).projected, 1e-9 * sums_of(all).projected);
}

// What lies outside of the page does not count: the picture holds a quarter of the square.
TEST(VisibleAreas, EndAtTheBordersOfThePage) {
    SceneBuilder b;
    add_square(b, {0, 0}, {1000, 1000}, 0);
    add_square(b, {-500, 20}, {500, 30}, 3);
    for (const Cull cull : {Cull::none, Cull::back, Cull::front}) {
        const auto areas = areas_of(b.build(), pixel_camera({100, 80}), cull);
        EXPECT_NEAR(areas[0].projected + areas[1].projected, 50 * 40, 1e-4);
        EXPECT_NEAR(areas[2].projected + areas[3].projected, 100 * 10, 1e-4);
        EXPECT_NEAR(areas[0].visible + areas[1].visible,
                    cull == Cull::front ? 0 : 50 * 40 - 50 * 10, 1e-4);
    }
}

TEST(VisibleAreas, DoNotDependOnTheOrderOfTrianglesButInTies) {
    for (std::uint64_t seed = 0; seed < amount(60, 60, 15); ++seed) {
        const Scene scene = hostile_scene(seed);
        std::vector<std::uint32_t> order;
        const Scene other = shuffled(scene, seed + 1, order);
        const Camera camera = hostile_camera(scene, seed, {200, 150});
        const auto a = areas_of(scene, camera), b = areas_of(other, camera);
        const double sum = sums_of(a).visible;
        EXPECT_NEAR(sum, sums_of(b).visible, 1e-9 * sum) << seed;
        // Faces in one plane, or in the same place, may take each other's part.
        if (!scene.sheets.members.empty()) continue;
        for (std::size_t t = 0; t < order.size(); ++t)
            EXPECT_NEAR(a[order[t]].projected, b[t].projected, 1e-9 * sum) << seed;
    }
}

}  // namespace
}  // namespace sightline
