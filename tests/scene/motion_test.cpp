// Objects that move: their poses, what a mirror does, and the box of all frames.
#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "scene/meshes.hpp"
#include "sightline/camera.hpp"
#include "sightline/load.hpp"
#include "support/files.hpp"

namespace sightline {
namespace {

using scene_test::load_one;
using scene_test::loaded;
using scene_test::message_of;
using testing::TemporaryFolder;

const std::string kCube =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

class Motions : public ::testing::Test {
protected:
    void SetUp() override { testing::write_file(files_.file("cube.obj"), kCube); }

    [[nodiscard]] Result<Scene> load(const std::string& text) const {
        return load_one(files_.write("scene.json", text));
    }
    /// Two cubes, the second of which moves.
    [[nodiscard]] Scene two(const std::string& frames) const {
        return loaded(load(R"({"models": [{"path": "cube.obj"}, {"path": "cube.obj",
            "transform": [{"translate": [3, 0, 0]}], "frames": )" +
                           frames + "}]}"));
    }
    /// The same scene with another transform in the place of the frames.
    [[nodiscard]] Scene placed(const std::string& operations) const {
        return loaded(load(R"({"models": [{"path": "cube.obj"}, {"path": "cube.obj",
            "transform": [{"translate": [3, 0, 0]}, )" +
                           operations + "]}]}"));
    }

    const TemporaryFolder files_;
};

void expect_equal(const Scene& a, const Scene& b) {
    EXPECT_EQ(a.positions, b.positions);
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_EQ(a.polygon_edges, b.polygon_edges);
    EXPECT_EQ(a.triangle_polygon, b.triangle_polygon);
    EXPECT_EQ(a.bounds, b.bounds);
    EXPECT_EQ(a.sheets.of_triangle, b.sheets.of_triangle);
    ASSERT_EQ(a.objects.size(), b.objects.size());
    for (std::size_t i = 0; i < a.objects.size(); ++i) {
        EXPECT_EQ(a.objects[i].closed, b.objects[i].closed) << i;
    }
}

TEST_F(Motions, APoseIsWhatATransformWouldMake) {
    const Scene scene = two(R"([[{"translate": [0, 2, 0]}], [{"translate": [-3, 0, 0]},
        {"scale": 2}]])");
    ASSERT_EQ(scene.motions.size(), 1u);
    EXPECT_EQ(scene.motions[0].first_object, 1u);
    EXPECT_EQ(scene.motions[0].object_count, 1u);
    EXPECT_EQ(scene.bounds, (Box{{0, 0, 0}, {4, 1, 1}}));  // at rest
    expect_equal(posed(scene, 0), placed(R"({"translate": [0, 2, 0]})"));
    expect_equal(posed(scene, 1), placed(R"({"translate": [-3, 0, 0]}, {"scale": 2})"));
    expect_equal(posed(scene, 7), posed(scene, 1));
    EXPECT_TRUE(posed(scene, 0).motions.empty());
}

TEST_F(Motions, AMirrorKeepsFrontsInFront) {
    const Scene scene = two(R"([[{"scale": [1, 1, -1]}]])");
    const Scene mirrored = posed(scene, 0), same = placed(R"({"scale": [1, 1, -1]})");
    EXPECT_TRUE(mirrored.objects[1].closed);
    ASSERT_EQ(mirrored.triangle_count(), same.triangle_count());
    for (std::uint32_t t = 12; t < 24; ++t) {
        const auto normal = [&](const Scene& s) {
            const Corners c = s.triangles[t];
            return glm::cross(s.positions[c.y] - s.positions[c.x],
                              s.positions[c.z] - s.positions[c.x]);
        };
        EXPECT_EQ(normal(mirrored), normal(same)) << t;
        for (int k = 0; k < 3; ++k) {
            // An edge of the polygon is one that runs along an axis.
            const Corners c = mirrored.triangles[t];
            const glm::dvec3 side = mirrored.positions[c[(k + 1) % 3]] - mirrored.positions[c[k]];
            EXPECT_EQ(mirrored.polygon_edges[t] >> k & 1, glm::length(side) == 1 ? 1 : 0);
        }
    }
}

TEST_F(Motions, NormalsTurnAlong) {
    Scene scene = two(R"([[{"rotate": {"axis": [0, 1, 0], "degrees": 90}}],
        [{"scale": [1, 4, 1]}], [{"scale": [1, 1, -1]}]])");
    make_normals(scene, 30);
    for (std::uint32_t frame = 0; frame < 3; ++frame) {
        const Scene pose = posed(scene, frame);
        for (std::uint32_t t = 0; t < pose.triangle_count(); ++t) {
            const Corners c = pose.triangles[t];
            const glm::dvec3 own =
                glm::normalize(glm::cross(pose.positions[c.y] - pose.positions[c.x],
                                          pose.positions[c.z] - pose.positions[c.x]));
            for (int k = 0; k < 3; ++k) {
                const glm::vec3 n = pose.normals[pose.triangle_normals[t][k]];
                EXPECT_NEAR(glm::length(glm::dvec3(n) - own), 0, 1e-6) << frame << " " << t;
            }
        }
    }
}

TEST_F(Motions, TheBoxOfAllFrames) {
    const Scene scene = two(R"([[{"translate": [0, 2, 0]}], [{"translate": [0, -5, 0]}],
        [{"translate": [2, 0, 0]}]])");
    EXPECT_EQ(scene.reach, (Box{{0, -5, 0}, {6, 3, 1}}));
    EXPECT_EQ(posed(scene, 1).reach, scene.reach);
    EXPECT_EQ(posed(scene, 1).bounds, (Box{{0, -5, 0}, {4, 1, 1}}));
    const Scene still = placed(R"({"scale": 1})");
    EXPECT_EQ(still.reach, still.bounds);
    EXPECT_TRUE(moving_triangles(still).empty());
    const auto moving = moving_triangles(scene);
    ASSERT_EQ(moving.size(), 24u);
    for (std::size_t t = 0; t < 24; ++t) EXPECT_EQ(moving[t] != 0, t >= 12) << t;
}

TEST_F(Motions, QuadricsMove) {
    const Scene scene = loaded(load(R"({"models": [{"path": "cube.obj"}], "surfaces": [
        {"sphere": {"centre": [5, 0, 0], "radius": 1}, "frames": [[], [{"translate": [0, 3, 0]}]]},
        {"sphere": {"centre": [-5, 0, 0], "radius": 1}}]})"));
    EXPECT_EQ(scene.reach, (Box{{-6, -1, -1}, {6, 4, 1}}));
    const Scene pose = posed(scene, 1);
    EXPECT_EQ(bounds_of(pose.quadrics[0]), (Box{{4, 2, -1}, {6, 4, 1}}));
    EXPECT_EQ(bounds_of(pose.quadrics[1]), bounds_of(scene.quadrics[1]));
    // Tessellated ones are objects with the same numbers, so they move as well.
    const Scene mesh = posed(tessellate_quadrics(scene), 1);
    EXPECT_NEAR(mesh.bounds.hi.y, 4, 1e-9);
    EXPECT_NEAR(mesh.bounds.lo.x, -6, 1e-9);
}

TEST_F(Motions, ErrorsNameTheFrame) {
    const auto error = [&](const std::string& frames) {
        return message_of(load(R"({"models": [{"path": "cube.obj", "frames": )" + frames + "}]}"));
    };
    EXPECT_NE(error("[]").find("models[0].frames: expected at least one frame"), std::string::npos);
    EXPECT_NE(error("[{}]").find("models[0].frames[0]: expected a list"), std::string::npos);
    EXPECT_NE(error(R"([[], [{"scale": 0}]])").find("models[0].frames[1][0].scale"),
              std::string::npos);
    EXPECT_NE(error(R"([[{"scale": 1e200}, {"scale": 1e200}]])").find("models[0].frames[0]: "),
              std::string::npos);
    EXPECT_NE(error(R"([[{"scale": 1e20}, {"translate": [1e30, 0, 0]}]])").find("1e30"),
              std::string::npos);
    EXPECT_NE(message_of(load(R"({"surfaces": [{"sphere": {"centre": [0, 0, 0], "radius": 1},
                                  "frames": [[], [{"matrix": [1,0,0,0, 0,1,0,0, 0,0,0,0, 0,0,0,1]}]]}]})"))
                  .find("surfaces[0].frames[1]: it is flat"),
              std::string::npos);
}

TEST(Orbit, TurnsTheWholeCamera) {
    const Box box{{-1, -1, -1}, {1, 1, 1}};
    CameraOptions options;
    options.eye = {3, 2, 5};
    options.target = {1, 0, 0};
    options.projection = Projection::orthographic;
    const auto start = make_camera(options, box, {});
    ASSERT_TRUE(start.ok());
    const CameraOptions none = orbited(options, *start, {0, 7, 0}, 360);
    EXPECT_EQ(*none.eye, start->eye);
    EXPECT_EQ(*none.up, start->up);
    const auto quarter = make_camera(orbited(options, *start, {0, 1, 0}, 90), box, {});
    ASSERT_TRUE(quarter.ok());
    EXPECT_EQ(quarter->eye, (glm::dvec3{6, 2, -2}));
    EXPECT_EQ(quarter->target, (glm::dvec3{1, 0, 0}));
    EXPECT_EQ(quarter->view_height, start->view_height);
    // The picture of the turned scene is that of the scene before.
    const glm::dvec3 p{0.3, 0.4, 0.5}, from = p - start->target;
    const glm::dvec3 turned = start->target + glm::dvec3{from.z, from.y, -from.x};
    EXPECT_NEAR(glm::length(quarter->pixel_of(turned) - start->pixel_of(p)), 0, 1e-9);
}

}  // namespace
}  // namespace sightline
