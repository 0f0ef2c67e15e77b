// Phong's reflection model, and the kinds of shading that use it.
#include "shading/lighting.hpp"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "shading/view_of.hpp"
#include "support/scenes.hpp"

namespace {

using namespace sightline;
using sightline::testing::SceneBuilder;
using test::forward_camera;
using test::View;
using test::view_of;

/// A square of side 4 at depth 2 that faces the viewer.
SceneBuilder wall(bool reversed = false) {
    SceneBuilder builder;
    if (reversed) {
        builder.polygon({{-2, -2, -2}, {-2, 2, -2}, {2, 2, -2}, {2, -2, -2}});
    } else {
        builder.polygon({{-2, -2, -2}, {2, -2, -2}, {2, 2, -2}, {-2, 2, -2}});
    }
    return builder;
}

glm::vec3 centre_color(SceneBuilder& builder, Shading shading) {
    const View view = view_of(builder.scene, forward_camera(), {33, 33});
    return glm::vec3(view.shade(shading).at(16, 16));
}

TEST(Lighting, FacingTheHeadlightShowsTheBaseColor) {
    SceneBuilder builder = wall();
    builder.scene.materials[0].base_color = {0.5f, 0.25f, 1};
    const glm::vec3 color = centre_color(builder, Shading::flat);
    EXPECT_NEAR(glm::length(color - glm::vec3(0.5f, 0.25f, 1)), 0, 1e-6);
}

TEST(Lighting, LambertAndAmbientUnderADirectionalLight) {
    SceneBuilder builder = wall();
    builder.scene.materials[0].base_color = {1, 1, 1};
    Light light;
    light.kind = LightKind::directional;
    light.direction = {0, -3, -4};  // cosine 4/5 to the wall
    light.color = {1, 0.5f, 0};
    light.intensity = 0.5f;
    builder.scene.lights = {light};
    const glm::vec3 color = centre_color(builder, Shading::flat);
    EXPECT_NEAR(color.r, kAmbient + kDiffuse * 0.8f * 0.5f, 1e-6);
    EXPECT_NEAR(color.g, kAmbient + kDiffuse * 0.8f * 0.25f, 1e-6);
    EXPECT_NEAR(color.b, kAmbient, 1e-6);
}

TEST(Lighting, LightFromBehindLeavesTheAmbientPart) {
    SceneBuilder builder = wall();
    builder.scene.materials[0].base_color = {1, 1, 1};
    builder.scene.materials[0].specular = 1;
    Light light;
    light.kind = LightKind::point;
    light.position = {0, 0, -5};
    builder.scene.lights = {light};
    EXPECT_NEAR(centre_color(builder, Shading::flat).r, kAmbient, 1e-6);
}

TEST(Lighting, HighlightFollowsThePowerOfTheMirroredCosine) {
    Camera camera;
    camera.projection = Projection::orthographic;
    Scene scene;
    Light light;
    light.kind = LightKind::directional;
    light.direction = {-0.6, 0, -0.8};  // mirrored by +z it makes cosine 0.8 with the viewer
    scene.lights = {light};
    Material material;
    material.specular = 0.5f;
    material.shininess = 10;
    const Reflection r = Lighting(scene, camera).reflect({0, 0, -3}, {0, 0, 1}, material);
    EXPECT_NEAR(r.specular.r, 0.5 * std::pow(0.8, 10), 1e-6);
    EXPECT_NEAR(r.diffuse.r, kAmbient + kDiffuse * 0.8, 1e-6);
}

TEST(Lighting, BothSidesOfAFaceAreLit) {
    for (const Shading shading : {Shading::flat, Shading::gouraud, Shading::phong}) {
        SceneBuilder front = wall(), back = wall(true);
        front.vertex_normals(std::vector<glm::vec3>(4, {0, 0, 1}));
        back.vertex_normals(std::vector<glm::vec3>(4, {0, 0, -1}));
        const glm::vec3 lit = centre_color(front, shading);
        EXPECT_EQ(lit, centre_color(back, shading));
        EXPECT_GT(lit.r, 2 * kAmbient * 0.6f);  // far more than the ambient part
        SceneBuilder contrary = wall();         // normals against the winding
        contrary.vertex_normals(std::vector<glm::vec3>(4, {0, 0, -1}));
        EXPECT_EQ(lit, centre_color(contrary, shading));
    }
}

TEST(Lighting, GouraudMissesTheHighlightThatPhongFinds) {
    const auto bulge = [] {
        SceneBuilder builder = wall();
        builder.scene.materials[0].specular = 0.5f;
        std::vector<glm::vec3> normals;
        for (const glm::dvec3& p : builder.scene.positions) {
            normals.push_back(glm::normalize(glm::vec3(p.x, p.y, 2)));
        }
        builder.vertex_normals(normals);
        return builder;
    };
    SceneBuilder a = bulge(), b = bulge();
    const float gouraud = centre_color(a, Shading::gouraud).r;
    const float phong = centre_color(b, Shading::phong).r;
    EXPECT_NEAR(phong, 0.6 + 0.5, 1e-3);  // facing: base colour and the whole highlight
    EXPECT_LT(gouraud, 0.6);
    // At a corner of the face the two agree.
    SceneBuilder c = bulge();
    const View view = view_of(c.scene, forward_camera(), {401, 401});
    const float at_corner_gouraud = view.shade(Shading::gouraud).at(0, 0).r;
    EXPECT_NEAR(at_corner_gouraud, view.shade(Shading::phong).at(0, 0).r, 2e-2);
}

TEST(Lighting, WithoutNormalsEveryKindIsFlat) {
    SceneBuilder builder = wall();
    builder.scene.materials[0].specular = 0.3f;
    const View view = view_of(builder.scene, forward_camera(), {21, 21});
    const ColorImage flat = view.shade(Shading::flat);
    EXPECT_EQ(flat.pixels, view.shade(Shading::gouraud).pixels);
    EXPECT_EQ(flat.pixels, view.shade(Shading::phong).pixels);
}

TEST(Lighting, DiagonalsOfPolygonsDoNotShow) {
    SceneBuilder builder = wall();
    builder.scene.materials[0].specular = 0.3f;
    const View view = view_of(builder.scene, forward_camera(), {21, 21});
    const ColorImage flat = view.shade(Shading::flat);
    ASSERT_NE(view.visibility.ids[2], view.visibility.ids[20 * 21 + 18]);
    for (const glm::vec4& p : flat.pixels) EXPECT_EQ(p, flat.pixels[0]);
}

TEST(Lighting, VertexColorsMultiplyTheBaseColor) {
    SceneBuilder builder = wall();
    builder.scene.materials[0].base_color = {0.5f, 0.5f, 0.5f};
    builder.vertex_colors(std::vector<glm::vec4>(4, {0.5f, 1, 0, 1}));
    const glm::vec3 unlit = centre_color(builder, Shading::unlit);
    EXPECT_NEAR(glm::length(unlit - glm::vec3(0.25f, 0.5f, 0)), 0, 1e-6);
}

}  // namespace
