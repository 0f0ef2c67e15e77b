// What only snapping shows: faces that end exactly where one in front of them ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "drawing/pages.hpp"

namespace sightline {
namespace {

using namespace testing;

/// In perspective, with the eye at the origin: a triangle of whole numbers and, twice as far, the
/// same outline with a corner in the middle of each side, so that it is exactly hidden. Snapping
/// moves those corners.
Scene covered_outline(Random& random) {
    const auto point = [&] {
        return 6.0 * glm::dvec3(static_cast<double>(random.below(2001)) - 1000,
                                static_cast<double>(random.below(2001)) - 1000,
                                -1000 - static_cast<double>(random.below(1000)));
    };
    const glm::dvec3 a = point(), b = point(), c = point();
    const auto between = [](const glm::dvec3& p, const glm::dvec3& q) {
        return p + (q - p) / 3.0;  // exact: the numbers are multiples of 6
    };
    SceneBuilder builder;
    builder.triangle(a, b, c);
    builder.polygon(
        {2.0 * a, 2.0 * between(a, b), 2.0 * b, 2.0 * between(b, c), 2.0 * c, 2.0 * between(c, a)});
    return builder.build();
}

Camera from_origin(const Scene& scene) {
    CameraOptions options;
    options.eye = glm::dvec3(0);
    options.target = glm::dvec3(0, 0, -1);
    options.fov = 100;
    return must(make_camera(options, scene.bounds, {300, 300}));
}

/// Of the page, in pixels.
double step_of(const Camera& camera) {
    SceneBuilder any;
    any.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    return std::ldexp(1.0, -page(any.build(), camera).subpixel_bits());
}

double area_of(const DrawnRegions& regions, std::size_t r) {
    double doubled = 0;
    for (std::uint32_t l = regions.first_loop[r]; l < regions.first_loop[r + 1]; ++l) {
        const std::uint32_t first = regions.first_point[l], end = regions.first_point[l + 1];
        for (std::uint32_t i = first; i < end; ++i) {
            const glm::dvec2 p = regions.points[i] - regions.points[first];
            const glm::dvec2 q =
                regions.points[i + 1 == end ? first : i + 1] - regions.points[first];
            doubled += p.x * q.y - p.y * q.x;
        }
    }
    return 0.5 * doubled;
}

TEST(Slivers, OfHiddenFacesGoToTheFacesThatHideThem) {
    Random random(17);
    int peeping = 0;
    for (int trial = 0; trial < 60; ++trial) {
        const Scene scene = covered_outline(random);
        const ScreenScene screen = page(scene, from_origin(scene));
        const auto areas = must(visible_areas(screen, {}));
        // Without the rule, what snapping makes of the two: a union in which all is seen once.
        double visible = 0, widest = 0;
        for (const FaceArea& area : areas) {
            visible += area.visible;
            widest = std::max(widest, area.projected);
        }
        if (widest < 10) continue;
        for (std::uint32_t t = 1; t < areas.size(); ++t)
            ASSERT_EQ(areas[t].visible, 0) << trial << ", triangle " << t;
        const double step = std::ldexp(1.0, -screen.subpixel_bits());
        ASSERT_GE(visible, areas[0].projected * (1 - 1e-12)) << trial;
        ASSERT_LE(visible, areas[0].projected + step * 4 * 500) << trial;
        peeping += visible > areas[0].projected * (1 + 1e-12) ? 1 : 0;
        TraceOptions options;
        options.fill = FillStyle::flat;
        const Drawing drawing = must(trace(screen, options));
        ASSERT_EQ(drawing.regions.size(), 1u) << trial;
        ASSERT_EQ(drawing.regions.polygon[0], 0u) << trial;
        ASSERT_NEAR(area_of(drawing.regions, 0), visible, step * 4 * 500) << trial;
    }
    EXPECT_GT(peeping, 15);
}

// A strip between two rectangles: one of four steps is none, one of five is seen.
TEST(Slivers, AreFourStepsWideAtMost) {
    const double step = step_of(pixel_camera({100, 100}));
    for (const auto& [width, seen] : {std::pair(3.0, false), {4.0, false}, {5.0, true}}) {
        SceneBuilder b;
        add_square(b, {-40, -40}, {0, 40}, 5);
        add_square(b, {width * step, -40}, {40, 40}, 5);
        add_square(b, {-30, -30}, {30, 30}, -5);
        Scene scene = b.scene;
        finish_scene(scene, 0);  // an opening that narrow would be closed
        const auto areas = must(visible_areas(page(scene, pixel_camera({100, 100})), {}));
        const double strip = areas[4].visible + areas[5].visible;
        EXPECT_NEAR(strip, seen ? width * step * 60 : 0, 1e-9) << width;
        double sum = 0;
        for (const FaceArea& area : areas) sum += area.visible;
        EXPECT_NEAR(sum, 80 * 80 - width * step * 20, 1e-9) << width;
    }
}

// Faces that are that small themselves stay.
TEST(Slivers, AreNotFacesThatAreTiny) {
    const Camera camera = pixel_camera({100, 100});
    const double step = step_of(camera);
    SceneBuilder b;
    constexpr int kSide = 12;
    const auto at = [&](int i, int j) { return glm::dvec3(3 * i * step, 3 * j * step, 0); };
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i)
            b.quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    const auto areas = must(visible_areas(page(b.build(), camera), {}));
    for (const FaceArea& area : areas) EXPECT_NEAR(area.visible, 4.5 * step * step, 1e-12);
}

TEST(Slivers, OfATriangleStayWithItsPolygon) {
    const Camera camera = pixel_camera({100, 100});
    SceneBuilder b;
    add_square(b, {-40, -40}, {40, 40}, -5);
    // Hides one of its two triangles but for a strip of a step along the diagonal.
    b.triangle({-40, -39.99997, 5}, {40, 40.00003, 5}, {-40, 40.00003, 5});
    const auto areas = must(visible_areas(page(b.build(), camera), {}));
    EXPECT_GT(areas[0].visible, 3199);
    EXPECT_EQ(areas[1].visible, 0);
}

}  // namespace
}  // namespace sightline
