#include "scene/load/soup.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "scene/load/build.hpp"

namespace sightline::load {
namespace {

Soup sample() {
    Soup soup;
    soup.ignored_primitives = 3;
    soup.notes = {"a note", ""};
    Material material;
    material.name = "red";
    material.base_color = {1, 0, 0};
    soup.materials.push_back(material);
    SoupMesh mesh;
    mesh.name = "mesh";
    mesh.material = 0;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.normals.assign(4, {0, 0, 2});
    mesh.colors.assign(4, {1, 1, 1, 1});
    mesh.polygon_sizes = {4, 3};
    mesh.corners = {0, 1, 2, 3, 0, 2, 1};
    soup.meshes.push_back(mesh);
    soup.objects.push_back({"object", 0, glm::dmat4(2.0)});
    soup.objects.back().transform[3][3] = 1;
    return soup;
}

Placement placement() {
    Placement result;
    result.file = "file";
    result.default_name = "unnamed";
    return result;
}

Status build(const Soup& soup, std::size_t memory = std::size_t{1} << 30) {
    return SceneBuilder(memory).append(soup, placement());
}

std::string message(const Status& status) { return status ? "" : status.error().message; }

TEST(Soup, SurvivesTheJourney) {
    const std::optional<Soup> back = deserialise(serialise(sample()));
    ASSERT_TRUE(back.has_value());
    EXPECT_EQ(serialise(*back), serialise(sample()));
    EXPECT_EQ(back->meshes[0].corners, sample().meshes[0].corners);
    EXPECT_EQ(back->objects[0].name, "object");
    EXPECT_EQ(back->materials[0].base_color, glm::vec3(1, 0, 0));
}

TEST(Soup, TruncatedBytesAreNoSoup) {
    const std::vector<std::byte> bytes = serialise(sample());
    for (std::size_t n = 0; n < bytes.size(); ++n) {
        EXPECT_FALSE(deserialise(std::span(bytes).first(n)).has_value()) << n;
    }
    std::vector<std::byte> longer = bytes;
    longer.push_back(std::byte{0});
    EXPECT_FALSE(deserialise(longer).has_value());
}

TEST(Soup, DamagedBytesNeverCrash) {
    std::mt19937 random(3);
    const std::vector<std::byte> good = serialise(sample());
    for (int round = 0; round < 20000; ++round) {
        std::vector<std::byte> bytes = good;
        for (int i = 0; i <= round % 4; ++i) {
            bytes[random() % bytes.size()] = static_cast<std::byte>(random());
        }
        if (const std::optional<Soup> soup = deserialise(bytes)) {
            const Status built = build(*soup);
            EXPECT_TRUE(built.ok() || !built.error().message.empty());
        }
    }
}

TEST(Build, RefusesWhatIsNoCoordinate) {
    Soup soup = sample();
    soup.meshes[0].positions[2].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(message(build(soup)),
              "file: vertex 2 of object 'object' has a coordinate that is not a number (NaN); "
              "repair or rescale the model");
    soup.meshes[0].positions[2].y = -std::numeric_limits<float>::infinity();
    EXPECT_NE(message(build(soup)).find("an infinite coordinate"), std::string::npos);
    soup.meshes[0].positions[2].y = 9e29f;  // the object is twice as large
    EXPECT_NE(message(build(soup)).find("beyond 1e30"), std::string::npos);
    soup.meshes[0].positions[2].y = 4e29f;
    EXPECT_TRUE(build(soup).ok());
}

TEST(Build, RefusesIndicesOutOfRange) {
    Soup soup = sample();
    soup.meshes[0].corners[5] = 4;
    EXPECT_EQ(
        message(build(soup)),
        "file: object 'object' refers to vertex 4, but has only 4; the file is damaged, export "
        "it again");
}

TEST(Build, RefusesMoreThanTheMemoryAllows) {
    // A small mesh at many places.
    Soup soup = sample();
    soup.objects.resize(100000, soup.objects[0]);
    EXPECT_NE(
        message(build(soup, std::size_t{16} << 20)).find("300000 triangles take more than 16"),
        std::string::npos);
    EXPECT_TRUE(build(soup).ok());
}

TEST(Build, RefusesMoreThanTheIdsAllow) {
    Soup soup = sample();
    soup.meshes[0].polygon_sizes.assign(1, 100002);
    soup.meshes[0].corners.assign(100002, 0);
    soup.objects.resize(43000, soup.objects[0]);
    EXPECT_EQ(message(build(soup)), "file: more than 4,294,967,294 triangles; use a simpler model");
}

TEST(Build, BrokenNormalsAreNone) {
    Soup soup = sample();
    soup.meshes[0].normals[3] = {0, 0, 0};
    SceneBuilder builder(std::size_t{1} << 30);
    ASSERT_TRUE(builder.append(soup, placement()).ok());
    const Scene scene = builder.take();
    EXPECT_TRUE(scene.objects[0].has_file_normals);
    ASSERT_EQ(scene.triangle_normals.size(), 3u);
    EXPECT_NE(scene.triangle_normals[0].x, kNone);
    EXPECT_EQ(scene.triangle_normals[1], Corners(kNone));  // has corner 3
    for (const glm::vec3& normal : scene.normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1));
}

TEST(Build, NamesAreCleaned) {
    Soup soup = sample();
    soup.objects[0].name = "a\nb\x80\xc3\xa9";
    SceneBuilder builder(std::size_t{1} << 30);
    ASSERT_TRUE(builder.append(soup, placement()).ok());
    EXPECT_EQ(builder.take().objects[0].name, "a?b?\xc3\xa9");
}

TEST(Build, AMirrorKeepsFrontsInFront) {
    Soup soup = sample();
    soup.meshes[0].polygon_sizes = {4};
    soup.meshes[0].corners = {0, 1, 2, 3};
    soup.objects[0].transform = glm::dmat4(1.0);
    soup.objects[0].transform[0][0] = -2;
    SceneBuilder builder(std::size_t{1} << 30);
    ASSERT_TRUE(builder.append(soup, placement()).ok());
    const Scene scene = builder.take();
    ASSERT_EQ(scene.triangle_count(), 2u);
    for (std::uint32_t t = 0; t < 2; ++t) {
        const Corners& c = scene.triangles[t];
        const auto &a = scene.positions[c.x], &b = scene.positions[c.y], &d = scene.positions[c.z];
        EXPECT_EQ(a, glm::dvec3(0, 0, 0)) << "the first corner stays the first";
        EXPECT_GT((b.x - a.x) * (d.y - a.y) - (b.y - a.y) * (d.x - a.x), 0);
        EXPECT_EQ(scene.normals[scene.triangle_normals[t].x], glm::vec3(0, 0, 1));
    }
    EXPECT_EQ(scene.polygon_edges, (std::vector<std::uint8_t>{0b011, 0b110}));
}

}  // namespace
}  // namespace sightline::load
