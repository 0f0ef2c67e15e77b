// Colours weighed by area: near the mean of very many samples, without seams, and whole where a
// surface covers a pixel.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "shading/antialiased_rows.hpp"
#include "shading/blended_rows.hpp"
#include "support/models.hpp"
#include "support/nasty.hpp"
#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

#ifdef SIGHTLINE_SANITIZED
constexpr bool kSanitized = true;  // many times slower: small pictures do
#else
constexpr bool kSanitized = false;
#endif

ColorImage antialiased(const ScreenScene& screen, const ShadeOptions& options) {
    AntialiasedRows rows(screen, options, false, must(open_fragments(screen, {})));
    const Resolution size = screen.resolution();
    rows.resolve(0, size.height, {});
    ColorImage image(size.width, size.height);
    for (std::uint32_t y = 0; y < image.height; ++y)
        std::copy_n(rows.row(y), image.width, image.pixels.data() + std::size_t{y} * image.width);
    return image;
}

ColorImage sampled(const ScreenScene& screen, std::uint32_t per_axis, const ShadeOptions& options) {
    ResolveOptions resolving;
    resolving.samples_per_axis = per_axis;
    return shade(screen, run("zbuffer", screen, resolving), options);
}

// 32 x 32 samples in each pixel of the camera: a picture four times as large, with 8 x 8 each.
ColorImage reference(const Scene& scene, Camera camera, const ShadeOptions& options) {
    const Resolution size = camera.resolution;
    camera.resolution = {4 * size.width, 4 * size.height};
    const ScreenScene screen = must(project(scene, camera, {Cull::none, 0}));
    const ColorImage fine = sampled(screen, 8, options);
    ColorImage image(size.width, size.height, glm::vec4(0));
    for (std::uint32_t y = 0; y < fine.height; ++y)
        for (std::uint32_t x = 0; x < fine.width; ++x)
            image.at(x / 4, y / 4) += fine.at(x, y) / 16.0f;
    return image;
}

// Root of the mean square difference of the bytes in a PNG.
double rms(const ColorImage& a, const ColorImage& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            const int d = to_srgb8(a.pixels[i][k]) - to_srgb8(b.pixels[i][k]);
            sum += d * d;
        }
    return std::sqrt(sum / (3.0 * static_cast<double>(a.pixels.size())));
}

void expect_close_to_many_samples(const Scene& scene, const Camera& camera, Shading shading) {
    const ShadeOptions options{shading, {1, 1, 1, 1}, 0};
    const ScreenScene screen = must(project(scene, camera, {Cull::none, 0}));
    const ColorImage truth = reference(scene, camera, options);
    const double area = rms(antialiased(screen, options), truth);
    const double sixteen = rms(sampled(screen, 4, options), truth);
    std::printf("rms of bytes: by area %.3f, 16 samples %.3f\n", area, sixteen);
    EXPECT_LT(area, 2);
    EXPECT_LT(area, sixteen);
}

Material colored(glm::vec3 color) {
    Material material;
    material.base_color = color;
    return material;
}

// Needles around a point, every other one left out.
Scene fan_of_needles() {
    SceneBuilder b;
    constexpr int kNeedles = 360;
    const auto rim = [](double turn) {
        const double angle = 2 * 3.14159265358979323846 * turn / (2 * kNeedles);
        return glm::dvec3{0.95 * std::cos(angle), 0.95 * std::sin(angle), 0};
    };
    for (int k = 0; k < kNeedles; ++k) b.triangle({0, 0, 0}, rim(2 * k), rim(2 * k + 1));
    b.scene.materials[0] = colored({0, 0, 0});
    return b.build();
}

// Two objects, black and white, to the horizon.
Scene checkerboard() {
    SceneBuilder b;
    constexpr int kSide = 160;
    for (const int color : {0, 1})
        for (int j = 0; j < kSide; ++j)
            for (int i = (j + color) % 2; i < kSide; i += 2) {
                const double x = i - 0.5 * kSide, z = -j;
                b.quad({x, -1, z}, {x + 1, -1, z}, {x + 1, -1, z - 1}, {x, -1, z - 1});
            }
    Scene scene = b.scene;
    Object second = scene.objects[0];
    const std::uint32_t half = scene.triangle_count() / 2, polygons = half / 2;
    scene.objects[0].triangle_count = second.triangle_count = second.first_triangle = half;
    scene.objects[0].polygon_count = second.polygon_count = second.first_polygon = polygons;
    second.material = 1;
    scene.objects.push_back(second);
    scene.materials = {colored({0, 0, 0}), colored({0.9f, 0.8f, 0.1f})};
    finish_scene(scene);
    return scene;
}

Camera view_of_checkerboard(const Scene& scene, Resolution size) {
    CameraOptions options;
    options.eye = glm::dvec3{0.3, 0.4, 2};
    options.target = glm::dvec3{0, 0, -30};
    return must(make_camera(options, scene.bounds, size));
}

TEST(Antialias, FanOfNeedles) {
    const Scene scene = fan_of_needles();
    expect_close_to_many_samples(
        scene, page_camera(scene, kSanitized ? Resolution{80, 80} : Resolution{200, 200}),
        Shading::unlit);
}

TEST(Antialias, CheckerboardToTheHorizon) {
    const Resolution size = kSanitized ? Resolution{60, 45} : Resolution{240, 180};
    const Scene scene = checkerboard();
    expect_close_to_many_samples(scene, view_of_checkerboard(scene, size), Shading::unlit);
}

TEST(Antialias, Sphere) {
    const Scene scene = sphere_scene(24, 32);
    expect_close_to_many_samples(scene, must(make_camera({}, scene.bounds, {120, 120})),
                                 Shading::flat);
}

TEST(Antialias, Bunny) {
    const auto path = models_folder() / "stanford-bunny.obj";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no models in " << models_folder();
    if (kSanitized) GTEST_SKIP() << "the sphere runs the same code";
    const std::vector<std::string> paths{path.string()};
    const Scene scene = must(load_scene(paths));
    expect_close_to_many_samples(scene, must(make_camera({}, scene.bounds, {320, 240})),
                                 Shading::flat);
}

Scene white(Scene scene) {
    for (Material& material : scene.materials) material.base_color = {1, 1, 1};
    return scene;
}

void expect_no_seams(const Scene& scene, const Camera& camera) {
    // Meshes that cut through themselves have their backs where they would have gaps.
    const ScreenScene screen = must(project(scene, camera, {Cull::none, 0}));
    const ColorImage on_white = antialiased(screen, {Shading::unlit, {1, 1, 1, 1}, 0});
    for (const glm::vec4& pixel : on_white.pixels) ASSERT_EQ(pixel, glm::vec4(1));
    const ColorImage on_black = antialiased(screen, {Shading::unlit, {0, 0, 0, 0}, 0});
    const ColorImage truth = reference(scene, camera, {Shading::unlit, {0, 0, 0, 0}, 0});
    std::uint64_t whole = 0;
    for (std::uint32_t y = 1; y + 1 < truth.height; ++y) {
        for (std::uint32_t x = 1; x + 1 < truth.width; ++x) {
            // No sample of it, nor of the pixels beside it, sees the background.
            bool covered = true;
            for (std::uint32_t j = y - 1; j <= y + 1; ++j)
                for (std::uint32_t i = x - 1; i <= x + 1; ++i)
                    covered = covered && truth.at(i, j).a > 1 - 1e-5f;
            if (!covered) continue;
            ++whole;
            ASSERT_EQ(on_black.at(x, y), glm::vec4(1)) << x << " " << y;
        }
    }
    EXPECT_GT(whole, truth.pixels.size() / 20);
}

TEST(Antialias, WhiteOnBlackIsWholeAndWhiteOnWhiteIsWhite) {
    const Scene sphere = white(sphere_scene(40, 60));
    expect_no_seams(sphere, must(make_camera({}, sphere.bounds, {150, 150})));
    if (kSanitized) return;
    for (const char* name : {"stanford-bunny.obj", "cow.obj", "fandisk.obj", "suzanne.obj"}) {
        const auto path = models_folder() / name;
        if (!std::filesystem::exists(path)) continue;
        const std::vector<std::string> paths{path.string()};
        const Scene scene = white(must(load_scene(paths)));
        expect_no_seams(scene, must(make_camera({}, scene.bounds, {320, 240})));
    }
}

ColorImage blended(const ScreenScene& screen, const ShadeOptions& options) {
    const SampleGrid grid{screen.resolution(), 8};
    ResolveOptions resolving;
    resolving.samples_per_axis = 8;
    BlendedRows rows(screen, grid, options,
                     must(open_layers(*find_algorithm("depth-sort"), screen, resolving)));
    rows.resolve(0, grid.resolution.height, resolving);
    ColorImage image(grid.resolution.width, grid.resolution.height);
    std::copy_n(rows.row(0), image.pixels.size(), image.pixels.data());
    return image;
}

// Triangles of many colours that cross one another.
Scene tinted_triangles(float opacity) {
    SceneBuilder b;
    Random random(17);
    for (int k = 0; k < 40; ++k) {
        const glm::dvec3 p = random.point(), q = random.point();
        b.triangle(p, q, random.point());
    }
    Scene scene = b.scene;
    const Object whole = scene.objects[0];
    scene.objects.clear();
    scene.materials.clear();
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
        Object object = whole;
        object.first_triangle = object.first_polygon = object.material = t;
        object.triangle_count = object.polygon_count = 1;
        scene.objects.push_back(object);
        const auto part = [&random] { return static_cast<float>(random.uniform(0, 1)); };
        const float red = part(), green = part();
        scene.materials.push_back(colored({red, green, part()}));
        scene.materials.back().opacity = opacity;
    }
    finish_scene(scene);
    return scene;
}

TEST(Antialias, CrossingTranslucentSurfacesAreThoseOfDepthSort) {
    for (const float opacity : {0.3f, 0.7f, 1.0f}) {
        const Scene scene = tinted_triangles(opacity);
        const ScreenScene screen =
            must(project(scene, page_camera(scene, {80, 80}), {Cull::none, 0}));
        const ShadeOptions options{Shading::unlit, {1, 1, 1, 1}, 0};
        EXPECT_LT(rms(antialiased(screen, options), blended(screen, options)), 1) << opacity;
    }
}

TEST(Antialias, AnyOrderOfTheFileGivesTheSameBytes) {
    const Scene scene = tinted_triangles(0.6f);
    std::vector<std::uint32_t> order;
    Scene other = shuffled(scene, 3, order);
    other.objects.resize(other.triangle_count());
    for (std::uint32_t t = 0; t < other.triangle_count(); ++t) {
        other.objects[t] = scene.objects[order[t]];
        other.objects[t].first_triangle = t;
    }
    const auto picture = [](const Scene& s) {
        return antialiased(must(project(s, page_camera(s, {96, 96}), {Cull::none, 0})),
                           {Shading::flat, {1, 1, 1, 1}, 0});
    };
    EXPECT_EQ(picture(scene).pixels, picture(other).pixels);
}

TEST(Antialias, HoldoutsAreHoles) {
    Scene scene = tinted_triangles(1);
    for (Material& material : scene.materials) material.holdout = true;
    scene.materials[3].holdout = false;
    const ScreenScene screen = must(project(scene, page_camera(scene, {60, 60}), {Cull::none, 0}));
    const ShadeOptions options{Shading::unlit, {1, 1, 1, 1}, 0};
    const ColorImage by_area = antialiased(screen, options), one = sampled(screen, 1, options);
    const Visibility seen = run("brute", screen);
    std::uint64_t holes = 0, shown = 0;
    for (std::size_t i = 0; i < one.pixels.size(); ++i) {
        if (seen.ids[i] == kNone) {
            EXPECT_EQ(one.pixels[i], glm::vec4(1));
        } else if (seen.ids[i] == 3) {
            ++shown;
            EXPECT_EQ(one.pixels[i].a, 1);
        } else {
            ++holes;
            EXPECT_EQ(one.pixels[i], glm::vec4(0));
        }
        EXPECT_LE(by_area.pixels[i].a, 1);
    }
    EXPECT_GT(holes, 500u);
    EXPECT_GT(shown, 5u);
}

TEST(Antialias, VertexAlphaIsOpacity) {
    SceneBuilder b;
    b.quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
    b.vertex_colors({{1, 1, 1, 0}, {1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 0}});
    const Scene scene = white(b.build());
    ASSERT_TRUE(has_translucent_faces(scene));
    const ScreenScene screen = must(project(scene, page_camera(scene, {64, 64}), {Cull::none, 0}));
    const ColorImage image = antialiased(screen, {Shading::unlit, {0, 0, 0, 1}, 0});
    for (std::uint32_t x = 0; x < 64; ++x) {
        const float expected = (static_cast<float>(x) + 0.5f) / 64;
        ASSERT_NEAR(image.at(x, 30).r, expected, 0.02f) << x;
    }
}

TEST(Antialias, ThreadsDoNotMatter) {
    const Scene scene = hostile_scene(3);
    const ScreenScene screen =
        must(project(scene, hostile_camera(scene, 3, {100, 80}), {Cull::none, 0}));
    const ShadeOptions options{Shading::phong, {1, 1, 1, 1}, 0};
    ColorImage images[2];
    for (int k = 0; k < 2; ++k) {
        ResolveOptions resolving;
        resolving.threads = k == 0 ? 1 : 3;
        AntialiasedRows rows(screen, options, false, must(open_fragments(screen, resolving)));
        rows.resolve(0, 80, resolving);
        images[k] = ColorImage(100, 80);
        std::copy_n(rows.row(0), images[k].pixels.size(), images[k].pixels.data());
    }
    EXPECT_EQ(images[0].pixels, images[1].pixels);
}

}  // namespace
}  // namespace sightline
