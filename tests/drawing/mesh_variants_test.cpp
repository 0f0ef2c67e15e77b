// However a solid is written down, its edges, areas and pictures are those of the clean one.
#include "support/mesh_variants.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>

#include "drawing/edges.hpp"
#include "drawing/pages.hpp"

namespace sightline {
namespace {

using namespace testing;

constexpr Resolution kPage{200, 200};

struct Written {
    Variant variant;
    Solid solid;
    Scene scene;
};

Written write(const Solid& clean, Variant variant, Random& random) {
    Written written{variant, varied(clean, variant, random), {}};
    written.scene = scene_of(written.solid);
    finish_scene(written.scene);
    return written;
}

/// From anywhere around, in parallel or in perspective.
Camera camera_around(const Scene& scene, Random& random, bool parallel) {
    CameraOptions options;
    options.direction = random.point() + glm::dvec3(0.01, 0.02, 0.03);
    options.up = glm::dvec3(0.2, 0.9, 0.4) + random.point(0.2);
    options.projection = parallel ? Projection::orthographic : Projection::perspective;
    return must(make_camera(options, scene.bounds, kPage));
}

std::vector<Solid> solids() {
    return {box_solid({-1, -0.5, -0.7}, {1.2, 0.6, 0.4}), star_solid(5, 0.4, 0.6),
            torus_solid(2, 0.7, 14, 9)};
}

std::vector<FaceArea> by_origin(const Written& written, const Camera& camera, Cull cull,
                                std::size_t faces) {
    std::vector<FaceArea> sums(faces);
    const std::vector<FaceArea> areas = must(visible_areas(page(written.scene, camera, cull), {}));
    for (std::uint32_t t = 0; t < areas.size(); ++t) {
        FaceArea& sum = sums[written.solid[written.scene.triangle_polygon[t]].origin];
        sum.projected += areas[t].projected;
        sum.visible += areas[t].visible;
    }
    return sums;
}

TEST(MeshVariants, AreClosedAsTheCleanSolidIs) {
    Random random(1);
    for (const Solid& clean : solids()) {
        for (const Variant variant : kVariants) {
            const Written written = write(clean, variant, random);
            // Snapped to a grid, T-junctions open cracks: those are never closed.
            EXPECT_EQ(written.scene.objects[0].closed, variant != Variant::t_junctions)
                << name_of(variant);
            if (variant != Variant::perturbed_twice) {
                EXPECT_EQ(written.scene.objects[0].two_sided, variant == Variant::both_sides)
                    << name_of(variant);
            }
            EXPECT_EQ(written.scene.counts.equal_faces, variant == Variant::doubled ||
                                                                variant == Variant::both_sides ||
                                                                variant == Variant::perturbed_twice
                                                            ? clean.size()
                                                            : 0u)
                << name_of(variant);
            if (variant != Variant::t_junctions) {
                EXPECT_EQ(written.scene.counts.joined_positions > 0,
                          variant == Variant::perturbed || variant == Variant::perturbed_twice)
                    << name_of(variant);
            }
            EXPECT_EQ(written.scene.counts.degenerate_triangles, 0u);
        }
    }
}

/// Half of the sum of its faces' projections: right for convex solids in parallel views.
double shadow_of(const Solid& convex, const glm::dvec3& gaze) {
    double sum = 0;
    for (const PlainFace& face : convex) {
        glm::dvec3 normal(0);
        for (std::size_t k = 1; k + 1 < face.corners.size(); ++k)
            normal += 0.5 * glm::cross(face.corners[k] - face.corners[0],
                                       face.corners[k + 1] - face.corners[0]);
        sum += 0.5 * std::abs(glm::dot(normal, gaze));
    }
    return sum;
}

TEST(MeshVariants, BoxesHaveTheAreaOfTheFormula) {
    Random random(2);
    for (std::uint64_t round = 0; round < amount(200, 20, 4); ++round) {
        const glm::dvec3 lo = random.point(), hi = lo + 0.2 + random.point(0.1) + 0.5;
        const Solid clean = box_solid(lo, hi);
        for (const Variant variant : kVariants) {
            const Written written = write(clean, variant, random);
            const Camera camera = camera_around(written.scene, random, true);
            const double pixels = camera.pixels_per_unit() * camera.pixels_per_unit();
            const double expected = pixels * shadow_of(clean, camera.gaze());
            for (const Cull cull : {Cull::automatic, Cull::none, Cull::back}) {
                FaceArea all;
                for (const FaceArea& area : by_origin(written, camera, cull, clean.size())) {
                    all.projected += area.projected;
                    all.visible += area.visible;
                }
                EXPECT_NEAR(all.visible, expected, 2e-5 * expected) << name_of(variant);
                EXPECT_NEAR(all.projected, 2 * expected, 4e-5 * expected) << name_of(variant);
            }
        }
    }
}

TEST(MeshVariants, EachFaceHasTheAreasOfTheCleanOne) {
    Random random(3);
    for (const Solid& clean : solids()) {
        const Written first = write(clean, Variant::clean, random);
        for (std::uint64_t round = 0; round < amount(40, 4, 1); ++round) {
            const Camera camera = camera_around(first.scene, random, round % 2 == 0);
            const auto expected = by_origin(first, camera, Cull::automatic, clean.size());
            for (const Variant variant : kVariants) {
                const Written written = write(clean, variant, random);
                const auto areas = by_origin(written, camera, Cull::automatic, clean.size());
                for (std::size_t f = 0; f < areas.size(); ++f) {
                    EXPECT_NEAR(areas[f].visible, expected[f].visible, 0.02)
                        << name_of(variant) << ", face " << f;
                    EXPECT_NEAR(areas[f].projected, expected[f].projected, 0.02)
                        << name_of(variant) << ", face " << f;
                }
            }
        }
    }
}

TEST(MeshVariants, HaveTheLinesOfTheCleanSolid) {
    Random random(4);
    for (const Solid& clean : solids()) {
        const Written first = write(clean, Variant::clean, random);
        for (std::uint64_t round = 0; round < amount(40, 4, 1); ++round) {
            const Camera camera = camera_around(first.scene, random, round % 2 == 0);
            const Drawing expected = must(trace(page(first.scene, camera), with_hidden()));
            for (const Variant variant : kVariants) {
                const Written written = write(clean, variant, random);
                const Drawing drawing = must(trace(page(written.scene, camera), with_hidden()));
                for (const EdgeKind kind :
                     {EdgeKind::silhouette, EdgeKind::boundary, EdgeKind::border, EdgeKind::crease,
                      EdgeKind::intersection}) {
                    for (const bool visible : {true, false}) {
                        EXPECT_NEAR(length_of(drawing, {kind}, visible),
                                    length_of(expected, {kind}, visible), 0.2)
                            << name_of(variant) << ", " << name_of(kind) << ", round " << round;
                    }
                }
            }
        }
    }
}

/// What is seen at each sample: the face of the clean solid.
std::vector<std::uint32_t> picture_of(const Written& written, const Camera& camera, Cull cull,
                                      std::vector<std::uint32_t>& ids) {
    const ScreenScene screen = must(project(written.scene, camera, {cull}));
    const Visibility seen = run("brute", screen);
    ids.assign(seen.ids.begin(), seen.ids.end());
    std::vector<std::uint32_t> origins;
    for (const std::uint32_t id : seen.ids) {
        origins.push_back(id == kNone ? kNone
                                      : written.solid[written.scene.triangle_polygon[id]].origin);
    }
    return origins;
}

TEST(MeshVariants, ShowTheSameWhateverIsCulled) {
    Random random(5);
    for (const Solid& clean : solids()) {
        const Written first = write(clean, Variant::clean, random);
        const Camera camera = camera_around(first.scene, random, false);
        std::vector<std::uint32_t> ids, ids_of_all;
        const auto expected = picture_of(first, camera, Cull::none, ids);
        for (const Variant variant : {Variant::doubled, Variant::both_sides}) {
            const Written written = write(clean, variant, random);
            EXPECT_EQ(picture_of(written, camera, Cull::none, ids_of_all), expected);
            EXPECT_EQ(picture_of(written, camera, Cull::automatic, ids), expected);
            EXPECT_EQ(ids, ids_of_all) << "of equal faces the lowest is seen";
            EXPECT_EQ(picture_of(written, camera, Cull::back, ids), expected);
        }
    }
}

// A sheet with one face for each side: either is there when the other is culled.
TEST(MeshVariants, ASheetOfTwoSidesIsSeenFromBoth) {
    Random random(6);
    Solid clean = {{{{-1, -1, 0}, {1, -1, 0.2}, {1, 1, 0.1}}, 0},
                   {{{-1, -1, 0}, {1, 1, 0.1}, {-1, 1, -0.3}}, 1}};
    const Written written = write(clean, Variant::both_sides, random);
    EXPECT_FALSE(written.scene.objects[0].closed);
    EXPECT_TRUE(written.scene.objects[0].two_sided);
    const Written one = write(clean, Variant::clean, random);
    for (int round = 0; round < 10; ++round) {
        const Camera camera = camera_around(one.scene, random, round % 2 == 0);
        std::vector<std::uint32_t> ids;
        const auto expected = picture_of(one, camera, Cull::none, ids);
        const Drawing plain = must(trace(page(one.scene, camera), with_hidden()));
        const auto areas = by_origin(one, camera, Cull::none, 2);
        for (const Cull cull : {Cull::automatic, Cull::none, Cull::back, Cull::front}) {
            EXPECT_EQ(picture_of(written, camera, cull, ids), expected);
            const Drawing drawing = must(trace(page(written.scene, camera, cull), with_hidden()));
            for (const EdgeKind kind : {EdgeKind::silhouette, EdgeKind::boundary, EdgeKind::crease})
                EXPECT_NEAR(length_of(drawing, {kind}, true), length_of(plain, {kind}, true), 1e-9);
            EXPECT_EQ(length_of(drawing, kFeatureEdges, false), 0);
            const auto own = by_origin(written, camera, cull, 2);
            for (std::size_t f = 0; f < 2; ++f) {
                EXPECT_NEAR(own[f].projected, areas[f].projected, 1e-9);
                EXPECT_NEAR(own[f].visible, areas[f].visible, 1e-9);
            }
        }
    }
}

// -- sheets whose faces do not share their vertices
// ------------------------------------------------

struct Cells {
    int x0, y0, x1, y1;
};

/// Length of the edges of rectangles of cells behind which no other one is.
int rim_of(const std::vector<Cells>& all) {
    std::map<std::pair<int, int>, int> covered;
    for (const Cells& r : all)
        for (int x = r.x0; x < r.x1; ++x)
            for (int y = r.y0; y < r.y1; ++y) ++covered[{x, y}];
    const auto is_bare = [&](int x, int y) { return covered.count({x, y}) == 0 ? 1 : 0; };
    int sum = 0;
    for (const Cells& r : all) {
        for (int x = r.x0; x < r.x1; ++x) sum += is_bare(x, r.y0 - 1) + is_bare(x, r.y1);
        for (int y = r.y0; y < r.y1; ++y) sum += is_bare(r.x0 - 1, y) + is_bare(r.x1, y);
    }
    return sum;
}

/// Rectangles that do not overlap and of which no two have an edge in common.
std::vector<Cells> random_cells(Random& random, std::uint32_t count, int size) {
    std::map<std::vector<int>, int> edges;
    std::vector<Cells> all;
    for (int tries = 0; tries < 2000 && all.size() < count; ++tries) {
        const auto place = [&] {
            return static_cast<int>(random.below(static_cast<std::uint32_t>(size)));
        };
        Cells r{place(), place(), 0, 0};
        r.x1 = r.x0 + 1 + static_cast<int>(random.below(6));
        r.y1 = r.y0 + 1 + static_cast<int>(random.below(6));
        const std::vector<std::vector<int>> own = {{r.x0, r.y0, r.x1, r.y0},
                                                   {r.x0, r.y1, r.x1, r.y1},
                                                   {r.x0, r.y0, r.x0, r.y1},
                                                   {r.x1, r.y0, r.x1, r.y1}};
        if (std::ranges::any_of(own, [&](const auto& edge) { return edges.contains(edge); }))
            continue;
        const auto overlaps = [&](const Cells& s) {
            return r.x0 < s.x1 && s.x0 < r.x1 && r.y0 < s.y1 && s.y0 < r.y1;
        };
        if (std::ranges::any_of(all, overlaps)) continue;
        for (const auto& edge : own) edges[edge] = 1;
        all.push_back(r);
    }
    return all;
}

TEST(MeshVariants, BoundariesAreKeptWhereTheSheetEnds) {
    Random random(7);
    for (std::uint64_t round = 0; round < amount(300, 24, 6); ++round) {
        // Few, or so many that they are searched through a grid.
        const std::uint32_t count = round % 3 == 0 ? 80 : 2 + random.below(10);
        const std::vector<Cells> cells = random_cells(random, count, round % 3 == 0 ? 40 : 10);
        const glm::dvec3 u = glm::normalize(random.point() + glm::dvec3(0.01, 0, 0));
        const glm::dvec3 n = glm::normalize(glm::cross(u, random.point() + glm::dvec3(0, 0.01, 0)));
        const glm::dvec3 v = glm::cross(n, u), origin = random.point(5);
        const auto at = [&](int x, int y) { return origin + 0.1 * x * u + 0.1 * y * v; };
        SceneBuilder b;
        for (const Cells& r : cells)
            b.quad(at(r.x0, r.y0), at(r.x1, r.y0), at(r.x1, r.y1), at(r.x0, r.y1));
        const Scene scene = b.build();
        CameraOptions options;
        options.direction = -n;
        options.up = v;
        options.projection = Projection::orthographic;
        const Camera camera = must(make_camera(options, scene.bounds, kPage));
        const double unit = 0.1 * camera.pixels_per_unit();
        const Drawing drawing = must(trace(page(scene, camera), with_hidden(kAllEdges)));
        EXPECT_NEAR(length_of(drawing, {EdgeKind::boundary}, true), unit * rim_of(cells), 0.05)
            << "round " << round;
        double whole = 0;
        for (const Cells& r : cells) whole += 2 * (r.x1 - r.x0 + r.y1 - r.y0);
        EXPECT_NEAR(length_of(drawing, kAllEdges, true), unit * whole, 0.05)
            << "as mesh all are drawn, round " << round;
        EXPECT_EQ(length_of(drawing, kAllEdges, false), 0);
    }
}

TEST(MeshVariants, TheSheetOfAnotherObjectIsAnotherOne) {
    SceneBuilder b;
    b.quad({-20, -10, 0}, {20, -10, 0}, {20, 0, 0}, {-20, 0, 0});
    b.quad({-20, 0, 0}, {0, 0, 0}, {0, 10, 0}, {-20, 10, 0});
    b.quad({0, 0, 0}, {20, 0, 0}, {20, 10, 0}, {0, 10, 0});
    Scene scene = b.build();
    const Camera camera = pixel_camera({100, 100});
    const auto boundary = [&] {
        return length_of(must(trace(page(scene, camera), {})), {EdgeKind::boundary}, true);
    };
    EXPECT_EQ(boundary(), 2 * (40 + 20));
    Object second = scene.objects[0];
    scene.objects[0].triangle_count = 4;
    scene.objects[0].polygon_count = 2;
    second.first_triangle = 4;
    second.triangle_count = 2;
    second.first_polygon = 2;
    second.polygon_count = 1;
    scene.objects.push_back(second);
    finish_scene(scene);
    EXPECT_EQ(boundary(), 2 * (40 + 20) + 2 * 20);  // besides, 10 are a border of both
}

}  // namespace
}  // namespace sightline
