// Scenes far from the origin: read as precisely as they are written, and moved to it exactly.
#include "scene/recentre.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>

#include "scene/meshes.hpp"
#include "sightline/camera.hpp"
#include "support/files.hpp"
#include "support/scenes.hpp"
#include "support/stairs.hpp"

namespace sightline {
namespace {

using namespace testing;
using boost::multiprecision::cpp_rational;
using scene_test::load_one;
using scene_test::load_text;
using scene_test::loaded;

const std::vector<glm::dvec3> kPlaces = {{1e3, 1e3, 1e3},     {-1e4, 0, 1e5},
                                         {1e6, -1e6, 1e7},    {0x1p10, 0x1p13, -0x1p16},
                                         {0x1p24, 0, 0x1p30}, {-0x1p40, 64, 0x1p20}};

/// A number of any size with any bits.
double any_number(Random& random, int exponent) {
    return std::ldexp(random.uniform(-2, 2), exponent);
}

// Rational arithmetic says that nothing is lost, whatever the box and the point in it.
TEST(Recentre, SubtractsExactly) {
    Random random(1);
    int moved = 0;
    for (int round = 0; round < 300; ++round) {
        const int exponent = static_cast<int>(random.below(80)) - 40;
        Box box;
        for (int axis = 0; axis < 3; ++axis) {
            // Some axes are near, some far, some have no size, some are just about far.
            const double size = random.chance(0.2) ? 0 : std::abs(any_number(random, exponent));
            const double place = any_number(
                random, exponent + static_cast<int>(random.below(random.chance(0.3) ? 60 : 8)));
            box.lo[axis] = place;
            box.hi[axis] = place + size;
        }
        const glm::dvec3 offset = offset_for(box);
        moved += offset != glm::dvec3(0) ? 1 : 0;
        for (int k = 0; k < 8; ++k) {
            for (int axis = 0; axis < 3; ++axis) {
                const double lo = box.lo[axis], hi = box.hi[axis];
                const double p = k == 0   ? lo
                                 : k == 1 ? hi
                                          : std::clamp(random.uniform(lo, hi), lo, hi);
                const double q = p - offset[axis];
                ASSERT_EQ(cpp_rational(q), cpp_rational(p) - cpp_rational(offset[axis])) << round;
                ASSERT_EQ(q + offset[axis], p) << round;
            }
        }
    }
    EXPECT_GT(moved, 75);
    EXPECT_LT(moved, 285);
}

TEST(Recentre, BringsWhatIsFarNextToTheOriginAndNothingElse) {
    EXPECT_EQ(offset_for({}), glm::dvec3(0));
    EXPECT_EQ(offset_for({{5, 5, 5}, {5, 5, 5}}), glm::dvec3(0)) << "without a size nothing is far";
    for (const double size : {1e-3, 0.7, 1.0, 3.0, 1e5}) {
        // Up to 32 sizes away nothing changes, from 80 sizes on everything is next to the origin.
        for (const double sizes : {0.0, -0.5, 1.0, 10.0, -31.0})
            EXPECT_EQ(offset_for({glm::dvec3(sizes * size), glm::dvec3((sizes + 1) * size)}),
                      glm::dvec3(0))
                << size << " " << sizes;
        for (const double sizes : {80.0, -300.0, 1e5, -1e12}) {
            const Box box{glm::dvec3(sizes * size), glm::dvec3((sizes + 1) * size)};
            const glm::dvec3 offset = offset_for(box);
            for (int axis = 0; axis < 3; ++axis)
                EXPECT_LE(std::abs(box.centre()[axis] - offset[axis]), 2 * size);
        }
    }
}

void expect_stairs(const Scene& scene, glm::dvec3 place, const std::string& what) {
    SCOPED_TRACE(what);
    const Scene home = loaded(load_text(as_obj(stairs_at({0, 0, 0})), "obj"));
    EXPECT_EQ(home.offset, glm::dvec3(0));
    EXPECT_EQ(scene.offset, place);
    EXPECT_EQ(scene.bounds, home.bounds);
    ASSERT_EQ(scene.triangle_count(), home.triangle_count());
    for (std::uint32_t t = 0; t < home.triangle_count(); ++t)
        for (int k = 0; k < 3; ++k)
            ASSERT_EQ(scene.positions[scene.triangles[t][k]], home.positions[home.triangles[t][k]]);
    EXPECT_EQ(scene.sheets.of_triangle, home.sheets.of_triangle);
    EXPECT_EQ(scene.sheets.ball, home.sheets.ball);
}

TEST(Recentre, TextsAndDoublesHaveTheirOldCoordinatesBack) {
    for (const glm::dvec3& place : kPlaces) {
        const std::vector<glm::dvec3> corners = stairs_at(place);
        expect_stairs(loaded(load_text(as_obj(corners), "obj")), place, "obj");
        expect_stairs(loaded(load_text(as_stl(corners), "stl")), place, "stl");
        for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"})
            expect_stairs(loaded(load_text(as_ply<double>(corners, format), "ply")), place, format);
    }
}

// Where the steps are eight units in the last place of a float, or more, floats tell them too.
TEST(Recentre, FloatsToo) {
    for (const glm::dvec3& place : {glm::dvec3(0x1p10, 0, -0x1p8), glm::dvec3(0, 0x1p16, 0)})
        for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"})
            expect_stairs(loaded(load_text(as_ply<float>(stairs_at(place), format), "ply")), place,
                          format);
}

// What a float holds is uncertain by its last place, wherever the scene is moved: a wall and the
// decal on it, both rounded, stay one sheet; of doubles that differ as much they are two.
TEST(Recentre, RoundedFacesStayCoplanar) {
    const auto wall_and_decal = [](double gap) {
        std::vector<glm::dvec3> corners;
        for (const double size : {1.0, 0.5})
            for (const double z : {0.0, 1.0})  // only the side at z = 0 counts
                for (const glm::dvec3 p :
                     {glm::dvec3(-1, -1, z), {1, -1, z}, {1, 1, z}, {-1, 1, z}})
                    corners.push_back(glm::dvec3(0, 0, 1000) + size * p +
                                      glm::dvec3(0, 0,
                                                 size == 1 ? 0
                                                 : z > 0   ? 0.2
                                                           : gap));
        return corners;
    };
    const auto together = [](const Scene& scene) {
        return scene.sheets.of(0) != kNone && scene.sheets.of(0) == scene.sheets.of(12);
    };
    const double last_place = 0x1p-14;  // of a float at 1,000
    const std::string binary = "binary_little_endian";
    const auto load = [](const std::string& file) { return loaded(load_text(file, "ply")); };
    const Scene floats = load(as_ply<float>(wall_and_decal(last_place), binary));
    EXPECT_NE(floats.offset, glm::dvec3(0));
    EXPECT_DOUBLE_EQ(floats.rounding, 0x1p-24 * 1001);
    EXPECT_TRUE(together(floats));
    const Scene doubles = load(as_ply<double>(wall_and_decal(last_place), binary));
    EXPECT_EQ(doubles.rounding, 0);
    EXPECT_FALSE(together(doubles));
    EXPECT_TRUE(together(load(as_ply<double>(wall_and_decal(0), binary))));
}

TEST(Recentre, ScenesMadeFromArrays) {
    for (const glm::dvec3& place : kPlaces) {
        SceneBuilder near, far;
        near.box({0, 0, 0}, {1, 2, 3});
        far.box(place, place + glm::dvec3(1, 2, 3));
        near.scene.lights = far.scene.lights = {Light{LightKind::point, {}, {0, 5, 0}}};
        far.scene.lights[0].position += place;
        const Scene a = near.build();
        Scene b = far.build();
        EXPECT_EQ(b.offset, place);
        EXPECT_EQ(a.positions, b.positions);
        EXPECT_EQ(a.bounds, b.bounds);
        EXPECT_EQ(a.lights[0].position, b.lights[0].position);
        finish_scene(b);
        EXPECT_EQ(b.offset, place) << "a second time changes nothing";
        EXPECT_EQ(a.positions, b.positions);
    }
}

TEST(Recentre, CamerasStandInTheCoordinatesOfTheFile) {
    const glm::dvec3 place(431200, 448, -5171800);
    const Scene home = loaded(load_text(as_obj(stairs_at({0, 0, 0})), "obj"));
    const Scene scene = loaded(load_text(as_obj(stairs_at(place)), "obj"));
    CameraOptions options;
    options.eye = glm::dvec3(5, 4, -3);
    options.target = glm::dvec3(1, 0.5, 1);
    const Camera near = must(make_camera(options, home, {64, 48}));
    *options.eye += place;
    *options.target += place;
    const Camera far = must(make_camera(options, scene, {64, 48}));
    const auto expect_equal = [](const Camera& a, const Camera& b) {
        EXPECT_EQ(a.eye, b.eye);
        EXPECT_EQ(a.target, b.target);
        EXPECT_EQ(a.near_plane, b.near_plane);
        EXPECT_EQ(a.far_plane, b.far_plane);
    };
    expect_equal(near, far);
    // A turntable's options are in the scene's own coordinates already.
    const CameraOptions turned = orbited(options, far, {0, 1, 0}, 90);
    expect_equal(must(make_camera(turned, scene, {64, 48})),
                 must(make_camera(turned, scene.reach, {64, 48})));
    expect_equal(must(make_camera(orbited(options, far, {0, 1, 0}, 0), scene, {64, 48})), far);
}

class FarScenes : public ::testing::Test {
protected:
    /// A cube, a sphere, a light, a camera, and a cube that turns about its own place and leaves.
    [[nodiscard]] Scene scene_at(glm::dvec3 p) const {
        (void)files_.write("stairs.obj", as_obj(stairs_at(p)));
        const auto point = [&](double x, double y, double z) {
            return fmt::format("[{}, {}, {}]", p.x + x, p.y + y, p.z + z);
        };
        const std::string back = fmt::format("[{}, {}, {}]", -p.x, -p.y, -p.z);
        return loaded(load_one(files_.write(
            "scene.json",
            fmt::format(R"({{"models": [{{"path": "stairs.obj"}}, {{"path": "stairs.obj", "frames":
                [[{{"translate": [0, 4, 0]}}],
                 [{{"translate": {}}}, {{"rotate": {{"axis": [0, 1, 0], "degrees": 90}}}},
                  {{"translate": {}}}]]}}],
                "surfaces": [{{"sphere": {{"centre": {}, "radius": 1}}}},
                             {{"cone": {{"from": {}, "to": {}, "radius": 0.5}}}}],
                "lights": [{{"type": "point", "position": {}}}],
                "camera": {{"eye": {}, "target": {}}}}})",
                        back, point(0, 0, 0), point(1, 2, 1), point(-1, 1, 0), point(-1, 2, 0),
                        point(0, 9, 0), point(8, 6, 7), point(1, 1, 1)))));
    }
    const TemporaryFolder files_;
};

TEST_F(FarScenes, EverythingThatHasAPlaceIsMoved) {
    const Scene home = scene_at({0, 0, 0});
    for (const glm::dvec3& place : {glm::dvec3(4096, 0, -8192), glm::dvec3(1 << 20, 1 << 20, 0)}) {
        const Scene far = scene_at(place);
        EXPECT_EQ(far.offset, place);
        EXPECT_EQ(far.positions, home.positions);
        EXPECT_EQ(far.bounds, home.bounds);
        EXPECT_EQ(far.reach, home.reach);
        EXPECT_EQ(far.lights[0].position, home.lights[0].position);
        for (std::size_t k = 0; k < 2; ++k)
            EXPECT_EQ(far.quadrics[k].frame, home.quadrics[k].frame);
        for (const std::uint32_t frame : {0u, 1u}) {
            const Scene a = posed(home, frame), b = posed(far, frame);
            EXPECT_EQ(b.offset, place) << "all frames are relative to one offset";
            EXPECT_EQ(a.positions, b.positions);
        }
        const CameraOptions none;
        const Camera camera = must(make_camera(far.camera.value_or(none), far, {64, 48}));
        EXPECT_EQ(camera.eye, glm::dvec3(8, 6, 7)) << "its options are in the file's coordinates";
        EXPECT_EQ(tessellate_quadrics(far).offset, place);
        EXPECT_EQ(tessellate_quadrics(far).positions, tessellate_quadrics(home).positions);
    }
}

TEST_F(FarScenes, PartsTakeTheOffsetOfTheWhole) {
    const std::string path = files_.write("far.obj", as_obj(stairs_at({1e6, 0, 0})));
    LoadOptions options;
    options.offset = glm::dvec3(0);
    EXPECT_EQ(loaded(load_one(path, options)).bounds.lo, glm::dvec3(1e6, 0, 0));
    options.offset = glm::dvec3(1e6 - 64, 0, 0);
    const Scene part = loaded(load_one(path, options));
    EXPECT_EQ(part.offset, *options.offset);
    EXPECT_EQ(part.bounds.lo, glm::dvec3(64, 0, 0));
}

}  // namespace
}  // namespace sightline
