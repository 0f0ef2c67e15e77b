#include "scene/load/scene_file.hpp"

#include <gtest/gtest.h>

#include "scene/meshes.hpp"
#include "sightline/image.hpp"
#include "sightline/load.hpp"
#include "support/files.hpp"

namespace sightline {
namespace {

using load::parse_scene_description;
using load::SceneDescription;
using scene_test::load_one;
using scene_test::loaded;
using scene_test::message_of;
using testing::TemporaryFolder;

std::string error_in(const std::string& text) {
    const Result<SceneDescription> result = parse_scene_description(text, "scene.json");
    if (result.ok()) return "no error";
    EXPECT_EQ(result.error().kind, ErrorKind::bad_input);
    EXPECT_EQ(result.error().message.find('\n'), std::string::npos);
    return result.error().message;
}

std::string in_model(const std::string& members) {
    return R"({"models": [{"path": "a.obj"}, {"path": "b.obj", )" + members + "}]}";
}

std::string in_camera(const std::string& members) {
    return R"({"models": [{"path": "a.obj"}], "camera": {)" + members + "}}";
}

std::string in_light(const std::string& members) {
    return R"({"models": [{"path": "a.obj"}], "lights": [{)" + members + "}]}";
}

SceneDescription parsed(const std::string& text) {
    Result<SceneDescription> result = parse_scene_description(text, "scene.json");
    if (!result.ok()) {
        ADD_FAILURE() << result.error().message;
        return {};
    }
    return std::move(result).value();
}

TEST(SceneFile, ErrorsNameTheKey) {
    EXPECT_EQ(error_in("{}"), "scene.json: models: missing");
    EXPECT_EQ(error_in("[]"),
              "scene.json: expected an object with the keys models, surfaces, lights, camera");
    EXPECT_EQ(error_in(R"({"models": []})"), "scene.json: models: expected at least one model");
    EXPECT_EQ(error_in(R"({"models": {}})"), "scene.json: models: expected a list");
    EXPECT_EQ(error_in(R"({"modles": []})"),
              "scene.json: modles: unknown key; known ones are models, surfaces, lights, camera");
    EXPECT_EQ(error_in(R"({"models": [{"name": "x"}]})"), "scene.json: models[0].path: missing");
    EXPECT_EQ(error_in(R"({"models": [{"path": 7}]})"),
              "scene.json: models[0].path: expected a string");
    EXPECT_EQ(
        error_in(in_model(R"("colour": 1)")),
        "scene.json: models[1].colour: unknown key; known ones are path, name, transform, frames, "
        "material");
    EXPECT_EQ(error_in(in_model(R"("transform": {"scale": 2})")),
              "scene.json: models[1].transform: expected a list");
    EXPECT_EQ(error_in(in_model(R"("transform": [{"rotate": 90}])")),
              "scene.json: models[1].transform[0].rotate: expected an object with the keys axis, "
              "degrees");
    EXPECT_EQ(error_in(in_model(R"("transform": [{"rotate": {"axis": [0,0,0], "degrees": 1}}])")),
              "scene.json: models[1].transform[0].rotate.axis: expected a direction other than [0, "
              "0, 0]");
    EXPECT_EQ(error_in(in_model(R"("transform": [{"scale": 2, "translate": [1,2,3]}])")),
              "scene.json: models[1].transform[0]: expected an object with one key");
    EXPECT_EQ(error_in(in_model(R"("transform": [{"translate": [1, 2]}])")),
              "scene.json: models[1].transform[0].translate: expected [x, y, z], three numbers");
    EXPECT_EQ(error_in(in_model(R"("transform": [{"scale": [1, 0, 1]}])")),
              "scene.json: models[1].transform[0].scale: expected factors other than 0");
    EXPECT_NE(error_in(in_model(R"("transform": [{"matrix": [1, 2]}])"))
                  .find("models[1].transform[0].matrix: expected 16 numbers"),
              std::string::npos);
    EXPECT_EQ(error_in(in_model(R"("material": {"opacity": 2})")),
              "scene.json: models[1].material.opacity: expected a number from 0 to 1");
    EXPECT_NE(error_in(in_model(R"("material": {"base_color": "#12345g"})"))
                  .find("models[1].material.base_color: expected \"#rrggbb\""),
              std::string::npos);
    EXPECT_EQ(error_in(in_model(R"("material": {"base_color": [0, 2, 0]})")),
              "scene.json: models[1].material.base_color[1]: expected a number from 0 to 1");
}

TEST(SceneFile, ErrorsOfLightsAndCameras) {
    EXPECT_EQ(error_in(in_light("")), "scene.json: lights[0].type: missing");
    EXPECT_EQ(error_in(in_light(R"("type": "sun")")),
              "scene.json: lights[0].type: expected \"headlight\", \"directional\" or \"point\"");
    EXPECT_EQ(error_in(in_light(R"("type": "point")")), "scene.json: lights[0].position: missing");
    EXPECT_EQ(error_in(in_light(R"("type": "headlight", "position": [0,0,0])")),
              "scene.json: lights[0].position: only a point light has a position");
    EXPECT_EQ(error_in(in_camera(R"("fov": 180)")),
              "scene.json: camera.fov: expected degrees between 0 and 180");
    EXPECT_EQ(error_in(in_camera(R"("near": 2, "far": 1)")),
              "scene.json: camera.near: expected a number below \"far\"");
    EXPECT_EQ(error_in(in_camera(R"("zoom": "big")")),
              "scene.json: camera.zoom: expected a number");
    EXPECT_NE(error_in(in_camera(R"("view": "sideways")")).find("camera.view: unknown view"),
              std::string::npos);
    EXPECT_NE(error_in(in_camera(R"("ortho_height": 1)")).find("camera.ortho_height: unknown key"),
              std::string::npos);
}

std::string in_surface(const std::string& members) {
    return R"({"surfaces": [{)" + members + "}]}";
}

TEST(SceneFile, ErrorsOfSurfaces) {
    const std::string where = "scene.json: surfaces[0]";
    const std::string kinds = where + ": expected one of the keys sphere, cylinder, cone, quadric";
    EXPECT_EQ(error_in(in_surface("")), kinds);
    EXPECT_EQ(error_in(in_surface(R"("sphere": {"centre": [0,0,0], "radius": 1},
                                     "cone": {"from": [0,0,0], "to": [0,1,0], "radius": 1})")),
              kinds);
    EXPECT_EQ(error_in(in_surface(R"("torus": {})")),
              where +
                  ".torus: unknown key; known ones are sphere, cylinder, cone, quadric, name, "
                  "transform, frames, material");
    EXPECT_EQ(error_in(in_surface(R"("sphere": {"radius": 1})")),
              where + ".sphere.centre: missing");
    EXPECT_EQ(error_in(in_surface(R"("sphere": {"centre": [0,0,0], "radius": 0})")),
              where + ".sphere.radius: expected a number above 0");
    EXPECT_EQ(error_in(in_surface(R"("sphere": {"center": [0,0,0], "radius": 1})")),
              where + ".sphere.center: unknown key; known ones are centre, radius");
    EXPECT_EQ(error_in(in_surface(R"("cone": {"from": [1,2,3], "to": [1,2,3], "radius": 1})")),
              where + R"(.cone.to: expected another point than "from")");
    EXPECT_EQ(error_in(in_surface(R"("cylinder": {"from": [0,0,0], "to": [0,1,0]})")),
              where + ".cylinder.radius: missing");
    const std::string ten =
        ".quadric.coefficients: expected 10 numbers, the factors of x^2, y^2, z^2, xy, xz, yz, x, "
        "y, z and 1, of which one before the last is not 0";
    const std::string box = R"(, "box": [[-1,-1,-1], [1,1,1]]})";
    EXPECT_EQ(error_in(in_surface(R"("quadric": {"coefficients": [1,2])" + box)), where + ten);
    EXPECT_EQ(error_in(in_surface(R"("quadric": {"coefficients": [0,0,0,0,0,0,0,0,0,1])" + box)),
              where + ten);
    const std::string unit = R"("quadric": {"coefficients": [1,1,1,0,0,0,0,0,0,-1])";
    EXPECT_EQ(error_in(in_surface(unit + "}")), where + ".quadric.box: missing");
    EXPECT_EQ(error_in(in_surface(unit + R"(, "box": [[0,0,0]]})")),
              where + ".quadric.box: expected [[x, y, z], [x, y, z]], its lowest and highest");
    EXPECT_EQ(error_in(in_surface(unit + R"(, "box": [[0,0,0], [1,0,1]]})")),
              where + ".quadric.box: expected a lowest corner below the highest one in x, y and z");
    const std::string ball = R"("sphere": {"centre": [0,0,0], "radius": 1}, )";
    const std::string irregular =
        where + ": it is flat, or its size is not between 1e-30 and 1e30; change its numbers";
    EXPECT_EQ(error_in(in_surface(
                  ball + R"("transform": [{"matrix": [1,0,0,0, 0,0,0,0, 0,0,1,0, 0,0,0,1]}])")),
              irregular);
    EXPECT_EQ(error_in(in_surface(ball + R"("transform": [{"scale": 1e40}])")), irregular);
    EXPECT_EQ(error_in(R"({"models": [], "surfaces": []})"),
              "scene.json: models: expected at least one model");
}

TEST(SceneFile, SurfacesAreObjectsOfTheirOwn) {
    const TemporaryFolder folder;
    (void)folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const std::string path = folder.write("scene.json", R"({"surfaces": [
        {"sphere": {"centre": [1, 0, 0], "radius": 2}, "transform": [{"translate": [4, 0, 0]}],
         "name": "ball", "material": {"base_color": [1, 0, 0], "opacity": 0.5}},
        {"cone": {"from": [0, 1, 0], "to": [0, 0, 0], "radius": 1}}],
        "models": [{"path": "a.obj"}]})");
    const Scene scene = loaded(load_one(path));
    ASSERT_EQ(scene.quadrics.size(), 2u);
    ASSERT_EQ(scene.objects.size(), 3u);
    EXPECT_EQ(scene.object_of(1), 1u);
    EXPECT_EQ(scene.objects[1].name, "ball");
    EXPECT_EQ(scene.objects[2].name, "cone");
    EXPECT_EQ(scene.materials[scene.objects[1].material].opacity, 0.5f);
    EXPECT_EQ(scene.materials[scene.objects[1].material].base_color, glm::vec3(1, 0, 0));
    EXPECT_EQ(scene.bounds.hi.x, 7);
    EXPECT_EQ(scene.quadrics[1].kind, QuadricKind::cone);
}

TEST(SceneFile, SurfacesAloneAreAScene) {
    const TemporaryFolder folder;
    const std::string path = folder.write("scene.json", R"({"surfaces": [
        {"quadric": {"coefficients": [1,1,1,0,0,0,0,0,0,-1], "box": [[-1,-1,0],[1,1,1]]}}]})");
    const Scene scene = loaded(load_one(path));
    EXPECT_EQ(scene.triangle_count(), 0u);
    EXPECT_EQ(scene.bounds, (Box{{-1, -1, 0}, {1, 1, 1}}));
}

TEST(SceneFile, BrokenJson) {
    EXPECT_EQ(error_in(R"({"models": [}")").rfind("scene.json: not valid JSON: parse error", 0),
              0u);
    EXPECT_EQ(error_in(R"({"models": [], "models": []})"),
              "scene.json: models: this key stands twice in one object");
    EXPECT_EQ(error_in(in_model(R"("name": "b")") + '\0' + "junk"),
              "scene.json: not valid JSON: byte 64 is NUL");
    EXPECT_NE(error_in(in_camera(R"("zoom": 1e999)")), "no error");
    EXPECT_NE(error_in(std::string(200000, '[')), "no error");
    EXPECT_NE(error_in(std::string(200000, '[') + std::string(200000, ']')), "no error");
}

TEST(SceneFile, NoSceneWithinAScene) {
    EXPECT_EQ(error_in(R"({"models": [{"path": "scene.json"}]})"),
              "scene.json: models[0].path: a scene file cannot hold another one; list its models "
              "instead");
    EXPECT_NE(error_in(R"({"models": [{"path": "../other/SCENE.JSON"}]})"), "no error");
    EXPECT_NE(error_in(R"({"models": [{"path": "-"}]})"), "no error");
}

TEST(SceneFile, OperationsApplyInTheirOrder) {
    const SceneDescription scene = parsed(in_model(R"("transform": [
        {"translate": [1, 0, 0]}, {"rotate": {"axis": [0, 0, 5], "degrees": 90}}, {"scale": 2},
        {"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,7, 0,0,0,1]}])"));
    EXPECT_EQ(scene.models[1].transform * glm::dvec4(0, 0, 0, 1), glm::dvec4(0, 2, 7, 1));
    EXPECT_EQ(scene.models[1].transform * glm::dvec4(0, 1, 0, 1), glm::dvec4(-2, 2, 7, 1));
}

TEST(SceneFile, CamerasLightsAndColours) {
    const SceneDescription scene = parsed(R"({"models": [{"path": "a.obj",
        "material": {"base_color": "#ff8000", "shininess": 5}}],
        "lights": [{"type": "directional", "direction": [0,-1,0], "color": [1, 0.5, 0], "intensity": 2},
                   {"type": "point", "position": [1,2,3]}, {"type": "headlight"}],
        "camera": {"eye": [1,2,3], "up": [0,0,1], "projection": "cabinet", "oblique-angle": 30,
                   "view": "front", "ortho-height": 4, "near": -1, "far": 9}})");
    EXPECT_EQ(*scene.models[0].material.base_color, glm::vec3(1, from_srgb8(128), 0));
    EXPECT_EQ(*scene.models[0].material.shininess, 5.0f);
    EXPECT_FALSE(scene.models[0].material.opacity.has_value());
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[0].kind, LightKind::directional);
    EXPECT_EQ(scene.lights[0].color, glm::vec3(1, 0.5f, 0));
    EXPECT_EQ(scene.lights[0].intensity, 2.0f);
    EXPECT_EQ(scene.lights[1].position, glm::dvec3(1, 2, 3));
    ASSERT_TRUE(scene.camera.has_value());
    EXPECT_EQ(scene.camera->eye, glm::dvec3(1, 2, 3));
    EXPECT_EQ(scene.camera->projection, Projection::cabinet);
    EXPECT_EQ(scene.camera->view, NamedView::front);
    EXPECT_EQ(scene.camera->ortho_height, 4.0);
    EXPECT_FALSE(scene.camera->fov.has_value());
}

TEST(SceneFile, ModelsAreFoundBesideIt) {
    const TemporaryFolder folder;
    (void)folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const std::string path = folder.write("scene.json", R"({"models": [
        {"path": "a.obj", "name": "left", "material": {"opacity": 0.5}},
        {"path": "a.obj", "name": "right", "transform": [{"scale": [-1, 1, 1]}]}],
        "camera": {"fov": 20}, "lights": [{"type": "headlight", "intensity": 0.5}]})");
    const Scene scene = loaded(load_one(path));
    ASSERT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(scene.objects[0].name, "left");
    EXPECT_EQ(scene.objects[1].name, "right");
    EXPECT_EQ(scene.materials[scene.objects[0].material].opacity, 0.5f);
    EXPECT_EQ(scene.materials[scene.objects[1].material].opacity, 1.0f);
    EXPECT_EQ(scene.bounds.lo.x, -1);
    EXPECT_EQ(scene.positions[scene.triangles[1].y], glm::dvec3(0, 1, 0)) << "mirrored";
    ASSERT_TRUE(scene.camera.has_value());
    EXPECT_EQ(scene.camera->fov, 20.0);
    EXPECT_EQ(scene.lights.size(), 1u);
}

TEST(SceneFile, TransformsThatOverflowAreBlamed) {
    const std::string scale = R"({"scale": 1e300})";
    EXPECT_EQ(error_in(in_model("\"transform\": [" + scale + ", " + scale + "]")),
              "scene.json: models[1].transform: its numbers overflow; use smaller ones");
    const TemporaryFolder folder;
    (void)folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const std::string beginning = R"({"models": [{"path": "a.obj", "transform": [)" + scale;
    EXPECT_NE(message_of(load_one(folder.write("s.json", beginning + "]}]}")))
                  .find("it comes from the transforms of the object"),
              std::string::npos);
    const std::string back = beginning + R"(, {"scale": 1e-300}]}]})";
    EXPECT_EQ(loaded(load_one(folder.write("s.json", back))).triangle_count(), 1u);
}

TEST(SceneFile, AMissingModelIsNamed) {
    const TemporaryFolder folder;
    const std::string path = folder.write("scene.json", R"({"models": [{"path": "gone.obj"}]})");
    EXPECT_EQ(message_of(load_one(path)).rfind(folder.path() + "/gone.obj: cannot read it", 0), 0u);
}

}  // namespace
}  // namespace sightline
