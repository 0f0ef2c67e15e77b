// The worked examples of the lecture notes on back faces and depth buffers, with their numbers.
#include <gtest/gtest.h>

#include <array>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <vector>

#include "math/newell.hpp"
#include "math/predicates.hpp"
#include "support/scenes.hpp"
#include "view/facing.hpp"

namespace sightline {
namespace {

using namespace testing;

// The unit cube: A B C D at z = 0, E F G H above them at z = 1.
const glm::dvec3 kA{0, 0, 0}, kB{1, 0, 0}, kC{1, 1, 0}, kD{0, 1, 0}, kE{0, 0, 1}, kF{1, 0, 1},
    kG{1, 1, 1}, kH{0, 1, 1};

struct Face {
    std::string name;
    std::array<glm::dvec3, 4> corners;  // counter-clockwise from outside
};

const std::array<Face, 6> kFaces{{{"ABCD", {kA, kD, kC, kB}},
                                  {"EFGH", {kE, kF, kG, kH}},
                                  {"ABFE", {kA, kB, kF, kE}},
                                  {"DCGH", {kD, kH, kG, kC}},
                                  {"AEHD", {kA, kE, kH, kD}},
                                  {"BFGC", {kB, kC, kG, kF}}}};

glm::dvec3 unit_normal(const Face& face) {
    return glm::normalize(math::newell_normal(face.corners));
}

std::vector<double> products(const glm::dvec3& v) {
    std::vector<double> out;
    for (const Face& face : kFaces) out.push_back(glm::dot(v, unit_normal(face)));
    return out;
}

// Names of the faces that a camera at `eye` sees, by the plane test of the library.
std::string seen_from(const glm::dvec3& eye) {
    CameraOptions options;
    options.eye = eye;
    options.target = glm::dvec3{0, 0, 0};
    const Camera camera = must(make_camera(options, Box{kA, kG}, {200, 200}));
    std::string seen;
    for (const Face& face : kFaces) {
        const std::array<glm::dvec3, 3> corners{face.corners[0], face.corners[1], face.corners[2]};
        if (facing(camera, corners) == Facing::front) seen += face.name + ' ';
    }
    return seen;
}

TEST(NotesBackFaces, CubeSeenFrom5Minus1_5) {
    EXPECT_EQ(products(glm::dvec3{0, 0, 0} - glm::dvec3{5, -1, 5}),
              (std::vector<double>{5, -5, -1, 1, 5, -5}));
    // The notes use one V for all faces; the true V of perspective sees the same ones here.
    EXPECT_EQ(seen_from({5, -1, 5}), "EFGH ABFE BFGC ");
}

TEST(NotesBackFaces, CubeSeenFrom20_40_20) {
    EXPECT_EQ(products(glm::dvec3{0, 0, 0} - glm::dvec3{20, 40, 20}),
              (std::vector<double>{20, -20, 40, -40, 20, -20}));
    EXPECT_EQ(seen_from({20, 40, 20}), "EFGH DCGH BFGC ");
}

TEST(NotesBackFaces, NormalByNewellsMethod) {
    const std::array<glm::dvec3, 3> triangle{{{1, 2, 4}, {2, 1, 4}, {3, 3, 4}}};
    const glm::dvec3 n = math::newell_normal(triangle);
    EXPECT_EQ(n, glm::dvec3(0, 0, 3));
    // By the rule N . V >= 0 of the notes it is hidden for V = (0, 0, 1), whatever one text says.
    EXPECT_GE(glm::dot(n, glm::dvec3(0, 0, 1)), 0);
    EXPECT_LT(glm::dot(n, glm::dvec3(0, 0, -1)), 0);
    // The library looks along V.
    for (const double z : {1.0, -1.0}) {
        CameraOptions options;
        options.direction = glm::dvec3{0, 0, z};
        options.projection = Projection::orthographic;
        const Camera camera = must(make_camera(options, Box{{1, 1, 4}, {3, 3, 4}}, {64, 64}));
        EXPECT_EQ(facing(camera, triangle), z > 0 ? Facing::back : Facing::front);
    }
}

TEST(NotesBackFaces, PlaneSeenFrom111) {
    const glm::dvec3 normal{3, -2, 6}, eye{1, 1, 1}, at{0, 0, 0};
    EXPECT_EQ(glm::dot(normal, eye) - 5, 2);    // the eye lies on the outer side
    EXPECT_EQ(glm::dot(normal, at - eye), -7);  // N . V: the front is seen
    // A triangle of that plane, counter-clockwise around the normal.
    const std::array<glm::dvec3, 3> triangle{{{1, -1, 0}, {5.0 / 3, 0, 0}, {1, 2, 1}}};
    for (const glm::dvec3& p : triangle) EXPECT_NEAR(glm::dot(normal, p), 5, 1e-12);
    ASSERT_GT(glm::dot(math::newell_normal(triangle), normal), 0);
    CameraOptions options;
    options.eye = eye;
    options.target = at;
    EXPECT_EQ(facing(must(make_camera(options, Box{{-1, -1, -1}, {2, 2, 2}}, {64, 64})), triangle),
              Facing::front);
}

// Plane test, sign of C and winding on the screen agree.
TEST(BackFaces, ThreeTestsAgree) {
    Random random(11);
    int fronts = 0;
    for (int i = 0; i < 20000; ++i) {
        CameraOptions options;
        options.direction = random.point() + glm::dvec3{0.01, 0, 0};
        options.up = glm::cross(*options.direction, glm::dvec3{0.3, 0.4, -0.6});
        options.projection = i % 2 == 0 ? Projection::perspective : Projection::orthographic;
        const Camera camera = must(make_camera(options, Box{{-1, -1, -1}, {1, 1, 1}}, {100, 100}));
        const std::array<glm::dvec3, 3> triangle{random.point(), random.point(), random.point()};
        const Facing side = facing(camera, triangle);
        EXPECT_EQ(side, facing_by_winding(camera, triangle)) << i;
        if (!camera.is_perspective()) {
            EXPECT_EQ(side, facing_by_c(camera, triangle)) << i;
        }
        fronts += side == Facing::front;
    }
    EXPECT_NEAR(fronts, 10000, 500);
}

// -- the 2 x 2 exercise ---------------------------------------------------------------------------

struct Buffers {
    std::array<double, 4> intensity{0, 0, 0, 0};
    std::array<std::int32_t, 4> z{1023, 1023, 1023, 1023};
};

struct Offer {
    std::int32_t z;
    double intensity;
};

// A z-buffer in its smallest form, with the library's comparison of planes parallel to the screen.
void offer(Buffers& buffers, const std::array<Offer, 4>& polygon) {
    for (std::size_t i = 0; i < 4; ++i) {
        const Plane fresh{0, 0, 1, {0, 0, polygon[i].z}}, held{0, 0, 1, {0, 0, buffers.z[i]}};
        if (compare_depth(fresh, held, 0, 0).sign >= 0) continue;  // equal depth does not pass
        buffers.z[i] = polygon[i].z;
        buffers.intensity[i] = polygon[i].intensity;
    }
}

const std::array<Offer, 4> kP1{{{512, .4}, {128, .3}, {1023, .7}, {412, .5}}};
const std::array<Offer, 4> kP2{{{612, .8}, {72, .6}, {300, .5}, {418, .2}}};

TEST(NotesZBuffer, TwoByTwoExercise) {
    Buffers b;
    offer(b, kP1);
    EXPECT_EQ(b.intensity, (std::array<double, 4>{.4, .3, 0, .5}));
    EXPECT_EQ(b.z, (std::array<std::int32_t, 4>{512, 128, 1023, 412}));
    offer(b, kP2);
    EXPECT_EQ(b.intensity, (std::array<double, 4>{.4, .6, .5, .5}));
    EXPECT_EQ(b.z, (std::array<std::int32_t, 4>{512, 72, 300, 412}));
}

// The same exercise through the engine: each pixel of each polygon is a small face around the
// pixel's centre, at the exercise's depth.
TEST(NotesZBuffer, TwoByTwoExerciseThroughTheEngine) {
    SceneBuilder builder;
    std::vector<double> intensity;
    for (const auto& polygon : {kP1, kP2})
        for (std::size_t i = 0; i < 4; ++i) {
            const double x = 0.5 + static_cast<double>(i % 2), y = 1.5 - static_cast<double>(i / 2);
            const double z = -polygon[i].z;
            builder.triangle({x - .4, y - .3, z}, {x + .4, y - .3, z}, {x, y + .4, z});
            intensity.push_back(polygon[i].intensity);
        }
    const Scene scene = builder.build();
    CameraOptions options;
    options.projection = Projection::orthographic;
    options.eye = glm::dvec3{1, 1, 0};
    options.direction = glm::dvec3{0, 0, -1};
    options.ortho_height = 2;
    options.near_plane = 0;
    // Short of 1023, the value of an empty buffer, so that a face at that depth does not pass.
    options.far_plane = 1022.5;
    const Camera camera = must(make_camera(options, scene.bounds, {2, 2}));
    const ScreenScene screen = must(project(scene, camera, {Cull::none, 1}));
    for (const char* algorithm : {"zbuffer", "brute"}) {
        const Visibility seen = run(algorithm, screen);
        const std::array<double, 4> z{512, 72, 300, 412}, shown{.4, .6, .5, .5};
        for (std::size_t i = 0; i < 4; ++i) {
            ASSERT_NE(seen.ids[i], kNone);
            EXPECT_NEAR(screen.metric_depth(seen.depth[i]), z[i], 1e-3);
            EXPECT_EQ(intensity[seen.ids[i]], shown[i]);
        }
    }
}

// A buffer that starts at 0 and keeps the greater z (viewer on the positive side) shows the same.
TEST(NotesZBuffer, GreaterIsNearerGivesTheSamePicture) {
    std::array<double, 4> smaller_kept{}, greater_kept{};
    std::array<std::int32_t, 4> least{1023, 1023, 1023, 1023}, most{0, 0, 0, 0};
    for (const auto& polygon : {kP1, kP2})
        for (std::size_t i = 0; i < 4; ++i) {
            if (polygon[i].z < least[i]) {
                least[i] = polygon[i].z;
                smaller_kept[i] = polygon[i].intensity;
            }
            const std::int32_t towards_viewer = 1023 - polygon[i].z;
            if (towards_viewer > most[i]) {
                most[i] = towards_viewer;
                greater_kept[i] = polygon[i].intensity;
            }
        }
    EXPECT_EQ(smaller_kept, greater_kept);
    Buffers b;
    offer(b, kP1);
    offer(b, kP2);
    EXPECT_EQ(b.intensity, greater_kept);
}

}  // namespace
}  // namespace sightline
