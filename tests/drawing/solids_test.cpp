// Convex solids: a face is visible if and only if the eye lies strictly in front of it, which
// rational numbers tell. Eyes lie exactly in the planes of faces, too.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "drawing/pages.hpp"
#include "math/predicates.hpp"

namespace sightline {
namespace {

using namespace testing;
using boost::multiprecision::cpp_int;

/// Corners are whole numbers; faces are polygons with their fronts outside.
struct Solid {
    std::vector<glm::ivec3> corners;
    std::vector<std::vector<std::uint32_t>> faces;
};

cpp_int determinant(glm::i64vec3 a, glm::i64vec3 b, glm::i64vec3 c) {
    const auto minor = [](std::int64_t p, std::int64_t q, std::int64_t r, std::int64_t s) {
        return cpp_int(cpp_int(p) * q - cpp_int(r) * s);
    };
    return a.x * minor(b.y, c.z, b.z, c.y) + a.y * minor(b.z, c.x, b.x, c.z) +
           a.z * minor(b.x, c.y, b.y, c.x);
}

/// Sign of where a point lies: 1 in front of the plane, 0 in it.
int place(const Solid& solid, std::size_t face, glm::ivec3 point) {
    const auto corner = [&](std::size_t k) {
        return glm::i64vec3(solid.corners[solid.faces[face][k]]);
    };
    return determinant(corner(1) - corner(0), corner(2) - corner(0),
                       glm::i64vec3(point) - corner(0))
        .sign();
}

/// The same of a direction of projection: 1 where the front is seen.
int place_of_direction(const Solid& solid, std::size_t face, glm::ivec3 gaze) {
    const auto corner = [&](std::size_t k) {
        return glm::i64vec3(solid.corners[solid.faces[face][k]]);
    };
    return -determinant(corner(1) - corner(0), corner(2) - corner(0), glm::i64vec3(gaze)).sign();
}

Solid prism(const std::vector<glm::ivec2>& base, glm::ivec3 along) {
    Solid solid;
    const auto n = static_cast<std::uint32_t>(base.size());
    for (const glm::ivec2& p : base) solid.corners.emplace_back(p.x, p.y, 0);
    for (const glm::ivec2& p : base) solid.corners.push_back(glm::ivec3(p.x, p.y, 0) + along);
    std::vector<std::uint32_t> below, above;
    for (std::uint32_t k = 0; k < n; ++k) {
        const std::uint32_t next = (k + 1) % n;
        below.insert(below.begin(), k);
        above.push_back(n + k);
        solid.faces.push_back({k, next, n + next, n + k});
    }
    solid.faces.push_back(below);
    solid.faces.push_back(above);
    return solid;
}

Solid house() {
    Solid solid;
    solid.corners = {{0, 0, 0}, {8, 0, 0}, {8, 5, 0}, {4, 8, 0}, {0, 5, 0},
                     {0, 0, 9}, {8, 0, 9}, {8, 5, 9}, {4, 8, 9}, {0, 5, 9}};
    solid.faces = {{4, 3, 2, 1, 0}, {5, 6, 7, 8, 9}, {0, 1, 6, 5}, {1, 2, 7, 6},
                   {2, 3, 8, 7},    {3, 4, 9, 8},    {4, 0, 5, 9}};
    return solid;
}

/// The convex hull of random points on a lattice, its triangles by trying every three points; no
/// four points of it lie in a plane.
std::optional<Solid> random_hull(Random& random, std::uint32_t n) {
    Solid solid;
    for (std::uint32_t k = 0; k < n; ++k)
        solid.corners.emplace_back(random.below(41), random.below(41), random.below(41));
    for (std::uint32_t a = 0; a < n; ++a)
        for (std::uint32_t b = a + 1; b < n; ++b)
            for (std::uint32_t c = b + 1; c < n; ++c) {
                solid.faces.push_back({a, b, c});
                int before = 0, behind = 0;
                for (std::uint32_t d = 0; d < n; ++d) {
                    if (d == a || d == b || d == c) continue;
                    const int side = place(solid, solid.faces.size() - 1, solid.corners[d]);
                    if (side == 0) return std::nullopt;
                    ++(side > 0 ? before : behind);
                }
                if (before > 0 && behind > 0) solid.faces.pop_back();
                if (before > 0 && behind == 0)
                    std::swap(solid.faces.back()[1], solid.faces.back()[2]);
            }
    return solid;
}

/// Every face an object of its own, so that nothing is culled.
Scene scene_of(const Solid& solid) {
    Scene scene;
    scene.materials.emplace_back();
    for (const glm::ivec3& p : solid.corners) scene.positions.emplace_back(p);
    for (const auto& face : solid.faces) {
        Object object;
        object.first_triangle = scene.triangle_count();
        object.triangle_count = static_cast<std::uint32_t>(face.size()) - 2;
        object.first_polygon = static_cast<std::uint32_t>(scene.objects.size());
        object.polygon_count = 1;
        for (std::size_t k = 2; k < face.size(); ++k) {
            scene.triangles.emplace_back(face[0], face[k - 1], face[k]);
            scene.triangle_polygon.push_back(object.first_polygon);
            scene.polygon_edges.push_back(
                static_cast<std::uint8_t>(2 + (k == 2 ? 1 : 0) + (k + 1 == face.size() ? 4 : 0)));
        }
        scene.objects.push_back(object);
    }
    finish_scene(scene);
    return scene;
}

/// Area and perimeter of the convex hull of the solid's picture, in pixels.
std::pair<double, double> silhouette(const Solid& solid, const Camera& camera) {
    std::vector<glm::dvec2> points, hull;
    for (const glm::ivec3& p : solid.corners) points.push_back(camera.pixel_of(glm::dvec3(p)));
    std::ranges::sort(points, {}, [](const glm::dvec2& p) { return std::pair(p.x, p.y); });
    const auto cross = [](const glm::dvec2& u, const glm::dvec2& v) {
        return u.x * v.y - u.y * v.x;
    };
    for (int half = 0; half < 2; ++half) {
        const std::size_t start = hull.size();
        for (const glm::dvec2& p : points) {
            while (hull.size() >= start + 2 &&
                   cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0)
                hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        std::ranges::reverse(points);
    }
    double doubled = 0, around = 0;
    for (std::size_t k = 0; k < hull.size(); ++k) {
        const glm::dvec2 &p = hull[k], &q = hull[(k + 1) % hull.size()];
        doubled += cross(p, q);
        around += glm::length(q - p);
    }
    return {0.5 * std::abs(doubled), around};
}

/// front(face): whether it is seen.
template <class Front>
void expect_faces(const Solid& solid, const Camera& camera, const Front& front,
                  const std::string& what) {
    const Scene scene = scene_of(solid);
    const ScreenScene screen = page(scene, camera);
    for (const TraceMethod method : {TraceMethod::fast, TraceMethod::pairwise}) {
        TraceOptions options;
        options.method = method;
        options.fill = FillStyle::flat;
        const auto areas = must(visible_areas(screen, options));
        double sum = 0;
        for (std::uint32_t t = 0; t < areas.size(); ++t) {
            const bool visible = front(scene.triangle_polygon[t]);
            ASSERT_EQ(areas[t].visible > 0, visible)
                << what << ", face " << scene.triangle_polygon[t] << ": " << areas[t].visible;
            sum += areas[t].visible;
        }
        const auto [area, around] = silhouette(solid, camera);
        const double step = std::ldexp(1.0, -screen.subpixel_bits());
        ASSERT_NEAR(sum, area, step * around) << what;
        // The regions of a drawing are those of the faces that are seen.
        const Drawing drawing = must(trace(screen, options));
        std::size_t fronts = 0;
        for (std::size_t face = 0; face < solid.faces.size(); ++face) fronts += front(face) ? 1 : 0;
        ASSERT_EQ(drawing.regions.size(), fronts) << what;
        for (const std::uint32_t polygon : drawing.regions.polygon)
            ASSERT_TRUE(front(polygon)) << what;
    }
}

Camera looking_from(glm::ivec3 eye, const Scene& scene) {
    CameraOptions options;
    options.eye = glm::dvec3(eye);
    options.up = glm::dvec3(0.1, 1, 0.2);
    return must(make_camera(options, scene.bounds, {400, 300}));
}

/// An eye in the plane of a face, outside of the solid.
std::optional<glm::ivec3> eye_in_plane(const Solid& solid, std::size_t face, Random& random) {
    const auto corner = [&](std::size_t k) { return solid.corners[solid.faces[face][k]]; };
    const auto factor = [&] { return static_cast<int>(random.below(9)) - 4; };
    const glm::ivec3 eye =
        corner(0) + factor() * (corner(1) - corner(0)) + factor() * (corner(2) - corner(0));
    bool in_front_of_one = false;
    for (std::size_t f = 0; f < solid.faces.size(); ++f)
        in_front_of_one = in_front_of_one || place(solid, f, eye) > 0;
    if (!in_front_of_one) return std::nullopt;
    return eye;
}

std::vector<Solid> solids() {
    std::vector<Solid> all = {
        prism({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {0, 0, 1}),
        prism({{0, 0}, {9, 0}, {14, 8}, {5, 12}, {-3, 5}}, {0, 0, 20}),
        prism({{0, 0}, {9, 1}, {4, 7}}, {3, 5, 11}),
        house(),
    };
    Random random(7);
    while (all.size() < 12)
        if (auto hull = random_hull(random, 5 + random.below(6))) all.push_back(*hull);
    return all;
}

TEST(Solids, ShowTheFacesWhoseFrontIsTowardsTheEye) {
    Random random(11);
    int views = 0, in_planes = 0;
    const std::vector<Solid> all = solids();
    const auto wanted = static_cast<int>(amount(2000, 150, 40));
    while (views < wanted) {
        const Solid& solid = all[random.below(static_cast<std::uint32_t>(all.size()))];
        const auto face = random.below(static_cast<std::uint32_t>(solid.faces.size()));
        std::optional<glm::ivec3> eye = eye_in_plane(solid, face, random);
        if (views % 4 == 0)
            eye = glm::ivec3(static_cast<int>(random.below(200)) - 100, 70, random.below(90));
        if (!eye) continue;
        // All of the solid is to be in the picture.
        const Scene scene = scene_of(solid);
        const Camera camera = looking_from(*eye, scene);
        const bool whole = std::ranges::all_of(solid.corners, [&](const glm::ivec3& p) {
            const glm::dvec3 corner(p);
            const glm::dvec2 at = camera.pixel_of(corner);
            return camera.depth_of(corner) > camera.near_plane && at.x > 1 && at.x < 399 &&
                   at.y > 1 && at.y < 299;
        });
        if (!whole) continue;
        ++views;
        const auto front = [&](std::size_t f) { return place(solid, f, *eye) > 0; };
        for (std::size_t f = 0; f < solid.faces.size(); ++f)
            in_planes += place(solid, f, *eye) == 0 ? 1 : 0;
        expect_faces(solid, camera, front, "view " + std::to_string(views));
    }
    EXPECT_GT(in_planes, wanted / 2);
}

TEST(Solids, ShowTheFacesWhoseFrontIsTowardsTheDirectionOfProjection) {
    Random random(13);
    int views = 0, in_planes = 0;
    const std::vector<Solid> all = solids();
    const auto wanted = static_cast<int>(amount(2000, 100, 30));
    while (views < wanted) {
        const Solid& solid = all[random.below(static_cast<std::uint32_t>(all.size()))];
        const auto& face =
            solid.faces[random.below(static_cast<std::uint32_t>(solid.faces.size()))];
        const auto factor = [&] { return static_cast<int>(random.below(9)) - 4; };
        glm::ivec3 gaze = factor() * (solid.corners[face[1]] - solid.corners[face[0]]) +
                          factor() * (solid.corners[face[2]] - solid.corners[face[0]]);
        if (views % 4 == 0) gaze = {factor(), factor(), factor()};
        if (gaze == glm::ivec3(0)) continue;
        ++views;
        CameraOptions options;
        options.direction = glm::dvec3(gaze);
        options.projection = Projection::orthographic;
        options.up = glm::dvec3(0.13, 1, 0.27);
        const Camera camera = must(make_camera(options, scene_of(solid).bounds, {400, 300}));
        for (std::size_t f = 0; f < solid.faces.size(); ++f)
            in_planes += place_of_direction(solid, f, gaze) == 0 ? 1 : 0;
        expect_faces(
            solid, camera, [&](std::size_t f) { return place_of_direction(solid, f, gaze) > 0; },
            "view " + std::to_string(views));
    }
    EXPECT_GT(in_planes, wanted / 2);
}

// The cube of the notes, six faces, each an object.
TEST(Solids, ACubeFromAnEyeInThePlanesOfTwoFaces) {
    const Solid cube = prism({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {0, 0, 1});
    CameraOptions options;
    options.eye = glm::dvec3(5, -1, 5);
    options.target = glm::dvec3(0);
    const Camera camera = must(make_camera(options, scene_of(cube).bounds, {}));
    expect_faces(
        cube, camera,
        [&](std::size_t f) {
            return place(cube, f, {5, -1, 5}) > 0;
        },
        "cube");
}

}  // namespace
}  // namespace sightline
