// Translucent surfaces: blended in the right order at every sample, whatever the order of the file.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "math/predicates.hpp"
#include "shading/blended_rows.hpp"
#include "shading/surface.hpp"
#include "support/nasty.hpp"
#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

constexpr glm::vec4 kBackground{0.9f, 0.95f, 1, 1};

// Every polygon becomes an object with a colour and an opacity of its own.
Scene tinted(const SceneBuilder& builder, float least_opacity) {
    Scene scene = builder.scene;
    scene.objects.clear();
    scene.materials.clear();
    Random random(11);
    for (std::uint32_t t = 0; t < scene.triangle_count();) {
        Object object;
        object.first_triangle = t;
        object.first_polygon = scene.triangle_polygon[t];
        object.polygon_count = 1;
        while (t < scene.triangle_count() && scene.triangle_polygon[t] == object.first_polygon) ++t;
        object.triangle_count = t - object.first_triangle;
        object.material = static_cast<std::uint32_t>(scene.materials.size());
        Material material;
        material.base_color = {random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)};
        material.opacity = static_cast<float>(random.uniform(least_opacity, 1));
        scene.objects.push_back(object);
        scene.materials.push_back(material);
    }
    finish_scene(scene);
    return scene;
}

// All triangles at a sample, the farthest first; of equally deep ones the higher id.
std::vector<std::uint32_t> layers_at(const ScreenScene& screen, std::int32_t x, std::int32_t y) {
    std::vector<std::uint32_t> ids;
    for (std::uint32_t k = 0; k < screen.triangle_count(); ++k) {
        if (!screen.drawable(k)) continue;
        const Corners c = screen.corners(k);
        if (covers({screen.point(c.x), screen.point(c.y), screen.point(c.z)}, x, y))
            ids.push_back(screen.id(k));
    }
    std::ranges::sort(ids, [&](std::uint32_t a, std::uint32_t b) {
        const int order = compare_depth_exactly(screen.plane(a), screen.plane(b), x, y);
        return order != 0 ? order > 0 : a > b;
    });
    return ids;
}

bool has_tie(const ScreenScene& screen, const std::vector<std::uint32_t>& layers, std::int32_t x,
             std::int32_t y) {
    for (std::size_t k = 1; k < layers.size(); ++k) {
        if (compare_depth_exactly(screen.plane(layers[k - 1]), screen.plane(layers[k]), x, y) == 0)
            return true;
    }
    return false;
}

ColorImage blended(const ScreenScene& screen, const std::string& algorithm, std::uint32_t n = 1) {
    ResolveOptions options;
    options.samples_per_axis = n;
    const SampleGrid grid{screen.resolution(), n};
    BlendedRows rows(screen, grid, {Shading::unlit, kBackground, 0},
                     must(open_layers(*find_algorithm(algorithm), screen, options)));
    rows.resolve(0, grid.resolution.height, options);
    ColorImage image(grid.resolution.width, grid.resolution.height);
    for (std::uint32_t y = 0; y < image.height; ++y)
        std::copy_n(rows.row(y), image.width, image.pixels.data() + std::size_t{y} * image.width);
    return image;
}

double distance(glm::vec4 a, glm::vec4 b) {
    const glm::vec4 d = glm::abs(a - b);
    return std::max({d.r, d.g, d.b, d.a});
}

// Against sorting every sample's triangles. Returns how many samples had several layers.
std::uint64_t expect_sorted_blending(const Scene& scene, const ScreenScene& screen,
                                     const std::string& algorithm) {
    const ColorImage image = blended(screen, algorithm);
    const std::int32_t unit = 1 << screen.subpixel_bits();
    std::uint64_t several = 0, wrong = 0;
    for (std::uint32_t y = 0; y < image.height; ++y) {
        for (std::uint32_t x = 0; x < image.width; ++x) {
            const auto sx = static_cast<std::int32_t>(x) * unit + unit / 2,
                       sy = static_cast<std::int32_t>(y) * unit + unit / 2;
            const std::vector<std::uint32_t> layers = layers_at(screen, sx, sy);
            several += layers.size() > 1;
            glm::vec4 color = kBackground;
            for (const std::uint32_t id : layers) {
                const Material& m = material_of(scene, id);
                color = m.opacity * glm::vec4(m.base_color, 1) + (1 - m.opacity) * color;
            }
            const bool differs = distance(color, image.at(x, y)) > 1e-5;
            wrong += differs && !has_tie(screen, layers, sx, sy);
        }
    }
    EXPECT_EQ(wrong, 0u) << algorithm;
    return several;
}

SceneBuilder crossing_quads() {
    SceneBuilder b;
    b.quad({-0.8, -0.8, -0.5}, {0.8, -0.8, 0.5}, {0.8, 0.8, 0.5}, {-0.8, 0.8, -0.5});
    b.quad({-0.7, -0.9, 0.5}, {0.9, -0.7, -0.5}, {0.7, 0.9, -0.5}, {-0.9, 0.7, 0.5});
    return b;
}

SceneBuilder cyclic_quads() {
    SceneBuilder b;
    b.quad({-0.9, -0.5, 0.3}, {0.9, -0.5, -0.3}, {0.9, -0.2, -0.3}, {-0.9, -0.2, 0.3});
    b.quad({0.5, -0.9, 0.3}, {0.2, 0.9, -0.3}, {0.0, 0.9, -0.3}, {0.3, -0.9, 0.3});
    b.quad({0.4, 0.9, 0.4}, {-0.9, -0.7, -0.3}, {-0.7, -0.8, -0.3}, {0.6, 0.8, 0.4});
    return b;
}

SceneBuilder random_polygons() {
    SceneBuilder b;
    Random random(17);
    for (int k = 0; k < 60; ++k) {
        const glm::dvec3 p = random.point(), q = random.point();
        b.triangle(p, q, random.point());
    }
    return b;
}

TEST(Blend, EqualsSortingEverySample) {
    for (const SceneBuilder& builder : {crossing_quads(), cyclic_quads(), random_polygons()}) {
        const Scene scene = tinted(builder, 0.2f);
        const ScreenScene screen =
            must(project(scene, page_camera(scene, {96, 96}), {Cull::none, 0}));
        for (const Algorithm& algorithm : algorithms()) {
            if (algorithm.open_layers == nullptr || !algorithm.exact) continue;
            EXPECT_GT(expect_sorted_blending(scene, screen, std::string(algorithm.name)), 300u);
        }
    }
}

TEST(Blend, FromInsideAndInPerspective) {
    const Scene scene = tinted(random_polygons(), 0.2f);
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        const Camera camera = hostile_camera(scene, seed, {60, 50});
        const ScreenScene screen = must(project(scene, camera, {Cull::none, 0}));
        expect_sorted_blending(scene, screen, "depth-sort");
    }
}

TEST(Blend, AlgorithmsWithAnOrderAgree) {
    for (const SceneBuilder& builder : {crossing_quads(), cyclic_quads(), random_polygons()}) {
        const Scene scene = tinted(builder, 0.3f);
        const ScreenScene screen =
            must(project(scene, page_camera(scene, {128, 128}), {Cull::none, 0}));
        const ColorImage first = blended(screen, "depth-sort");
        for (const Algorithm& algorithm : algorithms()) {
            if (algorithm.open_layers == nullptr) continue;
            const ColorImage other = blended(screen, std::string(algorithm.name));
            std::uint64_t differ = 0;
            for (std::size_t i = 0; i < first.pixels.size(); ++i)
                differ += distance(first.pixels[i], other.pixels[i]) > 1.0 / 255;
            // Samples on a line where two of them cross may fall to either side.
            EXPECT_LE(differ, 12u) << algorithm.name;
        }
    }
}

TEST(Blend, AnyOrderOfTheFile) {
    const Scene scene = tinted(random_polygons(), 0.2f);
    std::vector<std::uint32_t> order;
    Scene other = shuffled(scene, 3, order);
    // A triangle a polygon: the objects follow their triangles.
    for (std::uint32_t t = 0; t < other.triangle_count(); ++t) {
        other.objects.resize(other.triangle_count());
        other.objects[t] = scene.objects[scene.object_of(order[t])];
        other.objects[t].first_triangle = t;
    }
    const auto picture = [](const Scene& s) {
        return blended(must(project(s, page_camera(s, {96, 96}), {Cull::none, 0})), "depth-sort");
    };
    const ColorImage a = picture(scene), b = picture(other);
    std::uint64_t differ = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        differ += distance(a.pixels[i], b.pixels[i]) > 1e-5;
    EXPECT_EQ(differ, 0u);
}

TEST(Blend, OpaqueSurfacesAreThoseOfResolve) {
    const Scene scene = tinted(random_polygons(), 1);
    const ScreenScene screen = must(project(scene, page_camera(scene, {96, 96}), {Cull::none, 0}));
    const Visibility truth = run("brute", screen);
    const ColorImage plain = shade(screen, truth, {Shading::unlit, kBackground, 0});
    const ColorImage image = blended(screen, "depth-sort");
    EXPECT_EQ(image.pixels, plain.pixels);
}

TEST(Blend, IsChosenForColoursOfTranslucentScenesOnly) {
    const Scene opaque = tinted(crossing_quads(), 1), translucent = tinted(crossing_quads(), 0.2f);
    const Algorithm &sorts = *find_algorithm("depth-sort"), &keeps = *find_algorithm("zbuffer");
    EXPECT_TRUE(blends(sorts, Shading::flat, translucent));
    EXPECT_FALSE(blends(sorts, Shading::flat, opaque));
    EXPECT_FALSE(blends(sorts, Shading::ids, translucent));
    EXPECT_FALSE(blends(keeps, Shading::flat, translucent));
}

TEST(Blend, SamplesAreAveraged) {
    const Scene scene = tinted(crossing_quads(), 0.5f);
    const ScreenScene screen = must(project(scene, page_camera(scene, {32, 32}), {Cull::none, 0}));
    const ScreenScene large = must(project(scene, page_camera(scene, {64, 64}), {Cull::none, 0}));
    const ColorImage image = blended(screen, "depth-sort", 2), fine = blended(large, "depth-sort");
    std::uint64_t differ = 0;
    for (std::uint32_t y = 0; y < 32; ++y) {
        for (std::uint32_t x = 0; x < 32; ++x) {
            const glm::vec4 mean = (fine.at(2 * x, 2 * y) + fine.at(2 * x + 1, 2 * y) +
                                    fine.at(2 * x, 2 * y + 1) + fine.at(2 * x + 1, 2 * y + 1)) /
                                   4.0f;
            differ += distance(mean, image.at(x, y)) > 0.01;
        }
    }
    EXPECT_LT(differ, 40u);  // edges are snapped at another scale
}

}  // namespace
}  // namespace sightline
