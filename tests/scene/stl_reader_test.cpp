// The reader of STL files.
#include <gtest/gtest.h>

#include "scene/meshes.hpp"

namespace sightline {
namespace {

using scene_test::load_text;
using scene_test::loaded;
using scene_test::message_of;
using scene_test::raw;

std::string facet(float z, std::uint16_t attribute = 0) {
    return raw(0.f, 0.f, 1.f) + raw(0.f, 0.f, z) + raw(1.f, 0.f, z) + raw(1.f, 1.f, z) +
           raw(attribute);
}

std::string binary(std::string header, std::uint32_t count, const std::string& facets) {
    header.resize(80, ' ');
    return header + raw(count) + facets;
}

const std::string kFacet =
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n";

TEST(StlReader, BinaryFilesMayBeginWithSolid) {
    const std::string two = facet(0) + facet(1);
    for (const char* header : {"", "solid", "solid made by somebody\n facet", "SOLID x"}) {
        const Scene scene = loaded(load_text(binary(header, 2, two), "stl"));
        EXPECT_EQ(scene.triangle_count(), 2u) << header;
        EXPECT_EQ(scene.bounds.hi, glm::dvec3(1, 1, 1));
        EXPECT_EQ(scene.objects[0].name, "input");
        EXPECT_TRUE(scene.objects[0].has_file_normals);
        // Also where something follows that is not counted.
        EXPECT_EQ(loaded(load_text(binary(header, 1, two + "end"), "stl")).triangle_count(), 1u);
    }
}

TEST(StlReader, AttributesAreNoColours) {
    const Scene scene =
        loaded(load_text(binary("COLOR=abcd", 2, facet(0, 0xffff) + facet(1, 0x8000)), "stl"));
    EXPECT_TRUE(scene.triangle_colors.empty());
}

TEST(StlReader, TruncatedBinaryFiles) {
    EXPECT_EQ(
        message_of(load_text(binary("", 3, facet(0) + facet(1) + "x"), "stl")),
        "input.stl: not a readable stl file (it ends after 2 of 3 facets); check or export it "
        "again");
    EXPECT_EQ(
        message_of(load_text("abc", "stl")),
        "input.stl: not a readable stl file (it ends within its header of 84 bytes); check or "
        "export it again");
}

TEST(StlReader, EachSolidIsAnObject) {
    const Scene scene = loaded(load_text("solid part one\n" + kFacet + kFacet +
                                             "endsolid part one\nsolid\nendsolid\n\nSolid two\n" +
                                             kFacet + "endsolid",
                                         "stl"));
    ASSERT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(scene.objects[0].name, "part one");
    EXPECT_EQ(scene.objects[0].triangle_count, 2u);
    EXPECT_EQ(scene.objects[1].name, "two");
    EXPECT_EQ(scene.positions.size(), 6u) << "joined within an object";
}

TEST(StlReader, AsciiFilesAsPeopleWriteThem) {
    const Scene scene = loaded(load_text(
        "  SOLID\r\nFACET NORMAL 0 0 0\r\nOUTER LOOP\r\nVERTEX 0 0 0 vertex 1e0 0 0\r\nVERTEX 1 1 "
        "0\r\nVERTEX 0 1 0\r\nENDLOOP ENDFACET\r\ncolour red\r\nfacet outer loop vertex 0 0 0\n"
        "endloop endfacet",
        "stl"));
    EXPECT_EQ(scene.triangle_count(), 2u);
    EXPECT_EQ(scene.counts.polygons, 1u) << "a loop of four corners is one polygon";
    EXPECT_EQ(scene.counts.ignored_primitives, 1u);
    EXPECT_FALSE(scene.objects[0].has_file_normals) << "a normal of no length is none";
}

TEST(StlReader, DamagedAsciiFiles) {
    const std::string way_out = "; repair the line or export the file again";
    EXPECT_EQ(message_of(load_text("solid\nfacet normal 0 0 1\nvertex 0 0 0\n", "stl")),
              "input.stl:2: a facet that does not end" + way_out);
    EXPECT_EQ(
        message_of(load_text("solid\n" + kFacet + "facet normal 0 0 1\nvertex 0 x 0\n", "stl")),
        "input.stl:9: a facet with a vertex that is not three numbers" + way_out);
    EXPECT_EQ(message_of(load_text("solid\nvertex 0 0 0\n", "stl")),
              "input.stl:2: a vertex outside a facet" + way_out);
    EXPECT_EQ(message_of(load_text("solid\n" + kFacet + "facet\n" + kFacet, "stl")),
              "input.stl:9: a facet that does not end" + way_out);
    EXPECT_EQ(
        message_of(load_text("solid nothing\nendsolid nothing\n", "stl")),
        "input.stl: no triangles in it (0 points and lines, which are not drawn); use a model "
        "with faces");
}

TEST(StlReader, PiecesOfLargeFilesFitTogether) {
    std::string text = "solid large\n";
    constexpr int kCount = 9000;
    for (int i = 0; i < kCount; ++i) {
        const std::string z = std::to_string(i);
        text += "  facet normal 0 0 1\nouter loop\nvertex 0 0 " + z + "\nvertex 1 0 " + z +
                "\nvertex 1 1 " + z + "\nendloop\n endfacet\n";
        if (i == kCount / 2) text += "endsolid\nsolid second\n";
    }
    ASSERT_GT(text.size(), 3u << 18);
    const Scene scene = loaded(load_text(text + "endsolid\n", "stl"));
    ASSERT_EQ(scene.triangle_count(), unsigned{kCount});
    ASSERT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(scene.objects[1].first_triangle, kCount / 2 + 1u);
    for (std::uint32_t t = 0; t < kCount; ++t) {
        ASSERT_EQ(scene.positions[scene.triangles[t].x], glm::dvec3(0, 0, t));
    }
}

TEST(StlReader, CountsThatLie) {
    const std::string two = facet(0) + facet(1);
    for (const std::uint32_t stated : {0u, 1u, 3u, 1000u, 0xffffffffu}) {
        const Scene scene = loaded(load_text(binary("made up", stated, two), "stl"));
        EXPECT_EQ(scene.triangle_count(), 2u) << stated;
        ASSERT_EQ(scene.notes.size(), 1u) << stated;
        EXPECT_EQ(scene.notes[0], "input.stl: its header states " + std::to_string(stated) +
                                      " facets, but there are 2; all that are there are read");
    }
    EXPECT_TRUE(loaded(load_text(binary("", 2, two), "stl")).notes.empty());
    // What is something else is not taken for facets.
    std::string other = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
    while (other.size() < 84 + 100) other += "# a comment line of an obj file\n";
    other.resize(84 + 100, '#');
    EXPECT_NE(message_of(load_text(other, "stl")).find("not a readable stl file"),
              std::string::npos);
}

TEST(StlReader, AByteOrderMarkIsSkipped) {
    EXPECT_EQ(
        loaded(load_text("\xef\xbb\xbfsolid a\n" + kFacet + "endsolid\n", "stl")).triangle_count(),
        1u);
}

/// A facet of this normal in the plane z = 0, facing upwards.
std::string facet_of(const std::string& normal) {
    std::string text = kFacet;
    return text.replace(text.find("0 0 1"), 5, normal);
}

TEST(StlReader, NormalsThatContradictTheFacetAreNotUsed) {
    for (const char* normal : {"0 0 -1", "1 0 0", "0.8 0 0.6"}) {
        const std::string wrong = facet_of(normal);
        const Scene few = loaded(load_text("solid\n" + kFacet + wrong + "endsolid\n", "stl"));
        EXPECT_FALSE(few.objects[0].has_file_normals) << normal;
        ASSERT_EQ(few.notes.size(), 1u);
        EXPECT_EQ(few.notes[0],
                  "input.stl: 1 of 2 facet normals contradict their facets; all are not used");
        std::string many;
        for (int i = 0; i < 150; ++i) many += kFacet;
        const Scene most = loaded(load_text("solid\n" + many + wrong + "endsolid\n", "stl"));
        EXPECT_EQ(most.triangle_normals[150], Corners(kNone));
        EXPECT_EQ(most.normals[most.triangle_normals[149].x], glm::vec3(0, 0, 1));
        EXPECT_EQ(most.notes.size(), 1u);
    }
    const std::string right = facet_of("0.3 0.2 0.9");
    EXPECT_TRUE(loaded(load_text("solid\n" + right + "endsolid\n", "stl")).notes.empty());
    const std::string down =
        raw(0.f, 0.f, -1.f) + raw(0.f, 0.f, 0.f) + raw(1.f, 0.f, 0.f) + raw(1.f, 1.f, 0.f) + "ab";
    const Scene scene = loaded(load_text(binary("", 2, down + facet(1)), "stl"));
    EXPECT_FALSE(scene.objects[0].has_file_normals);
    EXPECT_EQ(scene.notes.size(), 1u);
}

}  // namespace
}  // namespace sightline
