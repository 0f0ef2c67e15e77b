// Quadrics among triangles: one answer, whoever gives it, and the one of analytic geometry.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "math/predicates.hpp"
#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

constexpr Resolution kSmall{64, 48};
const std::array<const char*, 2> kOffered = {"zbuffer", "scanline-zbuffer"};

Quadric random_quadric(Random& random) {
    const glm::dvec3 p = random.point(0.6), q = p + random.point(0.8) + glm::dvec3{0, 0, 1e-3};
    const double radius = random.uniform(0.05, 0.6);
    Quadric quadric;
    switch (random.below(4)) {
        case 0:
            quadric = make_sphere(p, radius);
            break;
        case 1:
            quadric = make_cylinder(p, q, radius);
            break;
        case 2:
            quadric = make_cone(p, q, radius);
            break;
        default: {
            std::array<double, 10> c{};
            for (double& factor : c) factor = random.uniform(-1, 1);
            quadric = make_quadric(c, {p - glm::dvec3(radius), p + glm::dvec3(radius)});
        }
    }
    if (!random.chance(0.3)) return quadric;
    glm::dmat4 turn(1.0);  // a shear and a mirror
    for (int k = 0; k < 3; ++k) turn[k] = glm::dvec4(random.point(), 0);
    turn[3] = glm::dvec4(random.point(0.2), 1);
    const Quadric moved = transformed(quadric, turn);
    return is_regular(moved) ? moved : quadric;
}

Scene with(Scene scene, std::initializer_list<Quadric> quadrics) {
    for (const Quadric& quadric : quadrics) add_quadric(scene, quadric, "surface", {});
    finish_scene(scene);
    return scene;
}

Camera forward(Resolution size, double near_plane = 0.01, double far_plane = 100) {
    CameraOptions options;
    options.eye = glm::dvec3(0, 0, 0);
    options.target = glm::dvec3(0, 0, -1);
    options.fov = 90;
    options.near_plane = near_plane;
    options.far_plane = far_plane;
    return must(make_camera(options, Box{}, size));
}

/// Centre of pixel k, row by row, in pixel coordinates.
glm::dvec2 centre_of(std::uint32_t k, std::uint32_t width) {
    const std::uint32_t row = k / width;
    return {k % width + 0.5, row + 0.5};
}

double depth_at(const ScreenScene& screen, const Visibility& seen, std::size_t i) {
    return screen.metric_depth(static_cast<double>(seen.depth[i]));
}

TEST(Quadrics, EveryAlgorithmThatTakesThemEqualsBruteForce) {
    std::uint64_t triangles = 0, quadrics = 0;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        Random random(seed + 77);
        Scene scene = seed % 10 == 0 ? Scene{} : hostile_scene(seed);
        for (std::uint32_t k = 1 + random.below(5); k > 0; --k)
            add_quadric(scene, random_quadric(random), "surface", {});
        finish_scene(scene);
        const Camera camera = hostile_camera(scene, seed, kSmall);
        const ScreenScene screen = must(project(scene, camera));
        ResolveOptions options;
        options.samples_per_axis = seed % 8 == 1 ? 2 : 1;
        const Visibility truth = run("brute", screen, options);
        for (const std::uint32_t id : truth.ids) {
            if (id != kNone) ++(scene.is_quadric(id) ? quadrics : triangles);
        }
        for (const char* name : kOffered) {
            for (const int threads : {1, 2, 8}) {
                options.threads = threads;
                ASSERT_EQ(count_differences(truth, run(name, screen, options)), 0u)
                    << name << ", seed " << seed << ", threads " << threads;
            }
        }
    }
    EXPECT_GT(triangles, 50000u);
    EXPECT_GT(quadrics, 50000u);
}

// The rectangle of the screen to which a quadric is confined must cut nothing off: what lies at its
// border is never seen.
TEST(Quadrics, TheReachOnTheScreenHoldsAllThatIsSeen) {
    std::uint64_t confined = 0;
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
        Random random(seed + 4000);
        const Scene scene = with(Scene{}, {random_quadric(random)});
        const Camera camera = hostile_camera(scene, seed, kSmall);
        const ScreenScene screen = must(project(scene, camera));
        const ScreenQuadric& q = screen.quadrics().rays[0];
        if (q.x_max - q.x_min > 100 * 256 * 64) continue;  // it surrounds the eye
        ++confined;
        for (std::int32_t t = 0; t < 64; ++t) {
            const std::int32_t x = q.x_min + (q.x_max - q.x_min) / 64 * t;
            const std::int32_t y = q.y_min + (q.y_max - q.y_min) / 64 * t;
            for (const std::int32_t inset : {0, 100}) {
                ASSERT_FALSE(hit_quadric(screen, 0, x, q.y_min + inset)) << seed;
                ASSERT_FALSE(hit_quadric(screen, 0, x, q.y_max - inset)) << seed;
                ASSERT_FALSE(hit_quadric(screen, 0, q.x_min + inset, y)) << seed;
                ASSERT_FALSE(hit_quadric(screen, 0, q.x_max - inset, y)) << seed;
            }
        }
    }
    EXPECT_GT(confined, 200u);
}

TEST(Quadrics, ASphereHasItsAnalyticDepthAndSilhouette) {
    constexpr Resolution kSize{400, 400};
    const glm::dvec3 centre{0.3, -0.2, -5};
    const Scene scene = with(Scene{}, {make_sphere(centre, 1.5)});
    const ScreenScene screen = must(project(scene, forward(kSize, 3, 7)));
    const Visibility seen = run("zbuffer", screen);
    for (std::uint32_t j = 0; j < kSize.height; ++j) {
        for (std::uint32_t i = 0; i < kSize.width; ++i) {
            const std::size_t at = std::size_t{j} * kSize.width + i;
            const glm::dvec3 way{(i + 0.5) / 200 - 1, 1 - (j + 0.5) / 200, -1};
            // |t way - centre|^2 = 1.5^2, with depth t.
            const double a = glm::dot(way, way), b = glm::dot(way, centre);
            const double d = b * b - a * (glm::dot(centre, centre) - 2.25);
            if (std::abs(d) < 1e-9) continue;
            ASSERT_EQ(seen.ids[at], d > 0 ? 0u : kNone) << i << ", " << j;
            // The grid has 2^30 steps from 3 to 7, the float 24 bits.
            if (d > 0) {
                ASSERT_NEAR(depth_at(screen, seen, at), (b - std::sqrt(d)) / a, 1e-6);
            }
        }
    }
}

TEST(Quadrics, ParallelViewsShowASphereAsAnEllipse) {
    for (const Projection projection :
         {Projection::orthographic, Projection::cavalier, Projection::cabinet}) {
        const Scene scene = with(Scene{}, {make_sphere({1, 2, 3}, 2)});
        CameraOptions options;
        options.projection = projection;
        options.oblique_angle = 30;
        const Camera camera = must(make_camera(options, scene.bounds, {300, 300}));
        const ScreenScene screen = must(project(scene, camera));
        const Visibility seen = run("scanline-zbuffer", screen);
        const double covered = static_cast<double>(std::ranges::count(seen.ids, std::uint32_t{0}));
        const double pixels = 2 * camera.pixels_per_unit();
        // The page cuts the sheared cylinder of rays, whose section is a circle.
        const double stretch = std::sqrt(1 + glm::dot(camera.oblique, camera.oblique));
        EXPECT_NEAR(covered, std::numbers::pi * pixels * pixels * stretch, 0.005 * covered)
            << name_of(projection);
        // The point that is seen in the middle of a pixel is on the sphere.
        for (std::uint32_t k = 0; k < seen.ids.size(); k += 97) {
            if (seen.ids[k] == kNone) continue;
            const glm::dvec3 p = camera.unproject(centre_of(k, 300), depth_at(screen, seen, k));
            ASSERT_NEAR(glm::distance(p, {1, 2, 3}), 2, 1e-5);
        }
    }
}

TEST(Quadrics, FromInsideTheFarSideIsSeen) {
    const Scene scene = with(Scene{}, {make_sphere({0, 0, 0}, 3)});
    const ScreenScene screen = must(project(scene, forward(kSmall)));
    const Visibility seen = run("zbuffer", screen);
    for (std::uint32_t k = 0; k < seen.ids.size(); ++k) {
        ASSERT_EQ(seen.ids[k], 0u);
        const glm::dvec3 p =
            screen.camera().unproject(centre_of(k, kSmall.width), depth_at(screen, seen, k));
        ASSERT_NEAR(glm::length(p), 3, 1e-3);
    }
}

TEST(Quadrics, NearAndFarCutThemOpen) {
    const Scene scene = with(Scene{}, {make_sphere({0, 0, -4}, 1)});
    const std::size_t middle = 24 * 64 + 32;
    const auto depth_between = [&](double near_plane, double far_plane) {
        const ScreenScene screen = must(project(scene, forward(kSmall, near_plane, far_plane)));
        const Visibility seen = run("zbuffer", screen);
        return seen.ids[middle] == kNone ? 0 : depth_at(screen, seen, middle);
    };
    EXPECT_NEAR(depth_between(1, 10), 3, 0.02);
    EXPECT_NEAR(depth_between(3.5, 10), 5, 0.02);
    EXPECT_EQ(depth_between(3.5, 4.5), 0);
    EXPECT_EQ(depth_between(6, 10), 0);
}

// A face that touches the sphere in one point, and one that passes just behind it.
TEST(Quadrics, TangentPlanesAreDecidedOnTheDepthGrid) {
    const auto plane = [](double z) {
        return SceneBuilder().quad({-9, -9, z}, {9, -9, z}, {9, 9, z}, {-9, 9, z}).build();
    };
    const Resolution size{65, 65};  // with a sample in the middle
    const std::size_t middle = 32 * 65 + 32;
    for (const double z : {-3.0, -3.001, -2.999}) {
        const Scene scene = with(plane(z), {make_sphere({0, 0, -4}, 1)});
        const ScreenScene screen = must(project(scene, forward(size, 2, 6)));
        const Visibility truth = run("brute", screen);
        for (const char* name : kOffered)
            EXPECT_EQ(count_differences(truth, run(name, screen)), 0u) << name;
        const auto round = std::ranges::count(truth.ids, std::uint32_t{2});
        if (z == -3.001) {
            EXPECT_GT(round, 0);
            EXPECT_EQ(truth.ids[middle], 2u);
        } else {
            EXPECT_EQ(round, 0);  // at a tie the face wins
        }
        // The decision is that of the integers.
        for (std::int32_t i = 0; i < 65; ++i) {
            const std::int32_t x = 128 + 256 * i, y = 128 + 256 * 32;
            const auto hit = hit_quadric(screen, 0, x, y);
            if (!hit) continue;
            const Plane p = screen.plane(0);
            EXPECT_EQ(truth.ids[static_cast<std::size_t>(32 * 65 + i)] == 2,
                      Int128{p.c} * hit->z < depth_numerator(p, x, y));
        }
    }
}

TEST(Quadrics, OfTwoThatTieTheFirstIsSeen) {
    const Quadric ball = make_sphere({0, 0, -4}, 1);
    const Scene scene = with(Scene{}, {ball, ball});
    const ScreenScene screen = must(project(scene, forward(kSmall)));
    for (const char* name : {"brute", "zbuffer", "scanline-zbuffer"}) {
        const Visibility seen = run(name, screen);
        EXPECT_GT(std::ranges::count(seen.ids, 0u), 100) << name;
        EXPECT_EQ(std::ranges::count(seen.ids, 1u), 0) << name;
    }
}

// A sphere whose box leaves out the half that is turned to the viewer.
TEST(Quadrics, TheBoxCutsThemOff) {
    const std::array<double, 10> sphere{1, 1, 1, 0, 0, 0, 0, 0, 8, 15};  // about (0, 0, -4)
    const auto depth_in = [&](Box box) {
        const Scene scene = with(Scene{}, {make_quadric(sphere, box)});
        const ScreenScene screen = must(project(scene, forward({65, 65}, 2, 6)));
        const Visibility seen = run("zbuffer", screen);
        const std::size_t middle = 32 * 65 + 32;
        return seen.ids[middle] == kNone ? 0 : depth_at(screen, seen, middle);
    };
    EXPECT_NEAR(depth_in({{-2, -2, -6}, {2, 2, -2}}), 3, 1e-6);
    EXPECT_NEAR(depth_in({{-2, -2, -6}, {2, 2, -4}}), 5, 1e-6);
    EXPECT_EQ(depth_in({{-2, -2, -4.5}, {2, 2, -4}}), 0);
    EXPECT_EQ(depth_in({{0.5, -2, -6}, {2, 2, -2}}), 0);
}

TEST(Quadrics, ThoseThatLookAlongAnAsymptoteAreFound) {
    // z = -2 as a "quadric", a cylinder along the gaze, and a hyperbolic paraboloid z = xy - 3,
    // whose quadratic loses its first term along lines.
    const Scene scene =
        with(Scene{}, {make_quadric({0, 0, 0, 0, 0, 0, 0, 0, 1, 2}, {{-1, -1, -3}, {0, 1, -1}}),
                       make_quadric({0, 0, 0, -1, 0, 0, 0, 0, 1, 3}, {{0, -2, -5}, {2, 2, -1}})});
    const ScreenScene screen = must(project(scene, forward({65, 65}, 0.5, 9)));
    const Visibility seen = run("brute", screen);
    EXPECT_EQ(seen.ids[32 * 65 + 20], 0u);
    EXPECT_NEAR(depth_at(screen, seen, 32 * 65 + 20), 2, 1e-5);
    EXPECT_EQ(seen.ids[32 * 65 + 40], 1u);
    EXPECT_NEAR(depth_at(screen, seen, 32 * 65 + 40), 3, 1e-5);
}

TEST(Quadrics, AFarEyeLosesNoDigits) {
    // From a million radii away the plain quadratic formula would lose 12 of its 16 digits.
    const Scene scene = with(Scene{}, {make_sphere({0, 0, -1e6}, 1)});
    CameraOptions options;
    options.eye = glm::dvec3(0, 0, 0);
    options.target = glm::dvec3(0, 0, -1e6);
    options.fov = 2 * 1.1e-6 * 180 / std::numbers::pi;  // 1.1 radii on either side
    const Camera camera = must(make_camera(options, scene, {100, 100}));
    const ScreenScene screen = must(project(scene, camera));
    const Visibility seen = run("zbuffer", screen);
    double covered = 0;
    for (std::uint32_t k = 0; k < seen.ids.size(); ++k) {
        if (seen.ids[k] == kNone) continue;
        ++covered;
        const auto hit = hit_quadric(screen, 0, static_cast<std::int32_t>(k % 100 * 256 + 128),
                                     static_cast<std::int32_t>(k / 100 * 256 + 128));
        ASSERT_TRUE(hit);
        EXPECT_NEAR(glm::length(hit->own), 1, 1e-8);
    }
    EXPECT_NEAR(covered, std::numbers::pi * (100 / 2.2) * (100 / 2.2), 60);
}

TEST(Quadrics, OtherAlgorithmsRefuseThem) {
    const Scene scene = with(Scene{}, {make_sphere({0, 0, -4}, 1)});
    const ScreenScene screen = must(project(scene, forward(kSmall)));
    for (const Algorithm& algorithm : algorithms()) {
        Visibility out;
        EXPECT_EQ(resolve(algorithm, screen, {}, out).ok(), algorithm.quadrics) << algorithm.name;
        if (algorithm.open_rows == nullptr) continue;
        EXPECT_EQ(open_rows(algorithm, screen, {}).ok(), algorithm.quadrics) << algorithm.name;
    }
}

TEST(Quadrics, AnObserverSeesEverySampleDecided) {
    struct Recorder : Observer {
        std::vector<std::uint32_t> owner = std::vector<std::uint32_t>(64 * 48, kNone);
        void step(const Step& s) override {
            if (s.kind == StepKind::sample_decided) owner[s.y0 * 64 + s.x0] = s.triangle;
        }
    };
    const Scene scene = with(hostile_scene(7), {make_sphere({0, 0, 0}, 0.4)});
    const ScreenScene screen = must(project(scene, hostile_camera(scene, 7, kSmall)));
    for (const char* name : kOffered) {
        Recorder recorder;
        ResolveOptions options;
        options.observer = &recorder;
        EXPECT_TRUE(std::ranges::equal(run(name, screen, options).ids, recorder.owner)) << name;
    }
}

}  // namespace
}  // namespace sightline
