// The reader of OBJ and MTL files.
#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <random>

#include "scene/load/obj_materials.hpp"
#include "scene/load/reader.hpp"
#include "scene/load/scan.hpp"
#include "scene/meshes.hpp"
#include "support/files.hpp"

namespace sightline {
namespace {

using scene_test::load_one;
using scene_test::load_text;
using scene_test::loaded;
using scene_test::message_of;
using testing::TemporaryFolder;

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

std::vector<std::string> object_names(const Scene& scene) {
    std::vector<std::string> names;
    for (const Object& object : scene.objects) names.push_back(object.name);
    return names;
}

glm::dvec3 corner(const Scene& scene, std::uint32_t triangle, int k) {
    return scene.positions[scene.triangles[triangle][k]];
}

std::string error_of(const std::string& text) { return message_of(load_text(text, "obj")); }

template <class Real = float>
Real scanned(const std::string& number) {
    const std::string text = number + "\n";
    Real value = -12345;
    const char* const end = load::scan_real(text.data(), value);
    EXPECT_TRUE(end != nullptr && *end == '\n') << number;
    return value;
}

TEST(ObjReader, NumbersAreRoundedCorrectly) {
    EXPECT_EQ(scanned("1"), 1.0f);
    EXPECT_EQ(scanned("+1.5E+2"), 150.0f);
    EXPECT_EQ(scanned("-.5"), -0.5f);
    EXPECT_EQ(scanned("7."), 7.0f);
    EXPECT_TRUE(std::signbit(scanned("-0")));
    // Between 1 and the next float; a double would lie exactly in the middle.
    EXPECT_EQ(scanned("1.00000005960464477539062500001"), std::nextafter(1.0f, 2.0f));
    EXPECT_EQ(scanned("1.000000059604644775390625"), 1.0f);
    EXPECT_EQ(scanned("1.00000005960464478"), std::nextafter(1.0f, 2.0f));
    EXPECT_EQ(scanned("3.4028235e38"), std::numeric_limits<float>::max());
    EXPECT_EQ(scanned("1e-45"), std::numeric_limits<float>::denorm_min());
    EXPECT_EQ(scanned("1e39"), std::numeric_limits<float>::infinity());
    EXPECT_EQ(scanned("-1e999"), -std::numeric_limits<float>::infinity());
    EXPECT_EQ(scanned("1e-999"), 0.0f);
    EXPECT_EQ(scanned("0." + std::string(500, '0') + "1"), 0.0f);
    EXPECT_EQ(scanned("1" + std::string(500, '0')), std::numeric_limits<float>::infinity());
    EXPECT_TRUE(std::isnan(scanned("nan")));
    EXPECT_TRUE(std::isnan(scanned("-1.#IND00")));
    EXPECT_EQ(scanned("1.#INF"), std::numeric_limits<float>::infinity());
    EXPECT_EQ(scanned("-inf"), -std::numeric_limits<float>::infinity());
}

TEST(ObjReader, DoublesAreRoundedCorrectly) {
    EXPECT_EQ(scanned<double>("431200.18"), 431200.18);
    EXPECT_EQ(scanned<double>("-5171799.7"), -5171799.7);
    // Between 1 and the next double.
    EXPECT_EQ(scanned<double>("1.00000000000000011102230246251565404"), 1.0);
    EXPECT_EQ(scanned<double>("1.00000000000000011102230246251565405"), std::nextafter(1.0, 2.0));
    EXPECT_EQ(scanned<double>("9007199254740993"), 9007199254740992.0);
    EXPECT_EQ(scanned<double>("5e-324"), std::numeric_limits<double>::denorm_min());
    EXPECT_EQ(scanned<double>("1e-400"), 0.0);
    EXPECT_EQ(scanned<double>("-1e400"), -std::numeric_limits<double>::infinity());
    EXPECT_EQ(scanned<double>("1.#INF"), std::numeric_limits<double>::infinity());
    EXPECT_TRUE(std::isnan(scanned<double>("-1.#IND00")));
    std::mt19937_64 random(8);
    std::array<char, 64> text;
    for (int i = 0; i < 20000; ++i) {
        const double exact = std::bit_cast<double>(random());
        if (!std::isfinite(exact)) continue;
        const double value = random() % 2 == 0 ? exact : std::remainder(exact, 1e7);
        const auto printed =
            std::to_chars(text.data(), text.data() + text.size(), value,
                          std::chars_format::scientific, static_cast<int>(random() % 25));
        double expected = 0;
        const auto read = std::from_chars(text.data(), printed.ptr, expected);
        if (read.ec != std::errc()) continue;
        const std::string number(text.data(), printed.ptr);
        ASSERT_EQ(std::bit_cast<std::uint64_t>(scanned<double>(number)),
                  std::bit_cast<std::uint64_t>(expected))
            << number;
    }
}

TEST(ObjReader, NumbersEqualTheStandardLibrarys) {
    std::mt19937_64 random(7);
    std::array<char, 64> text;
    for (int i = 0; i < 20000; ++i) {
        // Any float and its neighbourhood as a double, in all notations and lengths.
        const auto bits = static_cast<std::uint32_t>(random());
        const double exact = std::bit_cast<float>(bits);
        if (!std::isfinite(exact)) continue;
        const double near =
            exact * (1 + static_cast<double>(random() % 9) * 1.49011611938476563e-8);
        const bool plain = std::abs(near) < 1e9 && random() % 2 == 0;
        const auto printed =
            std::to_chars(text.data(), text.data() + text.size(), near,
                          plain ? std::chars_format::fixed : std::chars_format::scientific,
                          static_cast<int>(random() % 20));
        if (printed.ec != std::errc()) continue;
        float expected = 0;
        const auto read = std::from_chars(text.data(), printed.ptr, expected);
        if (read.ec != std::errc()) continue;
        const std::string number(text.data(), printed.ptr);
        ASSERT_EQ(std::bit_cast<std::uint32_t>(scanned(number)),
                  std::bit_cast<std::uint32_t>(expected))
            << number;
    }
}

TEST(ObjReader, LineEndsContinuationsAndComments) {
    const std::string text =
        "\xef\xbb\xbf# first \\\r\nv 0 0 0 # origin\r\nv 1 0 \\\r\n 0\r\n\r\n"
        "  v\t1 1 0\nunknown 1 2 3\nf 1 \\\n2 3#end";
    for (const bool macintosh : {false, true}) {
        std::string lines = text;
        if (macintosh) {  // single carriage returns; a continuation needs a line feed
            lines = "# first\rv 0 0 0 # origin\rv 1 0 0\r\rv 1 1 0\rf 1 2 3";
        }
        const Scene scene = loaded(load_text(lines, "obj"));
        ASSERT_EQ(scene.triangle_count(), 1u);
        EXPECT_EQ(corner(scene, 0, 1), glm::dvec3(1, 0, 0));
        EXPECT_EQ(corner(scene, 0, 2), glm::dvec3(1, 1, 0));
    }
}

TEST(ObjReader, IndicesFromTheEnd) {
    const Scene scene = loaded(load_text(kSquare + "f -4 -3 -2\nv 5 5 5\nf -1 1 2\n", "obj"));
    EXPECT_EQ(corner(scene, 0, 0), glm::dvec3(0, 0, 0));
    EXPECT_EQ(corner(scene, 0, 2), glm::dvec3(1, 1, 0));
    EXPECT_EQ(corner(scene, 1, 0), glm::dvec3(5, 5, 5));
}

TEST(ObjReader, IndicesMayPointAhead) {
    const Scene scene = loaded(load_text("f 1 2 3\n" + kSquare, "obj"));
    EXPECT_EQ(corner(scene, 0, 2), glm::dvec3(1, 1, 0));
}

TEST(ObjReader, NormalsOfSomeCorners) {
    const Scene scene =
        loaded(load_text(kSquare + "vn 0 0 2\nvn 0 3 4\nvt 0 0\n"
                                   "f 1 2 3\nf 1//1 2/1/2 3//-2\nf 1//1 2 3//1\nf 1/1 2/ 3/1/\n",
                         "obj"));
    ASSERT_EQ(scene.triangle_normals.size(), 4u);
    EXPECT_EQ(scene.triangle_normals[0], Corners(kNone));
    const Corners& normals = scene.triangle_normals[1];
    EXPECT_EQ(scene.normals[normals.x], glm::vec3(0, 0, 1));
    EXPECT_EQ(scene.normals[normals.y], glm::vec3(0, 0.6f, 0.8f));
    EXPECT_EQ(normals.x, normals.z);
    EXPECT_EQ(scene.triangle_normals[2], Corners(kNone)) << "at all corners or at none";
    EXPECT_EQ(scene.triangle_normals[3], Corners(kNone));
}

TEST(ObjReader, ColoursAfterPositions) {
    const Scene scene = loaded(
        load_text("v 0 0 0\nv 1 0 0 1 0 0\nv 1 1 0 0 1 0 1\nv 4 2 0 2\nf 1 2 3\nf 1 2 4\n", "obj"));
    ASSERT_EQ(scene.triangle_colors.size(), 2u);
    const Corners& colors = scene.triangle_colors[0];
    EXPECT_EQ(scene.colors[colors.x], glm::vec4(1, 1, 1, 1)) << "white where there is none";
    EXPECT_EQ(scene.colors[colors.y], glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(scene.colors[colors.z], glm::vec4(0, 1, 0, 1));
    EXPECT_EQ(corner(scene, 1, 2), glm::dvec3(2, 1, 0)) << "a fourth number is a weight";
}

TEST(ObjReader, ObjectsGroupsAndMaterials) {
    const Scene scene = loaded(load_text(
        kSquare + "f 1 2 3\nusemtl red\nf 1 2 3\no the house\nf 1 2 4\nusemtl blue\nf 1 3 4\n"
                  "g the house\nf 2 3 4\ng the house\nf 1 2 4\no the house\no empty\ng roof top\n"
                  "usemtl red\nf 1 2 3\n",
        "obj"));
    EXPECT_EQ(object_names(scene), (std::vector<std::string>{"input", "red", "the house", "blue",
                                                             "the house", "roof top"}));
    std::vector<std::uint32_t> sizes;
    std::vector<std::string> materials;
    for (const Object& object : scene.objects) {
        sizes.push_back(object.triangle_count);
        materials.push_back(scene.materials[object.material].name);
    }
    EXPECT_EQ(sizes, (std::vector<std::uint32_t>{1, 1, 1, 1, 2, 1}));
    EXPECT_EQ(materials, (std::vector<std::string>{"", "red", "red", "blue", "blue", "red"}));
}

TEST(ObjReader, WhatIsNotDrawnIsCounted) {
    const Scene scene = loaded(
        load_text(kSquare + "f 1 2 3\nl 1 2 3\np 1 2\np 4\nf 1 2\nf -1 -2\nf 1 3 4\n", "obj"));
    EXPECT_EQ(scene.counts.ignored_primitives, 2u + 3u + 2u);
    EXPECT_EQ(scene.triangle_count(), 2u);
}

TEST(ObjReader, MaterialFiles) {
    const TemporaryFolder folder;
    (void)folder.write("my colours.mtl", "newmtl light blue\r\nKd 0 0 1\r\nTr 0.75\r\n");
    (void)folder.write("b.mtl", "newmtl b\nKd 0 1 0\nd -halo 0.5\n  newmtl gone\n Kd 1\n d 0\n");
    const std::string faces = kSquare +
                              "usemtl light blue\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl gone\nf 1 2 3"
                              "\nusemtl undefined\nf 1 2 3\n";
    const Scene scene = loaded(
        load_one(folder.write("a.obj", "mtllib my colours.mtl\nmtllib no.mtl .\\b.mtl\n" + faces)));
    ASSERT_EQ(scene.objects.size(), 4u);
    const auto material = [&](std::size_t i) { return scene.materials[scene.objects[i].material]; };
    EXPECT_EQ(material(0).base_color, glm::vec3(0, 0, 1));
    EXPECT_EQ(material(0).opacity, 0.25f);
    EXPECT_EQ(material(1).base_color, glm::vec3(0, 1, 0));
    EXPECT_EQ(material(1).opacity, 0.5f);
    EXPECT_EQ(material(2).base_color, glm::vec3(1, 1, 1));
    EXPECT_EQ(material(2).opacity, 1.0f) << "0 means that it is not used";
    EXPECT_EQ(material(3).name, "undefined");
    // A file that is missing, is no file, or would block.
    for (const char* name : {"missing.mtl", "/", ".", "/dev/zero"}) {
        const std::string text = "mtllib " + std::string(name) + "\n" + faces;
        EXPECT_EQ(loaded(load_one(folder.write("c.obj", text))).objects.size(), 4u);
    }
}

TEST(ObjReader, TheMaterialFileOfTheSameNameStandsIn) {
    const TemporaryFolder folder;
    (void)folder.write("a.mtl", "newmtl m\nKd 0 0 1\n");
    const Scene scene = loaded(
        load_one(folder.write("a.obj", "mtllib lost.mtl\n" + kSquare + "usemtl m\nf 1 2 3\n")));
    EXPECT_EQ(scene.materials[scene.objects[0].material].base_color, glm::vec3(0, 0, 1));
}

TEST(ObjReader, ErrorsNameTheLine) {
    const std::string way_out = "; repair the line or export the file again";
    EXPECT_EQ(error_of(kSquare + "f 1 2 99\n"),
              "input.obj:5: face refers to vertex 99, but there are 4" + way_out);
    EXPECT_EQ(error_of(kSquare + "f 1 2 -5\n"),
              "input.obj:5: face refers to vertex -5, but there are 4 before it" + way_out);
    EXPECT_EQ(error_of(kSquare + "f 1 2 0\n"),
              "input.obj:5: face refers to vertex 0, but they are counted from 1" + way_out);
    EXPECT_EQ(error_of(kSquare + "f 1 2 123456789123456789123456789\n"),
              "input.obj:5: face refers to vertex 123456789123456789, but there are 4" + way_out);
    EXPECT_EQ(error_of(kSquare + "f 1 2 4294967297\n"),
              "input.obj:5: face refers to vertex 4294967297, but there are 4" + way_out);
    EXPECT_EQ(error_of(kSquare + "\r\n\r\nf 1 2 5\n"),
              "input.obj:7: face refers to vertex 5, but there are 4" + way_out);
    EXPECT_EQ(error_of(kSquare + "f 1 2 3x\n"),
              "input.obj:5: '3x' is not a corner of a face" + way_out);
    EXPECT_EQ(error_of("v 0 0\n"),
              "input.obj:1: a vertex of 2 numbers, where 3 are needed" + way_out);
    EXPECT_EQ(error_of("vn 0 0\n"),
              "input.obj:1: a normal of 2 numbers, where 3 are needed" + way_out);
    EXPECT_EQ(error_of(kSquare + "v 0 zero 1\n"), "input.obj:5: 'zero' is not a number" + way_out);
}

/// A grid of n x n squares, of lines in the order v, f, v, f, ... as far as indices allow.
std::string grid(int n, bool from_the_end) {
    std::string text;
    for (int y = 0; y <= n; ++y) {
        for (int x = 0; x <= n; ++x) {
            text += "v " + std::to_string(x) + ".125 " + std::to_string(y) + ".0625 0\n";
            if (x == 0 || y == 0) continue;
            const int last = y * (n + 1) + x + 1, origin = from_the_end ? last + 1 : 0;
            text += "f";
            for (const int v : {last - n - 2, last - n - 1, last, last - 1}) {
                text += " " + std::to_string(v - origin);
            }
            text += "\n";
        }
    }
    return text;
}

TEST(ObjReader, PiecesOfLargeFilesFitTogether) {
    constexpr int kSide = 150;
    const Scene absolute = loaded(load_text(grid(kSide, false), "obj"));
    const Scene relative = loaded(load_text(grid(kSide, true), "obj"));
    ASSERT_GT(grid(kSide, false).size(), 3u << 18) << "must be several pieces";
    ASSERT_EQ(absolute.triangle_count(), 2u * kSide * kSide);
    EXPECT_EQ(absolute.positions, relative.positions);
    EXPECT_EQ(absolute.triangles, relative.triangles);
    for (std::uint32_t t = 0; t < absolute.triangle_count(); t += 2) {
        const auto square = static_cast<int>(t / 2);
        ASSERT_EQ(corner(absolute, t, 0),
                  glm::dvec3(square % kSide + 0.125, square / kSide + 0.0625, 0));
    }
    EXPECT_NE(error_of(grid(kSide, false) + "f 1 2 99999\n").find(":45302: "), std::string::npos);
}

TEST(ObjReader, FilesOfNothingButContinuedLines) {
    std::string text = kSquare + "f 1 2";
    for (int i = 0; i < 200000; ++i) text += " \\\n";
    EXPECT_EQ(loaded(load_text(text + "3\n", "obj")).triangle_count(), 1u);
}

TEST(ObjReader, MemoryAndTimeAreLimited) {
    const load::ReadContext little("a.obj", "", 100, 1000);
    const std::string groups = grid(10, false);
    const auto refused = load::read_own_format("obj", groups, little);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().message,
              "a.obj: reading it takes more than 0 MiB of memory; use a smaller or repaired file");
}

TEST(ObjReader, NormalsThatAreNotThereAreDropped) {
    const std::string normals = "vn 0 0 1\nvn 0 1 0\n";
    for (const char* wrong : {"3", "0", "-3", "-2000", "2147483648", "-2147483648", "4294967295"}) {
        const std::string corner = "1//" + std::string(wrong);
        const Scene scene = loaded(load_text(
            kSquare + normals + "f " + corner + " 2//1 3//2\nf 1//1 3//2 4//-1\n", "obj"));
        ASSERT_EQ(scene.triangle_count(), 2u) << wrong;
        EXPECT_EQ(scene.triangle_normals[0], Corners(kNone)) << wrong;
        EXPECT_EQ(scene.normals[scene.triangle_normals[1].x], glm::vec3(0, 0, 1)) << wrong;
        ASSERT_EQ(scene.notes.size(), 1u) << wrong;
        EXPECT_NE(
            scene.notes[0].find("normals that are not in the file; their corners have none: 1"),
            std::string::npos)
            << scene.notes[0];
    }
    const Scene none = loaded(load_text(kSquare + "f 1//1 2//2 3//3\n", "obj"));
    EXPECT_FALSE(none.objects[0].has_file_normals);
    EXPECT_EQ(none.notes.size(), 1u);
}

}  // namespace
}  // namespace sightline
