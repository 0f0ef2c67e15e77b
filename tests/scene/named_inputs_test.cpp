// What a model names is an input, whether it is read or not: no output may overwrite it.
#include <gtest/gtest.h>

#include <filesystem>
#include <vector>

#include "scene/load/texture_names.hpp"
#include "scene/meshes.hpp"
#include "support/files.hpp"

namespace sightline {
namespace {

using scene_test::load_one;
using scene_test::loaded;
using scene_test::message_of;
using testing::TemporaryFolder;

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";

/// The triangle as glTF, with more members and these materials; the first is used.
std::string gltf(const std::string& members, const std::string& materials) {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
           R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],)"
           R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)"
           R"("bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":)"
           R"("data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8)"
           R"(AAAAA"}],)" +
           members + R"(,"materials":[)" + materials + "]}";
}

/// Whether loading the model fails because the output (made here) is an input of it.
bool refuses(const std::string& model, const std::string& output) {
    LoadOptions options;
    options.outputs = {output};
    const Result<Scene> result = load_one(model, options);
    return !result && result.error().kind == ErrorKind::bad_option &&
           result.error().message.find("is an input of") != std::string::npos;
}

std::string notes_of(const std::string& model) {
    std::string all;
    for (const std::string& note : loaded(load_one(model)).notes) all += note + "\n";
    return all;
}

TEST(NamedInputs, TexturesOfGltfWhateverUsesThem) {
    const TemporaryFolder folder;
    const std::string image = folder.write("im.png", "a picture");
    for (
        const std::string materials :
        {R"({"extensions":{"KHR_materials_clearcoat":{"clearcoatTexture":{"index":0}}}})",
         R"({"extensions":{"KHR_materials_specular":{"specularTexture":{"index":0}}}})",
         R"({"extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseTexture":{"index":0}}}})",
         R"({},{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})", "{}"}) {
        const std::string model = folder.write(
            "a.gltf", gltf(R"("images":[{"uri":"im.png"}],"textures":[{"source":0}])", materials));
        EXPECT_TRUE(refuses(model, image)) << materials;
        EXPECT_NE(notes_of(model).find("textures are not drawn: 1 ('im.png')"), std::string::npos);
        EXPECT_FALSE(refuses(model, folder.write("other.png", "")));
    }
}

TEST(NamedInputs, UrisAreDecoded) {
    const TemporaryFolder folder;
    const std::string model = folder.write(
        "a.gltf", gltf(R"("images":[{"uri":"tx%20b%2Fc%e4%zz.png"}],"extensions":{"X":{"a":[)"
                       R"({"uri":"sound.mp3"}]}})",
                       "{}"));
    std::filesystem::create_directory(folder.file("tx b"));
    EXPECT_TRUE(refuses(model, folder.write("tx b/c\xe4%zz.png", "")));
    EXPECT_TRUE(refuses(model, folder.write("sound.mp3", "")));
    EXPECT_NE(notes_of(model).find("('tx b/c?%zz.png')"), std::string::npos) << notes_of(model);
}

TEST(NamedInputs, MaterialLibrariesThatMayNotBeRead) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.file("m"));
    std::filesystem::create_directories(folder.file("lib"));
    const std::string library = folder.write("lib/x.png", "newmtl a\n");
    const std::string quoted = folder.write("m/q m.mtl", "newmtl a\n");
    EXPECT_TRUE(refuses(folder.write("m/a.obj", "mtllib ../lib/x.png\n" + kTriangle), library));
    EXPECT_TRUE(refuses(folder.write("m/b.obj", "mtllib \"q m.mtl\"\n" + kTriangle), quoted));
}

TEST(NamedInputs, TexturesOfMaterialLibraries) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder.file("mat"));
    const std::string model = folder.write("m.obj", "mtllib mat/m.mtl\nusemtl a\n" + kTriangle);
    for (const auto& [line, name] : std::vector<std::pair<std::string, std::string>>{
             {"map_Kd -o 1 1 1 -s 2 2 2 t 1.png", "t 1.png"},
             {"map_Kd \"c t.png\"", "c t.png"},
             {"map_Kd \\\nct.png", "ct.png"},
             {"map_Kd \\\r\nct.png", "ct.png"},
             {"map_Kd C:\\folder\\a b.png", "a b.png"},
             {"MAP_KD -clamp on 'q r.png'", "q r.png"},
             {"bump b c.png -bm 2 # a comment", "b c.png"}}) {
        (void)folder.write("mat/m.mtl", line + "\nnewmtl a\nKd 1 0 0\n");
        for (const std::string& place : {name, "mat/" + name}) {
            EXPECT_TRUE(refuses(model, folder.write(place, ""))) << line << " at " << place;
            std::filesystem::remove(folder.file(place));
        }
    }
    EXPECT_FALSE(refuses(model, folder.write("other.png", "")));
}

TEST(NamedInputs, TexturesOfPly) {
    const TemporaryFolder folder;
    const std::string rest =
        "\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n";
    for (const std::string name : {"pt.png", "p t 2.png"}) {
        const std::string model =
            folder.write("a.ply", "ply\nformat ascii 1.0\ncomment TextureFile " + name + rest);
        EXPECT_TRUE(refuses(model, folder.write(name, ""))) << name;
        EXPECT_NE(notes_of(model).find("('" + name + "')"), std::string::npos);
    }
}

TEST(NamedInputs, StatementsOfTexturesCanBeReadInSeveralWays) {
    using Names = std::vector<std::string>;
    EXPECT_EQ(load::names_in_map("a.png"), Names{"a.png"});
    EXPECT_EQ(load::names_in_map("  -mm 0 1 a.png\t"),
              (Names{"a.png", "0 1 a.png", "1 a.png", "-mm 0 1 a.png"}));
    EXPECT_EQ(load::names_in_map("-type sphere \"a b\""),
              (Names{"a b", "\"a b\"", "b\"", "sphere \"a b\"", "-type sphere \"a b\""}));
    EXPECT_EQ(load::names_in_map("a -o.png").front(), "a -o.png");
    EXPECT_EQ(load::names_in_map("-clamp a.png"), (Names{"a.png", "-clamp a.png"}));
    EXPECT_EQ(load::names_in_map(" "), Names{});
    EXPECT_EQ(load::names_in("a b # c"), (Names{"a b", "a b # c", "c"}));
    EXPECT_EQ(load::names_in("\""), Names{"\""});
}

TEST(NamedInputs, Utf16IsRefusedByName) {
    const auto wide = [](const std::string& text, bool mark) {
        std::string bytes = mark ? "\xff\xfe" : "";
        for (const char c : text) bytes += std::string{c, '\0'};
        return bytes;
    };
    const TemporaryFolder folder;
    for (const bool mark : {false, true}) {
        for (const std::string name : {"a.obj", "a.ply", "a.json", "a.stl"}) {
            const std::string path = folder.write(name, wide("solid x, or something", mark));
            EXPECT_EQ(message_of(load_one(path)),
                      path + ": it is in UTF-16, which is not read (save it as UTF-8)");
        }
        (void)folder.write("m.mtl", wide("newmtl a\nKd 1 0 0\n", mark));
        EXPECT_NE(
            notes_of(folder.write("m.obj", "mtllib m.mtl\nusemtl a\n" + kTriangle))
                .find("'m.mtl' is in UTF-16, which is not read (save it as UTF-8); its materials"),
            std::string::npos);
    }
    // Any bytes may stand in the header of a binary STL file.
    const std::string header = wide("solid", true) + std::string(68, ' ');
    const float facet[12] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 1, 0};
    const std::string bytes = header + scene_test::raw(1u) +
                              std::string(reinterpret_cast<const char*>(facet), sizeof facet) +
                              std::string(2, '\0');
    EXPECT_EQ(loaded(scene_test::load_text(bytes, "stl")).triangle_count(), 1u);
}

}  // namespace
}  // namespace sightline
