// Files of formats that assimp reads: what it makes up, leaves out or may not open.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <vector>

#include "scene/load/gltf_document.hpp"
#include "scene/load/off_colors.hpp"
#include "scene/load/sniff.hpp"
#include "scene/meshes.hpp"
#include "support/files.hpp"

namespace sightline {
namespace {

using scene_test::load_one;
using scene_test::load_text;
using scene_test::loaded;
using scene_test::message_of;
using scene_test::raw;
using testing::TemporaryFolder;

std::string with(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

/// A triangle whose corners, and bones, stand in the file tri.bin.
const std::string kGltf = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
"nodes":[{"mesh":0},{"name":"joint"}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
{"bufferView":1,"componentType":5121,"count":3,"type":"VEC4"},
{"bufferView":2,"componentType":5126,"count":3,"type":"VEC4"},
{"bufferView":3,"componentType":5126,"count":1,"type":"MAT4"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":12},
{"buffer":0,"byteOffset":48,"byteLength":48},{"buffer":0,"byteOffset":96,"byteLength":64}],
"buffers":[{"byteLength":160,"uri":"tri.bin"}]})";

std::string buffer() {
    std::string bytes = raw(0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f) + std::string(12, '\0');
    for (int i = 0; i < 3; ++i) bytes += raw(1.f, 0.f, 0.f, 0.f);
    for (int i = 0; i < 16; ++i) bytes += raw(i % 5 == 0 ? 1.f : 0.f);
    return bytes;
}

/// The binary form, in which the JSON's chunk states this size.
std::string binary_gltf(std::uint32_t version, const std::string& json, std::size_t stated,
                        const std::string& rest = "") {
    return "glTF" +
           raw(version, static_cast<std::uint32_t>(20 + json.size() + rest.size()),
               static_cast<std::uint32_t>(stated)) +
           "JSON" + json + rest;
}

const std::string kDae = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset/>
<library_geometries><geometry id="g"><mesh><source id="p">
<float_array id="pa" count="9">0 0 0 1 0 0 1 1 0</float_array><technique_common>
<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="1">
<input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="s"><node>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";

const std::string kOff = "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n";
const std::string kObj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";

/// The only note of a file that can be read.
std::string note_of(const Result<Scene>& result) {
    if (!result) return "error: " + result.error().message;
    return result->notes.size() == 1 ? result->notes[0]
                                     : std::to_string(result->notes.size()) + " notes";
}

TEST(ForeignFiles, BuffersLieInTheFolderOfTheModel) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder.file("in"));
    (void)folder.write("in/tri.bin", buffer());
    EXPECT_EQ(loaded(load_one(folder.write("in/a.gltf", kGltf))).triangle_count(), 1u);
    std::filesystem::rename(folder.file("in/tri.bin"), folder.file("tri.bin"));
    const std::string above = folder.write("in/b.gltf", with(kGltf, "tri.bin", "../tri.bin"));
    EXPECT_NE(message_of(load_one(above)).find("--allow-path"), std::string::npos);
    const std::string whole =
        folder.write("in/c.gltf", with(kGltf, "tri.bin", folder.file("tri.bin")));
    EXPECT_NE(message_of(load_one(whole)).find("could not open"), std::string::npos);
    std::filesystem::create_symlink("../tri.bin", folder.file("in/tri.bin"));
    EXPECT_NE(message_of(load_one(folder.file("in/a.gltf"))).find("--allow-path"),
              std::string::npos);
    LoadOptions options;
    options.allowed_paths = {folder.path()};
    EXPECT_EQ(loaded(load_one(folder.file("in/a.gltf"), options)).triangle_count(), 1u);
}

TEST(ForeignFiles, WhatIsNotReadIsNoted) {
    const TemporaryFolder folder;
    (void)folder.write("tri.bin", buffer());
    const std::string attribute = "\"attributes\":{\"POSITION\":0}";
    const std::string morphed =
        with(kGltf, attribute, attribute + ",\"targets\":[{\"POSITION\":0}]");
    EXPECT_NE(note_of(load_one(folder.write("m.gltf", morphed))).find("morph targets"),
              std::string::npos);
    std::string skinned =
        with(kGltf, "\"POSITION\":0}", "\"POSITION\":0,\"JOINTS_0\":1,\"WEIGHTS_0\":2}");
    skinned = with(skinned, "{\"mesh\":0}", "{\"mesh\":0,\"skin\":0}");
    skinned = with(skinned, "\"scene\":0",
                   "\"skins\":[{\"joints\":[1],\"inverseBindMatrices\":3}],\"scene\":0");
    EXPECT_NE(note_of(load_one(folder.write("s.gltf", skinned))).find("bones are not read"),
              std::string::npos);
    EXPECT_EQ(note_of(load_text(with(kOff, "3 0 1 2", "3 0 1 2 255 0 0"), "off")),
              "input.off: colours of faces are not read");
    EXPECT_TRUE(loaded(load_text(kOff, "off")).notes.empty());
    EXPECT_FALSE(load::off_has_face_colors("# a\nOFF 3 1 0\n0 0 0\n\n1 0 0 # b\n1 1 0\n3 0 1 2"));
    EXPECT_TRUE(load::off_has_face_colors("3 1 0\r\n0 0 0\r\n1 0 0\r\n1 1 0\r\n3 0 1 2 9 9 9"));
    EXPECT_FALSE(load::off_has_face_colors("OFF\n99999999999 1 0\n0 0 0\n"));
}

TEST(ForeignFiles, RequiredExtensionsAreRefusedByName) {
    const auto requiring = [](const std::string& names) {
        return with(kGltf, "\"scene\":0", "\"extensionsRequired\":[" + names + "],\"scene\":0");
    };
    const TemporaryFolder folder;
    (void)folder.write("tri.bin", buffer());
    for (const std::string name : {"KHR_mesh_quantization", "KHR_draco_mesh_compression",
                                   "EXT_meshopt_compression", "SOMEBODY_something"}) {
        const std::string path =
            folder.write("a.gltf", requiring("\"KHR_materials_unlit\",\"" + name + "\""));
        EXPECT_EQ(message_of(load_one(path)),
                  path + ": not a readable gltf file (it requires the extension " + name +
                      ", which is not supported); check or export it again");
    }
    const std::string harmless = requiring("\"KHR_texture_transform\",\"KHR_materials_unlit\"");
    EXPECT_EQ(loaded(load_one(folder.write("a.gltf", harmless))).triangle_count(), 1u);
    const std::string json = requiring("\"KHR_mesh_quantization\"");
    const std::string binary = binary_gltf(2, json, json.size());
    EXPECT_EQ(load::read_gltf_document(binary).fault,
              "it requires the extension KHR_mesh_quantization, which is not supported");
    for (std::size_t cut = 0; cut < binary.size(); cut += 7) {
        EXPECT_NE(load::read_gltf_document(binary.substr(0, cut)).fault, "");
    }
    // By its content assimp finds the format, too, where the name is that of several.
    const std::string other = folder.write("a.xml", std::string(5000, ' ') + json);
    EXPECT_NE(message_of(load_one(other)).find("looks like gltf"), std::string::npos);
}

TEST(ForeignFiles, GltfThatCanBeUnderstoodInAnotherWayIsRefused) {
    const auto fault = [](const std::string& text) {
        return load::read_gltf_document(with(kGltf, "\"scene\":0", text)).fault;
    };
    const std::string required = R"("extensionsRequired":["KHR_mesh_quantization"])";
    EXPECT_EQ(fault(required + R"(,"extensionsRequired":[])"),
              "extensionsRequired: this key stands twice in one object");
    EXPECT_NE(fault(required + ",\"extras\":\"\xe9\"").find("not valid JSON"), std::string::npos);
    EXPECT_NE(fault(required + ",\"extras\":1e999").find("not valid JSON"), std::string::npos);
    EXPECT_NE(load::read_gltf_document(kGltf + '\0' + kGltf).fault, "");
    EXPECT_NE(load::read_gltf_document("[1]").fault, "");
    EXPECT_EQ(fault("\"extras\":\"\xc3\xa9\""), "");
}

TEST(ForeignFiles, SizesInBinaryGltfAreNotBelieved) {
    constexpr std::size_t kMost = 0xffffffff;
    const std::string json = with(kGltf, ",\"uri\":\"tri.bin\"", "");
    const auto chunk = [](std::size_t stated) {
        return raw(static_cast<std::uint32_t>(stated)) + std::string("BIN\0", 4) + buffer();
    };
    const std::string aligned = json + std::string((4 - json.size() % 4) % 4, ' ');
    for (const std::string& padding : {std::string(4, ' '), std::string(4, '\0')}) {
        const std::string text = aligned + padding;
        const std::string good = binary_gltf(2, text, text.size(), chunk(160));
        EXPECT_EQ(loaded(scene_test::load_text(good, "glb")).triangle_count(), 1u);
    }
    for (const std::uint32_t version : {1u, 2u}) {
        const std::string lying = binary_gltf(version, json, kMost);
        EXPECT_NE(message_of(scene_test::load_text(lying, "glb"))
                      .find(std::to_string(kMost) + " bytes, but " + std::to_string(json.size())),
                  std::string::npos);
    }
    EXPECT_NE(load::read_gltf_document(binary_gltf(2, aligned + " ", aligned.size() + 1,
                                                   std::string(3, '\0') + chunk(kMost)))
                  .fault,
              "");
    EXPECT_EQ(load::read_gltf_document(binary_gltf(1, json, json.size(), buffer())).fault, "");
}

TEST(ForeignFiles, NoShapesAreMadeUpForBones) {
    const std::string empty = with(
        with(kDae, "<instance_geometry url=\"#g\"/>", "<node><translate>1 0 0</translate></node>"),
        "<library_geometries>", "<library_geometries/><extra>");
    EXPECT_NE(message_of(load_text(with(empty, "</library_geometries>", "</extra>"), "dae"))
                  .find("no triangles in it"),
              std::string::npos);
}

TEST(ForeignFiles, AReadingThatIsNotRepeatableIsRefused) {
    // Its reader believes the accessor, and reads far beyond the one vertex that the array states.
    std::string corners;
    for (int i = 0; i < 3000; ++i) corners += std::to_string(i) + " ";
    std::string text = with(kDae, "count=\"9\"", "count=\"3\"");
    text = with(with(text, "count=\"3\" stride", "count=\"3000\" stride"), "0 1 2<", corners + "<");
    text = with(text, "triangles count=\"1\"", "triangles count=\"1000\"");
    for (int i = 0; i < 3; ++i) (void)message_of(load_text(text, "dae"));
    EXPECT_EQ(loaded(load_text(kDae, "dae")).triangle_count(), 1u);
}

TEST(ForeignFiles, NullsInWhatIsReadArePassedOver) {
    const std::string face = "0 0 0 1 0 0 1 1 0\n";
    EXPECT_EQ(loaded(load_text("a\n\nb\n" + face, "raw")).triangle_count(), 1u);
    // Its reader puts the first of two groups at no node.
    const Scene two = loaded(load_text("a\n" + face + "b\n" + face + face, "raw"));
    EXPECT_EQ(two.triangle_count(), 3u);
}

TEST(ForeignFiles, AByteOrderMarkIsSkipped) {
    const TemporaryFolder folder;
    (void)folder.write("tri.bin", buffer());
    const std::string mark = "\xef\xbb\xbf";
    EXPECT_EQ(loaded(load_one(folder.write("a.gltf", mark + kGltf))).triangle_count(), 1u);
    EXPECT_EQ(loaded(load_text(mark + kDae, "dae")).triangle_count(), 1u);
    EXPECT_EQ(loaded(load_text(mark + kOff, "off")).triangle_count(), 1u);
    const std::string object = folder.write("a.obj", kObj);
    EXPECT_EQ(loaded(load_one(folder.write("a.json", mark + R"({"models":[{"path":"a.obj"}]})")))
                  .triangle_count(),
              1u);
}

TEST(ForeignFiles, AnotherFormatThanTheNameSaysIsNamed) {
    const std::string stl = std::string(80, ' ') + raw(1u) + std::string(50, '\0');
    const std::vector<std::pair<std::string, std::string>> files = {
        {"obj", kObj}, {"stl", stl},    {"off", kOff},
        {"dae", kDae}, {"gltf", kGltf}, {"ply", "ply\nformat ascii 1.0\nend_header\n"}};
    const TemporaryFolder folder;
    for (const auto& [format, bytes] : files) {
        EXPECT_EQ(load::sniff_format(bytes, bytes.size()), format);
        for (const std::string name : {"obj", "stl", "ply", "off", "glb", "dae", "json"}) {
            if (!load::is_other_format(name, format)) continue;
            const std::string path = folder.write("a." + name, bytes);
            const std::string message = path + ": not a readable " + name +
                                        " file: it looks like " + format +
                                        "; rename it or give --format " + format;
            EXPECT_EQ(message_of(load_one(path)), message);
        }
    }
    EXPECT_EQ(load::sniff_format("PK\x03\x04...", 7), "3mf");
    EXPECT_EQ(load::sniff_format("Kaydara FBX Binary  ", 20), "fbx");
    EXPECT_EQ(load::sniff_format("solid x\nfacet normal 0 0 1\n", 27), "stl");
    EXPECT_EQ(load::sniff_format("nothing that anybody knows", 26), "");
    EXPECT_EQ(load::sniff_format("", 0), "");
}

}  // namespace
}  // namespace sightline
