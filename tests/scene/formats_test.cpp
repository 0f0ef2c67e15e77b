#include <gtest/gtest.h>

#include <algorithm>

#include "scene/meshes.hpp"
#include "sightline/image.hpp"
#include "sightline/load.hpp"
#include "support/files.hpp"

namespace sightline {
namespace {

using scene_test::load_one;
using scene_test::load_text;
using scene_test::loaded;
using scene_test::raw;
using testing::TemporaryFolder;

// A square of one quad with a triangle hinged to it, two polygons on five points.
const char* const kObj =
    "o square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nf 1 2 3 4\nf 1 2 5\n";

void expect_square_and_triangle(const Scene& scene, const std::string& name) {
    ASSERT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(scene.objects[0].name, name);
    EXPECT_EQ(scene.objects[0].triangle_count, 3u);
    EXPECT_EQ(scene.objects[0].polygon_count, 2u);
    EXPECT_EQ(scene.positions.size(), 5u) << "equal positions are joined";
    EXPECT_EQ(scene.triangle_polygon, (std::vector<std::uint32_t>{0, 0, 1}));
    EXPECT_EQ(scene.polygon_edges, (std::vector<std::uint8_t>{0b011, 0b110, 0b111}));
    EXPECT_EQ(scene.bounds.hi, glm::dvec3(1, 1, 1));
    EXPECT_EQ(scene.counts.polygons, 2u);
    EXPECT_TRUE(scene.degenerate.empty());
}

TEST(Formats, Obj) {
    const TemporaryFolder folder;
    expect_square_and_triangle(loaded(load_one(folder.write("a.obj", kObj))), "square");
    expect_square_and_triangle(loaded(load_text(kObj, "obj")), "square");
}

TEST(Formats, TheFormatOptionOverridesTheExtension) {
    const TemporaryFolder folder;
    LoadOptions options;
    options.format = "obj";
    expect_square_and_triangle(loaded(load_one(folder.write("a.stl", kObj), options)), "square");
    expect_square_and_triangle(loaded(load_one(folder.write("nothing", kObj), options)), "square");
}

TEST(Formats, ExtensionsInCapitals) {
    const TemporaryFolder folder;
    expect_square_and_triangle(loaded(load_one(folder.write("A.OBJ", kObj))), "square");
}

TEST(Formats, ObjMaterialsAreDisplayColours) {
    const TemporaryFolder folder;
    (void)folder.write("a.mtl", "newmtl half\nKd 0.5 0 1\nd 0.25\n");
    const Scene scene =
        loaded(load_one(folder.write("a.obj", "mtllib a.mtl\nusemtl half\n" + std::string(kObj))));
    ASSERT_EQ(scene.objects.size(), 1u);
    const Material& material = scene.materials[scene.objects[0].material];
    EXPECT_EQ(material.name, "half");
    EXPECT_EQ(material.base_color, glm::vec3(from_srgb8(128), 0, 1));
    EXPECT_EQ(material.opacity, 0.25f);
}

TEST(Formats, WithoutMaterialsTheDefaultIsGrey) {
    const Scene scene = loaded(load_text(kObj, "obj"));
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].base_color, Material{}.base_color);
    EXPECT_EQ(scene.materials[0].opacity, 1.0f);
}

TEST(Formats, ObjNormalsAndObjects) {
    const Scene scene =
        loaded(load_text("o one\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 3\nf 1//1 2//1 3//1\n"
                         "o two\nv 0 0 2\nv 1 0 2\nv 1 1 2\nf 4 5 6\nl 4 5\n",
                         "obj"));
    ASSERT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(scene.objects[1].name, "two");
    EXPECT_EQ(scene.objects[1].first_triangle, 1u);
    EXPECT_EQ(scene.objects[1].first_polygon, 1u);
    EXPECT_TRUE(scene.objects[0].has_file_normals);
    EXPECT_FALSE(scene.objects[1].has_file_normals);
    ASSERT_EQ(scene.triangle_normals.size(), 2u);
    EXPECT_EQ(scene.normals[scene.triangle_normals[0].x], glm::vec3(0, 0, 1));
    EXPECT_EQ(scene.triangle_normals[1], Corners(kNone));
    EXPECT_EQ(scene.counts.ignored_primitives, 1u);
}

TEST(Formats, DroppedTrianglesKeepTheirNumber) {
    const Scene scene = loaded(load_text(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\nf 1 1 2\nf 2 4 3\n", "obj"));
    ASSERT_EQ(scene.triangle_count(), 4u);
    EXPECT_EQ(scene.degenerate, (std::vector<std::uint8_t>{0, 1, 1, 0}));
    EXPECT_EQ(scene.triangle_polygon, (std::vector<std::uint32_t>{0, 1, 2, 3}));
    EXPECT_EQ(scene.counts.degenerate_triangles, 2u);
}

TEST(Formats, ConcavePolygonsAreCounted) {
    const Scene scene =
        loaded(load_text("v 0 0 0\nv 2 -2 0\nv 0 4 0\nv -2 -2 0\nf 2 3 4 1\n", "obj"));
    EXPECT_EQ(scene.triangle_count(), 2u);
    EXPECT_EQ(scene.counts.concave_polygons, 1u);
}

std::string ply_header(const std::string& format) {
    return "ply\nformat " + format +
           " 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string binary_ply() {
    return ply_header("binary_little_endian") + raw(0.f, 0.f, 0.f) + raw(1.f, 0.f, 0.f) +
           raw(1.f, 1.f, 0.f) + raw(0.f, 1.f, 0.f) + raw(0.f, 0.f, 1.f) +
           raw(std::uint8_t{4}, 0, 1, 2, 3) + raw(std::uint8_t{3}, 0, 1, 4);
}

TEST(Formats, Ply) {
    const TemporaryFolder folder;
    const std::string ascii =
        ply_header("ascii") + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n4 0 1 2 3\n3 0 1 4\n";
    expect_square_and_triangle(loaded(load_one(folder.write("a.ply", ascii))), "a");
    expect_square_and_triangle(loaded(load_one(folder.write("b.ply", binary_ply()))), "b");
}

TEST(Formats, PlyColoursAreDisplayColours) {
    const Scene scene = loaded(load_text(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 255 0 0\n1 0 0 0 128 0\n0 1 0 0 0 55\n3 0 1 2\n",
        "ply"));
    ASSERT_EQ(scene.triangle_colors.size(), 1u);
    const Corners& c = scene.triangle_colors[0];
    EXPECT_EQ(scene.colors[c.x], glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(scene.colors[c.y], glm::vec4(0, from_srgb8(128), 0, 1));
    EXPECT_EQ(scene.colors[c.z], glm::vec4(0, 0, from_srgb8(55), 1));
    EXPECT_EQ(scene.materials[scene.objects[0].material].base_color, glm::vec3(1, 1, 1));
}

TEST(Formats, Stl) {
    const TemporaryFolder folder;
    const std::string ascii =
        "solid part\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\n"
        "endloop\nendfacet\nendsolid part\n";
    const std::string binary = std::string(80, ' ') + raw(std::uint32_t{1}) + raw(0.f, 0.f, 1.f) +
                               raw(0.f, 0.f, 0.f) + raw(1.f, 0.f, 0.f) + raw(1.f, 1.f, 0.f) +
                               raw(std::uint16_t{0});
    for (const std::string& content : {ascii, binary}) {
        const Scene scene = loaded(load_one(folder.write("a.stl", content)));
        EXPECT_EQ(scene.triangle_count(), 1u);
        EXPECT_EQ(scene.positions.size(), 3u);
        EXPECT_EQ(scene.bounds.hi, glm::dvec3(1, 1, 0));
    }
}

TEST(Formats, Off) {
    const std::string off = "OFF\n5 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n4 0 1 2 3\n3 0 1 4\n";
    expect_square_and_triangle(loaded(load_text(off, "off")), "input");
}

/// One mesh of one triangle at two nodes, the second below the first.
std::string gltf() {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"name":"first","mesh":0,"translation":[10,0,0],"children":[1]},
         {"name":"mirrored","mesh":0,"scale":[-2,1,1],"translation":[0,5,0]}],
"materials":[{"name":"paint","pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,0.5]},"alphaMode":"BLEND"}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
"buffers":[{"uri":"a.bin","byteLength":42}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
             {"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}]})";
}

TEST(Formats, GltfNodesAndLinearColours) {
    const TemporaryFolder folder;
    (void)folder.write("a.bin", raw(0.f, 0.f, 0.f) + raw(1.f, 0.f, 0.f) + raw(0.f, 1.f, 0.f) +
                                    raw(std::uint16_t{0}, std::uint16_t{1}, std::uint16_t{2}));
    const Scene scene = loaded(load_one(folder.write("a.gltf", gltf())));
    ASSERT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(scene.objects[0].name, "first");
    EXPECT_EQ(scene.objects[1].name, "mirrored");
    const auto corner = [&](std::uint32_t t, int k) {
        return scene.positions[scene.triangles[t][k]];
    };
    EXPECT_EQ(corner(0, 1), glm::dvec3(11, 0, 0));
    EXPECT_EQ(corner(1, 0), glm::dvec3(10, 5, 0));
    EXPECT_EQ(corner(1, 1), glm::dvec3(10, 6, 0)) << "the mirror turns the order of corners";
    EXPECT_EQ(corner(1, 2), glm::dvec3(8, 5, 0));
    const Material& material = scene.materials[scene.objects[0].material];
    EXPECT_EQ(material.base_color, glm::vec3(0.5f, 0.25f, 1.0f));
    EXPECT_EQ(material.opacity, 0.5f);
}

TEST(Formats, SeveralModelsInOrder) {
    const TemporaryFolder folder;
    const std::vector<std::string> paths{folder.write("a.obj", kObj),
                                         folder.write("b.ply", binary_ply())};
    const Scene scene = loaded(load_scene(paths));
    ASSERT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(scene.objects[1].name, "b");
    EXPECT_EQ(scene.objects[1].first_triangle, 3u);
    EXPECT_EQ(scene.objects[1].first_polygon, 2u);
    EXPECT_EQ(scene.triangle_polygon[5], 3u);
    EXPECT_EQ(scene.positions.size(), 10u) << "objects share no positions";
}

TEST(Formats, ExtensionsAreSorted) {
    const std::vector<std::string> all = loadable_extensions();
    EXPECT_TRUE(std::ranges::is_sorted(all));
    for (const char* known : {"obj", "ply", "stl", "off", "gltf", "glb", "json"}) {
        EXPECT_TRUE(std::ranges::binary_search(all, known)) << known;
    }
}

}  // namespace
}  // namespace sightline
