// Our readers against assimp's reading of the same file: the same triangles in the same order with
// the same attributes. assimp's numbers may be one unit in the last place off; where it is wrong
// or loses something (see docs/formats.md), nothing is compared.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "scene/load/assimp_reader.hpp"
#include "scene/load/build.hpp"
#include "scene/load/text.hpp"
#include "scene/meshes.hpp"
#include "support/files.hpp"
#include "support/models.hpp"

namespace sightline {
namespace {

using scene_test::load_one;
using scene_test::loaded;
using scene_test::raw;
using testing::TemporaryFolder;

Scene read_by_assimp(const std::string& path) {
    const auto soup = load::read_with_assimp({path, path, load::extension_of(path), {}, {}});
    if (!std::holds_alternative<load::Soup>(soup)) {
        ADD_FAILURE() << std::get<std::string>(soup);
        return {};
    }
    load::SceneBuilder builder(std::size_t{1} << 30);
    load::Placement placement;
    placement.file = path;
    placement.default_name = load::stem_of(path);
    const Status built = builder.append(std::get<load::Soup>(soup), placement);
    if (!built) ADD_FAILURE() << built.error().message;
    return builder.take();
}

bool close(double a, double b) { return std::abs(a - b) <= 1.5e-7 * std::abs(b); }

void expect_same_corner(const Scene& ours, const Scene& theirs, std::uint32_t t, int k) {
    const glm::dvec3 &a = ours.positions[ours.triangles[t][k]],
                     &b = theirs.positions[theirs.triangles[t][k]];
    ASSERT_TRUE(close(a.x, b.x) && close(a.y, b.y) && close(a.z, b.z)) << "triangle " << t;
    const auto attribute = [&](const auto& indices, const auto& values) {
        using Value = std::decay_t<decltype(values[0])>;
        const bool none = indices.empty() || indices[t][k] == kNone;
        return none ? Value(-9) : values[indices[t][k]];
    };
    const glm::vec3 normal = attribute(ours.triangle_normals, ours.normals) -
                             attribute(theirs.triangle_normals, theirs.normals);
    ASSERT_LT(std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z), 1e-5) << t;
    ASSERT_EQ(attribute(ours.triangle_colors, ours.colors),
              attribute(theirs.triangle_colors, theirs.colors))
        << "triangle " << t;
}

void expect_as_assimp(const std::string& path, bool with_materials) {
    SCOPED_TRACE(path);
    const Scene ours = loaded(load_one(path)), theirs = read_by_assimp(path);
    ASSERT_EQ(ours.triangle_count(), theirs.triangle_count());
    EXPECT_EQ(ours.positions.size(), theirs.positions.size());
    EXPECT_EQ(ours.triangle_polygon, theirs.triangle_polygon);
    EXPECT_EQ(ours.polygon_edges, theirs.polygon_edges);
    EXPECT_EQ(ours.counts.ignored_primitives, theirs.counts.ignored_primitives);
    ASSERT_EQ(ours.objects.size(), theirs.objects.size());
    for (std::size_t i = 0; i < ours.objects.size(); ++i) {
        const Object &a = ours.objects[i], &b = theirs.objects[i];
        EXPECT_EQ(a.first_triangle, b.first_triangle);
        EXPECT_EQ(a.has_file_normals, b.has_file_normals);
        EXPECT_TRUE(a.name == b.name || b.name == "defaultobject") << a.name << ", " << b.name;
        if (!with_materials) continue;
        const Material &m = ours.materials[a.material], &n = theirs.materials[b.material];
        EXPECT_EQ(m.name, n.name);
        EXPECT_EQ(m.base_color, n.base_color);
        EXPECT_EQ(m.opacity, n.opacity);
    }
    for (std::uint32_t t = 0; t < ours.triangle_count(); ++t) {
        for (int k = 0; k < 3; ++k) {
            ASSERT_NO_FATAL_FAILURE(expect_same_corner(ours, theirs, t, k));
        }
    }
}

class Random {
public:
    explicit Random(unsigned seed) : engine_(seed) {}
    unsigned below(unsigned n) { return static_cast<unsigned>(engine_() % n); }
    /// A multiple of 1/64, which six decimals tell exactly and floats hold: how a polygon without
    /// area is split depends on the last bits, and ours has more of them.
    float number() { return static_cast<float>(below(12'801)) / 64 - 100; }
    std::string numbers(int n) {
        std::string text;
        for (int i = 0; i < n; ++i) text += " " + std::to_string(number());
        return text;
    }

private:
    std::mt19937 engine_;
};

/// Vertices and normals first, then faces of 3 to 6 corners in objects, groups and materials.
std::string random_obj(Random& random, bool colors, bool normals) {
    std::string text = "mtllib a.mtl\n";
    const unsigned vertices = 5 + random.below(60);
    for (unsigned i = 0; i < vertices; ++i) {
        text += "v" + random.numbers(3) + (colors ? " 0.25 1 0.5" : "") + "\n";
        if (normals) text += "vn" + random.numbers(3) + "\n";
    }
    text += "o first\nusemtl m0\n";
    for (int i = 0; i < 60; ++i) {
        const unsigned choice = random.below(12);
        if (choice == 0) text += "g group" + std::to_string(i) + "\n";
        if (choice == 1) text += "usemtl m" + std::to_string(random.below(4)) + "\n";
        if (choice == 2) text += "# nothing\ns 1\n";
        text += "f";
        for (unsigned k = 3 + random.below(4); k > 0; --k) {
            const bool back = random.below(3) == 0;
            const std::string v = back ? "-" + std::to_string(1 + random.below(vertices))
                                       : std::to_string(1 + random.below(vertices));
            text += " " + v;
            if (normals) text += "//" + std::to_string(1 + random.below(vertices));
        }
        text += "\n";
    }
    return text;
}

TEST(AssimpComparison, RandomObjFiles) {
    const TemporaryFolder folder;
    (void)folder.write("a.mtl",
                       "newmtl m1\nKd 1 0.5 0\nd 0.5\nnewmtl m0\nKd 0 0.25 1\nnewmtl m2\n");
    Random random(1);
    for (int i = 0; i < 40; ++i) {
        const std::string text = random_obj(random, i % 4 == 1, i % 2 == 0);
        expect_as_assimp(folder.write("a.obj", text), true);
    }
}

TEST(AssimpComparison, RandomPlyFiles) {
    const TemporaryFolder folder;
    Random random(2);
    for (int i = 0; i < 20; ++i) {
        const bool binary = i % 2 == 0;
        const unsigned vertices = 5 + random.below(60), faces = 1 + random.below(60);
        std::string text =
            std::string("ply\nformat ") + (binary ? "binary_little_endian" : "ascii") +
            " 1.0\nelement vertex " + std::to_string(vertices) +
            "\nproperty float x\nproperty float y\nproperty float z\n"
            "property float nx\nproperty float ny\nproperty float nz\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\n"
            "element face " +
            std::to_string(faces) + "\nproperty list uchar int vertex_indices\nend_header\n";
        for (unsigned v = 0; v < vertices; ++v) {
            if (!binary) text += random.numbers(6) + " 255 7 128\n";
            for (int k = 0; binary && k < 6; ++k) text += raw(random.number());
            if (binary) text += "\xff\x07\x80";
        }
        for (unsigned f = 0; f < faces; ++f) {
            const unsigned size = 3 + random.below(4);
            text += binary ? raw(static_cast<std::uint8_t>(size)) : std::to_string(size);
            for (unsigned k = 0; k < size; ++k) {
                const unsigned v = random.below(vertices);
                text += binary ? raw(v) : " " + std::to_string(v);
            }
            if (!binary) text += "\n";
        }
        expect_as_assimp(folder.write("a.ply", text), false);
    }
}

std::string text_of(const glm::vec3& v) {
    return " " + std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z);
}

TEST(AssimpComparison, RandomStlFiles) {
    const TemporaryFolder folder;
    Random random(3);
    for (int i = 0; i < 20; ++i) {
        const unsigned facets = 1 + random.below(60);
        std::string ascii = "solid one\n", binary = std::string(80, ' ') + raw(facets);
        for (unsigned f = 0; f < facets; ++f) {
            // A normal that contradicts its facet is not used here.
            std::array<glm::vec3, 3> corners;
            for (glm::vec3& corner : corners)
                for (int axis = 0; axis < 3; ++axis) corner[axis] = random.number();
            const glm::vec3 normal =
                glm::cross(corners[1] - corners[0], corners[2] - corners[0]) / 64.0f;
            ascii += "facet normal" + text_of(normal) + "\nouter loop\n";
            binary += raw(normal);
            for (const glm::vec3& corner : corners) {
                ascii += "vertex" + text_of(corner) + "\n";
                binary += raw(corner);
            }
            ascii += "endloop\nendfacet\n";
            binary += raw(std::uint16_t{0});
        }
        expect_as_assimp(folder.write("a.stl", ascii + "endsolid one\n"), true);
        expect_as_assimp(folder.write("b.stl", binary), true);
    }
}

TEST(AssimpComparison, RealModels) {
    int compared = 0;
    for (const char* name : {"cheburashka.obj", "cow.obj", "fandisk.obj", "spot.obj",
                             "stanford-bunny.obj", "suzanne.obj", "teapot.obj", "woody.obj"}) {
        const std::filesystem::path path = testing::models_folder() / name;
        if (!std::filesystem::exists(path)) continue;
        expect_as_assimp(path.string(), true);
        ++compared;
    }
    if (compared == 0) GTEST_SKIP() << "needs the models";
}

}  // namespace
}  // namespace sightline
