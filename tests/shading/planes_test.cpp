// One plane, one normal: what lies in one plane is lit alike.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <random>

#include "scene/meshes.hpp"
#include "shading/view_of.hpp"

namespace {

using namespace sightline;
using scene_test::load_text;
using scene_test::loaded;
using test::View;
using test::view_of;

/// Writes an OBJ of polygons in planes turned at random, with coordinates of six digits.
class TurnedObj {
public:
    /// Corners in a plane of its own, as polygons.
    void add(const std::vector<glm::dvec2>& corners,
             const std::vector<std::vector<unsigned>>& polygons) {
        const auto vector = [&] { return glm::dvec3{number(), number(), number()}; };
        const glm::dvec3 u = glm::normalize(vector()), n = glm::normalize(glm::cross(u, vector()));
        const glm::dvec3 v = glm::cross(n, u), shift = 8.0 * vector();
        for (const glm::dvec2& c : corners) {
            const glm::dvec3 p = shift + c.x * u + c.y * v;
            text_ += fmt::format("v {:.6f} {:.6f} {:.6f}\n", p.x, p.y, p.z);
        }
        for (const auto& polygon : polygons) {
            text_ += "f";
            for (const unsigned corner : polygon) text_ += fmt::format(" {}", corners_ + corner);
            text_ += "\n";
        }
        corners_ += static_cast<unsigned>(corners.size());
    }

    [[nodiscard]] Scene scene() const { return loaded(load_text(text_, "obj")); }

private:
    double number() { return std::uniform_real_distribution<double>(-1, 1)(random_); }

    std::mt19937 random_{6};
    std::string text_;
    unsigned corners_ = 1;
};

/// Colours and normals that the samples of each group of polygons have.
template <class Group>
void expect_one_each(const View& view, const Group& group_of) {
    const ColorImage colors = view.shade(Shading::flat);
    const NormalImage normals = normal_map(view.screen, view.visibility, false);
    std::map<std::uint32_t, std::size_t> seen;  // where each group is seen first
    for (std::size_t i = 0; i < colors.pixels.size(); ++i) {
        const std::uint32_t id = view.visibility.ids[i];
        if (id == kNone) continue;
        const std::uint32_t group = group_of(view.screen.scene().triangle_polygon[id]);
        const std::size_t first = seen.emplace(group, i).first->second;
        ASSERT_EQ(colors.pixels[i], colors.pixels[first]) << "group " << group;
        ASSERT_EQ(normals.pixels[i], normals.pixels[first]) << "group " << group;
    }
    EXPECT_GT(seen.size(), 5u);
}

CameraOptions parallel_view() {
    CameraOptions options;
    options.projection = Projection::orthographic;
    return options;
}

TEST(Planes, TheTrianglesOfAFlatPolygonHaveOneNormal) {
    TurnedObj obj;
    std::vector<glm::dvec2> disc;
    std::vector<unsigned> corners;
    for (unsigned i = 0; i < 90; ++i) {
        disc.emplace_back(2 * std::cos(i * 0.0698131700797732),
                          2 * std::sin(i * 0.0698131700797732));
        corners.push_back(i);
    }
    for (int k = 0; k < 12; ++k) {
        obj.add({{0, 0}, {3, 0}, {3, 2}, {0, 2}}, {{0, 1, 2, 3}});
        obj.add({{0, 0}, {0.01, 0}, {0.01, 0.01}, {0, 0.01}}, {{0, 1, 2, 3}});
        obj.add(disc, {corners});  // thin triangles, whose own normals are uncertain
    }
    Scene scene = obj.scene();
    for (CameraOptions options : {parallel_view(), CameraOptions{}}) {
        for (const auto direction : {glm::dvec3{-1, -1, -1}, glm::dvec3{0.2, 1, 0.3}}) {
            options.direction = direction;
            expect_one_each(view_of(scene, options, {320, 240}),
                            [](std::uint32_t polygon) { return polygon; });
        }
    }
}

TEST(Planes, TheFacesOfASheetHaveOneNormal) {
    // A wall of two quadrangles and a triangle that share no corner, with a decal on it.
    TurnedObj obj;
    for (int k = 0; k < 12; ++k) {
        obj.add({{0, 0},
                 {2, 0},
                 {2, 2.5},
                 {0, 2.5},
                 {2, 0},
                 {4.1, 0},
                 {4, 2.5},
                 {2, 2.5},
                 {0, 2.5},
                 {4, 2.5},
                 {1, 3.1},
                 {0.3, 0.4},
                 {1.3, 0.4},
                 {1.3, 1.1},
                 {0.3, 1.2}},
                {{0, 1, 2, 3}, {4, 5, 6, 7}, {8, 9, 10}, {11, 12, 13, 14}});
    }
    Scene scene = obj.scene();
    for (const auto direction : {glm::dvec3{-1, -1, -1}, glm::dvec3{0.2, 1, 0.3}}) {
        CameraOptions options = parallel_view();
        options.direction = direction;
        expect_one_each(view_of(scene, options, {320, 240}),
                        [](std::uint32_t polygon) { return polygon / 4; });
    }
}

TEST(Planes, APolygonThatIsNotFlatKeepsTheNormalsOfItsParts) {
    Scene scene = loaded(load_text("v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 1 0.5\nf 1 2 3 4\n", "obj"));
    CameraOptions options = parallel_view();
    options.direction = glm::dvec3{0.1, -1, -0.2};
    const View view = view_of(scene, options, {64, 64});
    const NormalImage normals = normal_map(view.screen, view.visibility, false);
    std::map<std::uint32_t, glm::vec3> of_triangle;
    for (std::size_t i = 0; i < normals.pixels.size(); ++i) {
        if (view.visibility.ids[i] != kNone)
            of_triangle[view.visibility.ids[i]] = normals.pixels[i];
    }
    ASSERT_EQ(of_triangle.size(), 2u);
    EXPECT_LT(glm::dot(of_triangle[0], of_triangle[1]), 0.9f);
}

}  // namespace
