// Quadrics are shaded with the exact normal of the point that is seen.
#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "shading/quadric_surface.hpp"
#include "shading/view_of.hpp"
#include "support/scenes.hpp"

namespace sightline {
namespace {

using test::forward_camera;
using test::view_of;

const glm::dvec3 kCentre{0.2, -0.1, -4};

/// A ball before a wall.
Scene ball_scene() {
    testing::SceneBuilder b;
    b.polygon({{-9, -9, -6}, {9, -9, -6}, {9, 9, -6}, {-9, 9, -6}});
    Material matt;
    matt.specular = 0;
    matt.base_color = {0.2f, 0.5f, 0.9f};
    add_quadric(b.scene, make_sphere(kCentre, 1), "ball", matt);
    return std::move(b.scene);
}

TEST(QuadricShading, MapsAreThoseOfTheSphere) {
    Scene scene = ball_scene();
    const auto view = view_of(scene, forward_camera(), {80, 60});
    const DepthImage depth = depth_map(view.screen, view.visibility);
    const NormalImage normals = normal_map(view.screen, view.visibility, false);
    const IdImage objects = object_map(view.screen, view.visibility);
    std::size_t seen = 0;
    for (std::uint32_t i = 0; i < depth.pixels.size(); ++i) {
        EXPECT_EQ(objects.pixels[i], view.visibility.ids[i] == 2 ? 1u : 0u);
        if (view.visibility.ids[i] != 2) continue;
        ++seen;
        const std::uint32_t row = i / 80;
        const glm::dvec3 p = view.camera.unproject({i % 80 + 0.5, row + 0.5}, depth.pixels[i]);
        const glm::vec3 outwards(p - kCentre);
        EXPECT_NEAR(glm::length(outwards), 1, 1e-5);
        EXPECT_LT(glm::length(outwards - normals.pixels[i]), 1e-5);
    }
    EXPECT_GT(seen, 100u);
    // The wall's normal is untouched.
    EXPECT_EQ(normals.pixels[0], glm::vec3(0, 0, 1));
}

TEST(QuadricShading, FromInsideTheNormalTurnsToTheViewer) {
    Scene scene;
    add_quadric(scene, make_sphere({0, 0, 0}, 2), "room", {});
    const auto view = view_of(scene, forward_camera(), {9, 9});
    const NormalImage normals = normal_map(view.screen, view.visibility, true);
    EXPECT_LT(glm::length(normals.pixels[40] - glm::vec3(0, 0, 1)), 1e-6);
}

TEST(QuadricShading, AllLitKindsAgreeOnThem) {
    Scene scene = ball_scene();
    const auto view = view_of(scene, forward_camera(), {80, 60});
    const ColorImage flat = view.shade(Shading::flat);
    const ColorImage gouraud = view.shade(Shading::gouraud), phong = view.shade(Shading::phong);
    const ColorImage unlit = view.shade(Shading::unlit);
    std::size_t seen = 0;
    for (std::uint32_t i = 0; i < flat.pixels.size(); ++i) {
        if (view.visibility.ids[i] != 2) continue;
        ++seen;
        EXPECT_EQ(flat.pixels[i], gouraud.pixels[i]);
        EXPECT_EQ(flat.pixels[i], phong.pixels[i]);
        EXPECT_EQ(unlit.pixels[i], glm::vec4(0.2f, 0.5f, 0.9f, 1));
        // Lit by the headlight: 0.2 + 0.8 cos of the angle to the viewer.
        const auto x = static_cast<std::int32_t>(i % 80 * 256 + 128);
        const auto y = static_cast<std::int32_t>(i / 80 * 256 + 128);
        const QuadricPoint p = quadric_point(view.screen, 2, x, y);
        const double light = 0.2 + 0.8 * glm::dot(p.normal, -glm::normalize(p.position));
        EXPECT_NEAR(flat.pixels[i].g, 0.5 * light, 1e-5);
    }
    EXPECT_GT(seen, 100u);
}

TEST(QuadricShading, PicturesOfNumbersShowTheMaps) {
    Scene scene = ball_scene();
    const auto view = view_of(scene, forward_camera(), {80, 60});
    const DepthImage depth = depth_map(view.screen, view.visibility);
    const ColorImage shown = view.shade(Shading::depth);
    const ColorImage ids = view.shade(Shading::ids);
    const std::size_t middle = 32 * 80 + 42;
    ASSERT_EQ(view.visibility.ids[middle], 2u);
    const Camera& camera = view.camera;
    const double share =
        (double{depth.pixels[middle]} - camera.near_plane) / (camera.far_plane - camera.near_plane);
    EXPECT_NEAR(to_srgb8(shown.pixels[middle].r), 255 * share, 0.51);
    EXPECT_NE(ids.pixels[middle], ids.pixels[0]);
}

TEST(QuadricShading, TheApexOfAConeIsLit) {
    Scene scene;
    add_quadric(scene, make_cone({0, 0, -2}, {0, 0, -3}, 2), "hat", {});
    const auto view = view_of(scene, forward_camera(), {9, 9});  // the apex is in the middle
    ASSERT_EQ(view.visibility.ids[40], 0u);
    EXPECT_GT(view.shade(Shading::flat).pixels[40].r, 0.3f);
}

}  // namespace
}  // namespace sightline
