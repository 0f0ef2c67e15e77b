// Joining of positions that differ in their last bits.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "scene/meshes.hpp"
#include "scene/tolerance.hpp"
#include "support/mesh_variants.hpp"

namespace sightline {
namespace {

using scene_test::load_text;
using scene_test::loaded;
using scene_test::make_one_object;
using testing::Random;

/// Ascii STL of a cube of 10 whose corners are off by up to `noise`.
std::string stl_cube(double noise, Random& random) {
    std::string text = "solid cube\n";
    for (const testing::PlainFace& face : testing::box_solid({0, 0, 0}, {10, 10, 10})) {
        for (std::size_t k = 1; k < 3; ++k) {
            text += "facet normal 0 0 0\nouter loop\n";
            for (const std::size_t corner : {std::size_t{0}, k, k + 1}) {
                const glm::dvec3 p = face.corners[corner] + random.point(noise);
                char line[120];
                std::snprintf(line, sizeof line, "vertex %.9g %.9g %.9g\n", p.x, p.y, p.z);
                text += line;
            }
            text += "endloop\nendfacet\n";
        }
    }
    return text + "endsolid cube\n";
}

TEST(Weld, ClosesASoupOfNoisyCorners) {
    Random random(1);
    for (int round = 0; round < 20; ++round) {
        const Scene scene = loaded(load_text(stl_cube(1e-6, random), "stl"));
        EXPECT_TRUE(scene.objects[0].closed);
        EXPECT_EQ(scene.triangle_count(), 12u);
        EXPECT_EQ(scene.positions.size() - scene.counts.joined_positions, 8u);
    }
    const Scene scene = loaded(load_text(stl_cube(1e-3, random), "stl"));
    EXPECT_FALSE(scene.objects[0].closed) << "that is no rounding";
    EXPECT_EQ(scene.counts.joined_positions, 0u);
}

TEST(Weld, CanBeTurnedOffAndUp) {
    Random random(2);
    const std::string fine = stl_cube(1e-6, random), coarse = stl_cube(1e-3, random);
    LoadOptions options;
    options.format = "stl";
    const auto closed = [&](const std::string& text) {
        return loaded(load_scene_from_memory(std::as_bytes(std::span(text)), "cube.stl", options))
            .objects[0]
            .closed;
    };
    options.weld = 0;
    EXPECT_FALSE(closed(fine));
    options.weld = 1e-3;
    EXPECT_TRUE(closed(coarse));
}

/// A torus as programs print it, seams not closed: sines of whole turns are not 0.
std::string printed_torus(const char* format, bool off) {
    const unsigned around = 24, across = 16;
    const double turn = 2 * 3.14159265358979;
    std::string vertices, faces;
    for (unsigned a = 0; a <= around; ++a)
        for (unsigned c = 0; c <= across; ++c) {
            const double u = turn * a / around, v = turn * c / across;
            char line[120];
            std::snprintf(line, sizeof line, format, (3 + std::cos(v)) * std::cos(u),
                          (3 + std::cos(v)) * std::sin(u), std::sin(v));
            vertices += (off ? "" : "v ") + std::string(line);
        }
    for (unsigned a = 0; a < around; ++a)
        for (unsigned c = 0; c < across; ++c) {
            const unsigned row = across + 1, i = a * row + c;
            const unsigned first = off ? 0 : 1;
            faces += (off ? "4 " : "f ") + std::to_string(i + first) + ' ' +
                     std::to_string(i + row + first) + ' ' + std::to_string(i + row + 1 + first) +
                     ' ' + std::to_string(i + 1 + first) + '\n';
        }
    return off ? "OFF\n" + std::to_string((around + 1) * (across + 1)) + ' ' +
                     std::to_string(around * across) + " 0\n" + vertices + faces
               : vertices + faces;
}

TEST(Weld, ClosesTheSeamsOfGeneratedSurfaces) {
    for (const char* format : {"%.7g %.7g %.7g\n", "%.9g %.9g %.9g\n", "%.17g %.17g %.17g\n"}) {
        for (const bool off : {false, true}) {
            const Scene scene = loaded(load_text(printed_torus(format, off), off ? "off" : "obj"));
            ASSERT_EQ(scene.objects.size(), 1u);
            EXPECT_TRUE(scene.objects[0].closed) << format << off;
            EXPECT_EQ(scene.triangle_count(), 2u * 24 * 16);
        }
    }
}

/// Three corners of each triangle are its own.
Scene unshared(const Scene& scene) {
    Scene apart = scene;
    apart.positions.clear();
    for (Corners& c : apart.triangles)
        for (int k = 0; k < 3; ++k) {
            apart.positions.push_back(scene.positions[c[k]]);
            c[k] = static_cast<std::uint32_t>(apart.positions.size() - 1);
        }
    return apart;
}

TEST(Weld, ArraysAreJoinedToTheLowestIndex) {
    Scene scene = unshared(scene_test::cube_scene());
    finish_scene(scene);
    EXPECT_TRUE(scene.objects[0].closed);
    EXPECT_EQ(scene.positions.size(), 36u) << "no position is lost";
    for (const Corners& c : scene.triangles)
        for (int k = 0; k < 3; ++k)
            for (std::uint32_t i = 0; i < c[k]; ++i)
                EXPECT_NE(scene.positions[i], scene.positions[c[k]]);
}

TEST(Weld, NeverJoinsAcrossObjects) {
    Scene scene;
    scene_test::append_cube(scene, {0, 0, 0});
    scene_test::append_cube(scene, {1e-7, 0, 0});
    make_one_object(scene);
    scene.triangles.erase(scene.triangles.begin() + 12);  // both are open
    scene.triangles.erase(scene.triangles.begin());
    make_one_object(scene);
    Scene one = scene;
    finish_scene(one);
    EXPECT_GT(one.counts.joined_positions, 0u);
    Object second = scene.objects[0];
    scene.objects[0].triangle_count = scene.objects[0].polygon_count = 11;
    second.first_triangle = second.first_polygon = 11;
    second.triangle_count = second.polygon_count = 11;
    scene.objects.push_back(second);
    const auto before = scene.triangles;
    finish_scene(scene);
    EXPECT_EQ(scene.counts.joined_positions, 0u);
    EXPECT_EQ(scene.triangles, before);
}

TEST(Weld, LeavesClosedShapesAloneHoweverThin) {
    Random random(3);
    for (const double thickness : {1e-6, 1e-9, 1e-12}) {
        Scene scene = testing::scene_of(testing::box_solid({0, 0, 0}, {1, 1, thickness}));
        finish_scene(scene);
        EXPECT_TRUE(scene.objects[0].closed);
        EXPECT_EQ(scene.counts.joined_positions, 0u);
        EXPECT_EQ(scene.counts.degenerate_triangles, 0u);
    }
}

TEST(Weld, KeepsTheShapeOfSmallOpenings) {
    // A tube without lids whose openings are smaller than the tolerance.
    testing::Solid tube = testing::star_solid(6, 1, 1);
    std::erase_if(tube, [](const testing::PlainFace& face) { return face.corners.size() == 3; });
    for (testing::PlainFace& face : tube)
        for (glm::dvec3& p : face.corners) p = {2e-7 * p.x, 2e-7 * p.y, p.z};
    Scene scene = testing::scene_of(tube);
    finish_scene(scene);
    EXPECT_EQ(scene.counts.joined_positions, 0u);
    // A thin box without one of its small sides.
    testing::Solid box = testing::box_solid({0, 0, 0}, {1, 1, 1e-8});
    box.pop_back();
    scene = testing::scene_of(box);
    finish_scene(scene);
    EXPECT_EQ(scene.counts.joined_positions, 0u);
    EXPECT_EQ(scene.counts.degenerate_triangles, 0u);
    EXPECT_FALSE(scene.objects[0].closed);
}

// One corner far away makes the tolerance as large as the rest of the object.
TEST(Weld, SmallPartsOfALargeObjectKeepTheirShape) {
    testing::SceneBuilder b;
    b.triangle({-1e6, 0, 0}, {1e6, 0, 0}, {0, 1e6, 0});
    for (int x = 0; x < 30; ++x)
        for (int y = 0; y < 30; ++y) {
            const glm::dvec3 p(0.12 * x, 0.12 * y, 1);
            b.quad(p, p + glm::dvec3(0.1, 0, 0), p + glm::dvec3(0.1, 0.1, 0),
                   p + glm::dvec3(0, 0.1, 0));
        }
    EXPECT_EQ(b.build().counts.joined_positions, 0u);
}

/// Random triangles with corners in bunches.
Scene bunches(Random& random) {
    testing::SceneBuilder b;
    std::vector<glm::dvec3> hubs;
    for (int k = 0; k < 12; ++k) hubs.push_back(random.point());
    const auto corner = [&] {
        const double reach = std::pow(10.0, random.uniform(-9, -5));
        return hubs[random.below(12)] + random.point(reach);
    };
    for (int k = 0; k < 40; ++k) {
        const glm::dvec3 p = corner(), q = corner(), r = corner();
        b.triangle(p, q, r);
    }
    return b.scene;
}

TEST(Weld, KeepsItsPromises) {
    Random random(5);
    std::uint64_t joined = 0;
    for (int round = 0; round < 300; ++round) {
        const Scene before = bunches(random);
        Scene scene = before;
        finish_scene(scene);
        joined += scene.counts.joined_positions;
        ASSERT_EQ(scene.positions, before.positions);
        const double tolerance =
            rounding_of(before.bounds.empty() ? scene.bounds : before.bounds, 0);
        for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
            const Corners &c = scene.triangles[t], &was = before.triangles[t];
            EXPECT_TRUE(c.x != c.y && c.y != c.z && c.z != c.x);
            for (int k = 0; k < 3; ++k) {
                EXPECT_LE(c[k], was[k]);
                EXPECT_LE(glm::distance(scene.positions[c[k]], scene.positions[was[k]]),
                          tolerance * (1 + 1e-5));
            }
        }
    }
    EXPECT_GT(joined, 1000u);
}

TEST(Weld, DoesNotDependOnTheNumberOfThreads) {
    Random random(6);
    const testing::Solid torus = testing::torus_solid(2, 0.7, 40, 30);
    const Scene rough =
        testing::scene_of(testing::varied(torus, testing::Variant::perturbed, random));
    Scene many = rough;
    finish_scene(many);
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    Scene one = rough;
    finish_scene(one);
    EXPECT_EQ(one.triangles, many.triangles);
    EXPECT_EQ(one.sheets.of_triangle, many.sheets.of_triangle);
    EXPECT_TRUE(one.objects[0].closed);
}

}  // namespace
}  // namespace sightline
