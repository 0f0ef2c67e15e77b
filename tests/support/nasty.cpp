#include "support/nasty.hpp"

#include <cmath>
#include <glm/geometric.hpp>

namespace sightline::testing {
namespace {

// A thousand polygons through the origin, so that one sample sees them all at one depth.
Scene polygons_through_a_point() {
    Random random(11);
    SceneBuilder b;
    for (int k = 0; k < 1000; ++k) {
        const glm::dvec3 p = random.point(), q = random.point();
        b.triangle(p, q, -0.5 * (p + q));
    }
    return b.build();
}

Scene bundle_of_needles() {
    Random random(12);
    SceneBuilder b;
    for (int k = 0; k < 800; ++k) {
        const glm::dvec3 p = 0.1 * random.point() + glm::dvec3(0, -0.9, 0);
        const glm::dvec3 q = 0.1 * random.point() + glm::dvec3(0, 0.9, 0);
        b.triangle(p, q, q + 0.003 * random.point());
    }
    return b.build();
}

// Each one surrounds the one behind it on the page or is surrounded by it.
Scene nested_rectangles() {
    SceneBuilder b;
    for (int k = 0; k < 60; ++k) {
        const double r = 0.98 - 0.016 * k, near = -0.9 + 0.03 * k, far = 0.9 - 0.03 * k;
        b.quad({-r, -r, near}, {r, -r, near}, {r, r, near}, {-r, r, near});
        b.quad({-r, -r, far}, {r, -r, far}, {r, r, far}, {-r, r, far});
    }
    return b.build();
}

// Two coplanar layers of squares over a wall, slanted in depth.
Scene coplanar_checkerboard() {
    SceneBuilder b;
    constexpr int kSide = 16;
    const auto at = [](double x, double y) { return glm::dvec3(x, y, 0.3 * x + 0.2 * y); };
    b.quad(at(-1, -1), at(1, -1), at(1, 1), at(-1, 1));
    for (int layer = 0; layer < 2; ++layer) {
        for (int i = 0; i < kSide; ++i) {
            for (int j = (i + layer) % 2; j < kSide; j += 2) {
                const double s = 2.0 / kSide, x = -1 + s * i, y = -1 + s * j;
                b.quad(at(x, y), at(x + s, y), at(x + s, y + s), at(x, y + s));
            }
        }
    }
    return b.build();
}

// Two combs of long teeth that pierce each other, tooth by tooth.
Scene penetrating_combs() {
    SceneBuilder b;
    constexpr int kTeeth = 40;
    for (int k = 0; k < kTeeth; ++k) {
        const double x = -0.95 + 1.9 * k / kTeeth, w = 0.035;
        b.quad({x, -0.95, -0.5}, {x + w, -0.95, -0.5}, {x + w, 0.95, 0.5}, {x, 0.95, 0.5});
        b.quad({-0.95, x, 0.4}, {-0.95, x + w, 0.4}, {0.95, x + w, -0.4}, {0.95, x, -0.4});
    }
    return b.build();
}

// With page_camera() at 64 x 64 all corners stand at pixels' centres.
Scene everything_on_sample_points() {
    Random random(13);
    SceneBuilder b;
    const auto corner = [&] {
        const auto on_grid = [&] { return (random.below(64) + 0.5) / 32.0 - 1.0; };
        const double x = on_grid(), y = on_grid();
        return glm::dvec3(x, y, (random.below(9) - 4.0) / 8);
    };
    for (int k = 0; k < 500; ++k) {
        const glm::dvec3 p = corner(), q = corner(), r = corner();
        b.triangle(p, q, r);
    }
    return b.build();
}

// Three or more that overlap in a circle.
Scene cyclic_overlaps() {
    SceneBuilder b;
    for (const int n : {3, 4, 9, 100}) {
        const double size = n == 100 ? 0.95 : 0.25;
        const glm::dvec3 centre(n == 3 ? -0.6 : 0.6, n == 4 ? 0.6 : -0.6, 0);
        for (int k = 0; k < n; ++k) {
            // sin and cos of a test may be those of the C library: nothing is hashed.
            const double t = 6.283185307179586 * k / n, u = t + 2.4;
            const glm::dvec3 p = glm::dvec3(std::cos(t), std::sin(t), -0.5) * size;
            const glm::dvec3 q = glm::dvec3(std::cos(u), std::sin(u), 0.5) * size;
            const glm::dvec3 c = n == 100 ? glm::dvec3(0) : centre;
            const glm::dvec3 w = 0.04 * size * glm::dvec3(-std::sin(t), std::cos(t), 0);
            b.quad(c + p, c + p + w, c + q + w, c + q);
        }
    }
    return b.build();
}

}  // namespace

std::vector<NastyScene> nasty_scenes() {
    return {{"polygons through a point", polygons_through_a_point(), true},
            {"bundle of needles", bundle_of_needles()},
            {"nested rectangles", nested_rectangles()},
            {"coplanar checkerboard", coplanar_checkerboard()},
            {"penetrating combs", penetrating_combs()},
            {"everything on sample points", everything_on_sample_points(), true},
            {"cyclic overlaps", cyclic_overlaps()}};
}

Camera page_camera(const Scene& scene, Resolution resolution) {
    CameraOptions options;
    options.projection = Projection::orthographic;
    options.eye = glm::dvec3(0, 0, 5);
    options.target = glm::dvec3(0, 0, 0);
    options.ortho_height = 2.0;
    return must(make_camera(options, scene.bounds, resolution));
}

}  // namespace sightline::testing
