// Curves of pairs of surfaces whose lengths are known in the world, seen from anywhere: nothing is
// lost, nothing is invented.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <map>

#include "drawing/intersections.hpp"
#include "drawing/pages.hpp"
#include "drawing/surfaces.hpp"

namespace sightline {
namespace {

using namespace testing;

constexpr Resolution kPage{400, 300};

double length_of(const Crossing& c) {
    return std::hypot(static_cast<double>(c.q.x) - c.p.x, static_cast<double>(c.q.y) - c.p.y);
}

std::vector<Crossing> crossings_on(const ScreenScene& page,
                                   TraceMethod method = TraceMethod::fast) {
    const Occluders occluders(page, method, 1);
    const std::function<bool(double)> nobody;
    WorkMeter meter(nobody);
    return find_crossings(occluders, 1, meter);
}

/// All lengths in steps of the page.
struct Expected {
    double length = 0;
    double moved = 0;  ///< by how much snapping can change it
};

double length_of(const glm::dvec2& v) { return std::sqrt(glm::dot(v, v)); }

/// Snapping moves a plane by half of 1 + |gx| + |gy|, the curve therefore by the sum of two such
/// halves over the gradient of their difference, and its end on an edge by that over the sine of
/// their angle. A plane that many faces share may be off by three times as much away from the
/// corners that determine it: what the sum of all moves, one in one direction and one in another,
/// has room for.
Expected expected_of(const ScreenScene& page, const Camera& camera, const WorldCrossing& c) {
    const double unit = std::ldexp(1.0, page.subpixel_bits());
    const glm::dvec2 way = unit * (camera.pixel_of(c.end[1]) - camera.pixel_of(c.end[0]));
    Expected expected{length_of(way), 2};
    const auto gradient = [&](std::uint32_t t) {
        const Plane p = page.plane(t);
        return glm::dvec2(p.a, p.b) / static_cast<double>(p.c);
    };
    const glm::dvec2 f = gradient(c.f), g = gradient(c.g);
    const double moved = 1.5 * (2 + std::abs(f.x) + std::abs(f.y) + std::abs(g.x) + std::abs(g.y)) /
                         length_of(f - g);
    for (const auto& edge : c.edge) {
        const glm::dvec2 e = camera.pixel_of(edge[1]) - camera.pixel_of(edge[0]);
        const double sine = std::abs(e.x * way.y - e.y * way.x) / (length_of(e) * expected.length);
        expected.moved += std::min(moved / sine, expected.length);
    }
    if (!std::isfinite(expected.moved)) expected.moved = HUGE_VAL;
    return expected;
}

TEST(CrossingLengths, OfPairsOfSurfacesAreThoseOfTheWorldFromEverywhere) {
    const std::uint64_t count = amount(2000, 75, 3);  // of each kind
    std::uint64_t compared = 0, segments = 0, too_close = 0;
    double total = 0, known = 0;
    for (int kind = 0; kind < kSurfaceKinds; ++kind) {
        for (std::uint64_t seed = 0; seed < count; ++seed) {
            SCOPED_TRACE("kind " + std::to_string(kind) + " seed " + std::to_string(seed));
            const SurfacePair pair = surface_pair(kind, seed);
            const Scene scene = pair.builder.build();
            const Camera camera = random_view(scene, seed, kPage);
            const ScreenScene screen = page(scene, camera);
            Expected all;
            for (const WorldCrossing& c : world_crossings(scene, pair.second)) {
                const Expected e = expected_of(screen, camera, c);
                all.length += e.length;
                all.moved += e.moved;
                ++segments;
            }
            double sum = 0;
            for (const Crossing& c : crossings_on(screen)) sum += length_of(c);
            EXPECT_NEAR(sum, all.length, all.moved) << "of " << all.length;
            if (all.moved > 1e-3 * all.length) {
                ++too_close;
                continue;
            }
            ++compared;
            total += sum;
            known += all.length;
        }
    }
    std::cout << compared << " pairs, " << segments << " segments, " << total << " of " << known
              << " steps, " << too_close << " pairs where snapping moves more than 1e-3\n";
    EXPECT_GT(compared, 2 * count);
    EXPECT_NEAR(total, known, 1e-5 * known);
}

/// The surfaces of a pair keep their own points, as those of two objects do.
Scene with_points_apart(const SurfacePair& pair) {
    Scene scene = pair.builder.scene;
    SceneBuilder parts[2];
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
        const WorldTriangle c = corners_of(scene, t);
        parts[t < pair.second ? 0 : 1].triangle(c[0], c[1], c[2]);
    }
    const Scene first = parts[0].build(), second = parts[1].build();
    scene.positions = first.positions;
    scene.positions.insert(scene.positions.end(), second.positions.begin(), second.positions.end());
    const auto shift = static_cast<std::uint32_t>(first.positions.size());
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t)
        for (int k = 0; k < 3; ++k)
            scene.triangles[t][k] = t < pair.second ? first.triangles[t][k]
                                                    : second.triangles[t - pair.second][k] + shift;
    // Two objects, for points of one are joined.
    Object second_object = scene.objects[0];
    scene.objects[0].triangle_count = pair.second;
    scene.objects[0].polygon_count = scene.triangle_polygon[pair.second];
    second_object.first_triangle = pair.second;
    second_object.triangle_count -= pair.second;
    second_object.first_polygon = scene.objects[0].polygon_count;
    second_object.polygon_count -= second_object.first_polygon;
    scene.objects.push_back(second_object);
    finish_scene(scene);
    return scene;
}

/// The length on the page of the zero line of a surface over the plane n . p = 0: through
/// triangles, through their corners, and along edges whose two sides lie on either side of it.
double zero_line(const SurfacePair& pair, const Scene& scene, const Camera& camera,
                 std::uint64_t& pieces) {
    double length = 0;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    const auto add = [&](const glm::dvec3& p, const glm::dvec3& q) {
        length += length_of(camera.pixel_of(q) - camera.pixel_of(p));
        ++pieces;
    };
    for (std::uint32_t t = pair.second; t < scene.triangle_count(); ++t) {
        const WorldTriangle c = corners_of(scene, t);
        std::array<double, 3> z{};
        double off = 0;
        int zeros = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            z[k] = glm::dot(c[k], pair.floor);
            if (std::abs(z[k]) < 1e-12) z[k] = 0;
            zeros += z[k] == 0;
            if (z[k] != 0) off = z[k];
        }
        std::vector<glm::dvec3> ends;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t next = (k + 1) % 3;
            if (z[k] == 0) ends.push_back(c[k]);
            if (z[k] * z[next] < 0)
                ends.push_back(c[k] + z[k] / (z[k] - z[next]) * (c[next] - c[k]));
            if (zeros != 2 || z[k] != 0 || z[next] != 0) continue;
            const auto [low, high] = std::minmax({scene.triangles[t][static_cast<int>(k)],
                                                  scene.triangles[t][static_cast<int>(next)]});
            edges[{low, high}] |= off > 0 ? 1 : 2;
        }
        if (zeros < 2 && ends.size() == 2) add(ends[0], ends[1]);
    }
    for (const auto& [edge, sides] : edges)
        if (sides == 3) add(scene.positions[edge.first], scene.positions[edge.second]);
    return length;
}

SurfacePair through_corners(int kind, Random& random) {
    const TurnedFrame frame(random);
    const std::uint32_t n = 8 + 2 * random.below(3);  // so that x = 0 is a line of the grid
    const double a = random.uniform(.05, .5), fx = random.uniform(1, 3), fy = random.uniform(1, 3);
    SurfacePair pair;
    pair.floor = frame.n;
    const double size = kind == 3 ? 1.1 : 1;
    add_surface(pair.builder, kind == 3 ? 3 : n, kind == 3 ? 3 : n, [&](double s, double t) {
        return frame.at(size * (2 * s - 1), size * (2 * t - 1), 0);
    });
    pair.second = pair.builder.scene.triangle_count();
    add_surface(pair.builder, n, n, [&](double s, double t) {
        const double x = 2 * s - 1, y = 2 * t - 1;
        const double z = kind == 0   ? std::sin(fx * x) * std::cos(fy * y)
                         : kind == 1 ? x * (y - .5)  // has coplanar parts, which have no curve
                         : kind == 2 ? x - y
                                     : (x > 0 ? x : .3 * x) * (1 + .2 * y);
        return frame.at(x, y, a * z);
    });
    return pair;
}

TEST(CrossingLengths, ThroughCornersAndAlongEdgesNothingIsLost) {
    std::uint64_t pieces = 0;
    for (int kind = 0; kind < 4; ++kind) {
        for (std::uint64_t seed = 0; seed < amount(500, 15, 2); ++seed) {
            SCOPED_TRACE("kind " + std::to_string(kind) + " seed " + std::to_string(seed));
            Random random(7 * seed + static_cast<std::uint64_t>(kind));
            const SurfacePair pair = through_corners(kind, random);
            const Scene scene = with_points_apart(pair);
            const Camera camera = random_view(scene, seed, kPage);
            const glm::dvec3 gaze = glm::normalize(camera.view_vector(glm::dvec3(0)));
            if (std::abs(glm::dot(gaze, pair.floor)) < .15) continue;  // it grazes the floor
            const ScreenScene screen = page(scene, camera);
            const double unit = std::ldexp(1.0, screen.subpixel_bits());
            const std::uint64_t before = pieces;
            const double known = unit * zero_line(pair, scene, camera, pieces);
            double sum = 0;
            for (const Crossing& c : crossings_on(screen)) sum += length_of(c);
            EXPECT_NEAR(sum, known, 1e-3 * known + 4 * static_cast<double>(pieces - before));
        }
    }
    EXPECT_GT(pieces, amount(500, 500, 100));
}

// Each two of them cross there, whichever face hides the line.
TEST(CrossingLengths, ThreeSurfacesInOneLineHaveThreeCurves) {
    for (std::uint64_t seed = 0; seed < amount(2000, 60, 20); ++seed) {
        SCOPED_TRACE(seed);
        Random random(seed);
        const TurnedFrame frame(random);
        SceneBuilder b;
        for (int k = 0; k < 3; ++k) {
            const double turn = k + random.uniform(-.2, .2), reach = random.uniform(.5, 1);
            const glm::dvec3 side = reach * frame.at(std::cos(turn), std::sin(turn), 0);
            b.quad(side - frame.n, side + frame.n, -side + frame.n, -side - frame.n);
        }
        const Scene scene = b.build();
        const Camera camera = random_view(scene, seed, kPage);
        const ScreenScene screen = page(scene, camera);
        const double line =
            std::ldexp(length_of(camera.pixel_of(frame.n) - camera.pixel_of(-frame.n)),
                       screen.subpixel_bits());
        double sum = 0;
        for (const Crossing& c : crossings_on(screen)) sum += length_of(c);
        EXPECT_NEAR(sum, 3 * line, 1e-3 * line + 30);
    }
}

// The two methods share the planes and the stretches, but not the search.
TEST(CrossingLengths, AreThoseOfThePairwiseMethod) {
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
        const Scene scene = surface_pair(0, seed).builder.build();
        const ScreenScene screen = page(scene, random_view(scene, seed, kPage));
        const auto fast = crossings_on(screen), all = crossings_on(screen, TraceMethod::pairwise);
        ASSERT_EQ(fast.size(), all.size());
        for (std::size_t i = 0; i < fast.size(); ++i) {
            EXPECT_EQ(fast[i].faces, all[i].faces);
            EXPECT_TRUE(fast[i].p == all[i].p && fast[i].q == all[i].q);
        }
    }
}

}  // namespace
}  // namespace sightline
