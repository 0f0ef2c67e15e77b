// Pictures as a whole: filter, background, depth and id colours, maps, sameness.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <set>

#include "shading/id_colors.hpp"
#include "shading/view_of.hpp"
#include "support/files.hpp"
#include "support/scenes.hpp"

namespace {

using namespace sightline;
using sightline::testing::read_file;
using sightline::testing::SceneBuilder;
using sightline::testing::TemporaryFolder;
using test::forward_camera;
using test::View;
using test::view_of;

constexpr Shading kAll[] = {Shading::flat,  Shading::gouraud, Shading::phong, Shading::unlit,
                            Shading::depth, Shading::normals, Shading::ids};

/// Covers the left half of the view at depth 2.
SceneBuilder left_half() {
    SceneBuilder builder;
    builder.polygon({{-2.5, -2.5, -2}, {0, -2.5, -2}, {0, 2.5, -2}, {-2.5, 2.5, -2}});
    builder.scene.materials[0].base_color = {1, 0.5f, 0};
    return builder;
}

View half_view(SceneBuilder& builder, Resolution resolution, std::uint32_t samples = 1) {
    CameraOptions options = forward_camera();
    options.near_plane = 1;
    options.far_plane = 5;
    return view_of(builder.scene, options, resolution, samples);
}

TEST(Shade, NamesSurviveTheRoundTrip) {
    for (const Shading shading : kAll) EXPECT_EQ(parse_shading(name_of(shading)), shading);
    EXPECT_EQ(parse_shading("Flat"), std::nullopt);
    EXPECT_EQ(parse_shading(""), std::nullopt);
}

TEST(Shade, BackgroundShowsAsGiven) {
    SceneBuilder builder = left_half();
    const View view = half_view(builder, {8, 8});
    const glm::vec4 half_red{0.5f, 0, 0, 0.5f};
    for (const Shading shading : kAll) {
        const ColorImage image = view.shade(shading, half_red);
        EXPECT_EQ(image.at(7, 4), half_red);
        EXPECT_EQ(image.at(0, 4).a, 1);
    }
    EXPECT_EQ(view.shade(Shading::unlit, half_red).at(0, 4), glm::vec4(1, 0.5f, 0, 1));
}

TEST(Shade, BoxFilterAveragesTheSamplesOfAPixel) {
    for (const std::uint32_t samples : {2u, 4u, 8u, 16u}) {
        SceneBuilder builder = left_half();
        // An odd width: the rim runs through the middle of column 2, covering half its samples.
        const View view = half_view(builder, {5, 5}, samples);
        const ColorImage image = view.shade(Shading::unlit, {0, 0, 0, 0});
        EXPECT_EQ(image.at(2, 2), glm::vec4(0.5f, 0.25f, 0, 0.5f));
        EXPECT_EQ(image.at(1, 2), glm::vec4(1, 0.5f, 0, 1));
        EXPECT_EQ(image.at(3, 2), glm::vec4(0, 0, 0, 0));
    }
}

TEST(Shade, DepthRunsFromBlackAtNearToWhiteAtFar) {
    for (const double depth : {1.0, 2.0, 3.5, 5.0}) {
        for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
            SceneBuilder builder;
            builder.polygon({{-9, -9, -depth}, {9, -9, -depth}, {9, 9, -depth}, {-9, 9, -depth}});
            CameraOptions options = forward_camera();
            options.near_plane = 1;
            options.far_plane = 5;
            options.projection = projection;
            const View view = view_of(builder.scene, options, {9, 9});
            const glm::vec4 pixel = view.shade(Shading::depth).at(4, 4);
            ASSERT_EQ(pixel.a, 1) << depth;
            EXPECT_NEAR(to_srgb8(pixel.r), 255 * (depth - 1) / 4, 0.501);
            EXPECT_EQ(pixel.r, pixel.g);
        }
    }
}

TEST(Shade, NormalsAreReadOffTheBytes) {
    SceneBuilder builder = left_half();
    const View view = half_view(builder, {8, 8});
    const glm::vec4 pixel = view.shade(Shading::normals).at(1, 4);
    EXPECT_EQ(to_srgb8(pixel.r), 128);
    EXPECT_EQ(to_srgb8(pixel.g), 128);
    EXPECT_EQ(to_srgb8(pixel.b), 255);
}

TEST(Shade, IdsHaveDistinctColors) {
    std::set<std::array<std::uint8_t, 3>> seen;
    for (std::uint32_t id = 0; id < 100'000; ++id) {
        EXPECT_TRUE(seen.insert(id_color(id)).second) << id;
        EXPECT_GE(std::abs(id_color(id)[0] - id_color(id + 1)[0]), 97) << id;
    }
    SceneBuilder builder = left_half();
    const View view = half_view(builder, {32, 32});
    const ColorImage image = view.shade(Shading::ids);
    const std::uint32_t id = view.visibility.ids[16 * 32 + 3];
    for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(to_srgb8(image.at(3, 16)[k]), id_color(id)[static_cast<std::size_t>(k)]);
    }
}

SceneBuilder many_triangles() {
    SceneBuilder builder;
    std::mt19937 random(3);
    const auto next = [&random] { return static_cast<double>(random() % 2001) / 1000.0 - 1.0; };
    std::vector<glm::vec3> normals;
    std::vector<glm::vec4> colors;
    for (int i = 0; i < 2'500; ++i) {  // more than the cache of prepared triangles holds
        const glm::dvec3 middle{next(), next(), next()};
        builder.polygon({middle + 0.1 * glm::dvec3{next(), next(), next()},
                         middle + 0.1 * glm::dvec3{next(), next(), next()},
                         middle + 0.1 * glm::dvec3{next(), next(), next()}});
        for (int k = 0; k < 3; ++k) {
            normals.push_back(glm::vec3(glm::dvec3{next(), next(), next()}));
            colors.push_back(glm::vec4(glm::dvec4{next() + 1, next() + 1, next() + 1, 2} * 0.5));
        }
    }
    builder.vertex_normals(normals);
    builder.vertex_colors(colors);
    builder.scene.materials[0].specular = 0.4f;
    return builder;
}

TEST(Shade, BytesDoNotDependOnTheNumberOfThreads) {
    // Eight threads even where there are fewer cores.
    const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
    SceneBuilder builder = many_triangles();
    const View view = view_of(builder.scene, {}, {80, 60}, 2);
    for (const Shading shading : kAll) {
        const ColorImage one = view.shade(shading, {1, 1, 1, 1}, 1);
        for (const int threads : {2, 8, 0}) {
            const ColorImage other = view.shade(shading, {1, 1, 1, 1}, threads);
            ASSERT_EQ(std::memcmp(one.pixels.data(), other.pixels.data(),
                                  one.pixels.size() * sizeof(glm::vec4)),
                      0)
                << name_of(shading) << ' ' << threads;
        }
    }
}

// The same bits on every machine: a hash of the floats of each kind of shading, pinned.
TEST(Shade, BytesAreTheSameOnEveryMachine) {
    SceneBuilder builder = many_triangles();
    builder.scene.materials[0].shininess = 17.5f;
    const View view = view_of(builder.scene, {}, {80, 60}, 2);
    std::uint64_t hash = 14695981039346656037u;  // FNV-1a (Fowler, Noll, Vo)
    for (const Shading shading : kAll) {
        const ColorImage image = view.shade(shading);
        const auto* bytes = reinterpret_cast<const unsigned char*>(image.pixels.data());
        for (std::size_t i = 0; i < image.pixels.size() * sizeof(glm::vec4); ++i) {
            hash = (hash ^ bytes[i]) * 1099511628211u;
        }
    }
    EXPECT_EQ(hash, 7995895578870085337u);
}

TEST(Shade, WrittenBandByBandIsThePictureWrittenAtOnce) {
    const TemporaryFolder folder;
    SceneBuilder builder = many_triangles();
    for (const std::uint32_t samples : {1u, 2u}) {
        // High enough for several bands.
        const View view = view_of(builder.scene, {}, {700, 230}, samples);
        for (const Shading shading : kAll) {
            const glm::vec4 background{0.2f, 0.1f, 0, 0.4f};
            ASSERT_TRUE(
                write_color_png(folder.file("a.png"), view.shade(shading, background)).ok());
            for (const int threads : {1, 8}) {
                ASSERT_TRUE(write_shaded_png(folder.file("b.png"), view.screen, view.visibility,
                                             {shading, background, threads})
                                .ok());
                EXPECT_EQ(read_file(folder.file("a.png")), read_file(folder.file("b.png")))
                    << name_of(shading) << ' ' << threads;
            }
        }
    }
}

TEST(Maps, SayWhatIsSeen) {
    SceneBuilder builder = left_half();
    builder.scene.objects.push_back(builder.scene.objects[0]);
    builder.scene.objects[0].triangle_count = 1;
    builder.scene.objects[1].first_triangle = 1;
    builder.scene.objects[1].triangle_count = 1;
    const View view = half_view(builder, {32, 32});
    const DepthImage depth = depth_map(view.screen, view.visibility);
    const NormalImage normals = normal_map(view.screen, view.visibility, true);
    const IdImage triangles = triangle_map(view.visibility);
    const IdImage objects = object_map(view.screen, view.visibility);
    const MaskImage mask = mask_map(view.visibility);
    EXPECT_TRUE(std::ranges::equal(triangles.pixels, view.visibility.ids));
    std::set<std::uint32_t> seen;
    for (std::uint32_t y = 0; y < 32; ++y) {
        for (std::uint32_t x = 0; x < 32; ++x) {
            const bool left = x < 16;
            EXPECT_EQ(mask.at(x, y), left ? 1 : 0);
            EXPECT_EQ(objects.at(x, y), triangles.at(x, y));  // one triangle an object
            EXPECT_EQ(normals.at(x, y), left ? glm::vec3(0, 0, 1) : glm::vec3(0.0f));
            if (left) {
                EXPECT_NEAR(depth.at(x, y), 2, 1e-6);
                seen.insert(triangles.at(x, y));
            } else {
                EXPECT_EQ(depth.at(x, y), std::numeric_limits<float>::infinity());
                EXPECT_EQ(triangles.at(x, y), kNone);
            }
        }
    }
    EXPECT_EQ(seen.size(), 2u);
}

TEST(Maps, DepthIsMetricOnAPlaneThatRecedes) {
    SceneBuilder builder;
    builder.polygon({{-30, -1, -1}, {30, -1, -1}, {30, -1, -20}, {-30, -1, -20}});
    const View view = view_of(builder.scene, forward_camera(), {16, 64});
    const DepthImage depth = depth_map(view.screen, view.visibility);
    std::uint32_t seen = 0;
    for (std::uint32_t y = 36; y < 60; ++y) {
        const double truth = 32.0 / (y + 0.5 - 32.0);  // where the ray meets y = -1
        if (std::isinf(depth.at(8, y))) continue;
        ++seen;
        // The corners are snapped to 1/256 pixel: the depth is off by that much of its slope.
        EXPECT_NEAR(depth.at(8, y), truth, truth * truth / 32 / 128) << y;
    }
    EXPECT_GT(seen, 20u);
}

TEST(Maps, SmoothNormalsAreInterpolatedAndOnTheViewersSide) {
    SceneBuilder builder;
    builder.polygon({{-2, -2, -2}, {-2, 2, -2}, {2, 2, -2}, {2, -2, -2}});  // seen from behind
    const float s = std::sqrt(0.5f);
    builder.vertex_normals({{-s, 0, -s}, {-s, 0, -s}, {s, 0, -s}, {s, 0, -s}});
    const View view = view_of(builder.scene, forward_camera(), {65, 65});
    const NormalImage smooth = normal_map(view.screen, view.visibility, true);
    const NormalImage flat = normal_map(view.screen, view.visibility, false);
    EXPECT_EQ(flat.at(32, 32), glm::vec3(0, 0, 1));
    EXPECT_NEAR(smooth.at(32, 32).x, 0, 1e-5);
    EXPECT_NEAR(smooth.at(32, 32).z, 1, 1e-5);
    EXPECT_GT(smooth.at(2, 32).x, 0.5f);
    EXPECT_LT(smooth.at(62, 32).x, -0.5f);
}

}  // namespace
