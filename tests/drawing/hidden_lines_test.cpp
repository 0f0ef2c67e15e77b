// Which parts of lines are visible, in cases that can be told by hand. The page is 100 x 100 pixels
// and the point (x, y) of the scene stands at pixel (50 + x, 50 - y).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

#include "drawing/pages.hpp"
#include "support/models.hpp"

namespace sightline {
namespace {

using namespace testing;

constexpr Resolution kPage{100, 100};

glm::dvec2 at(double x, double y) { return {50 + x, 50 - y}; }

Drawing drawn(const SceneBuilder& b, const TraceOptions& options = with_hidden()) {
    const Scene scene = b.build();
    return must(trace(page(scene, pixel_camera(kPage)), options));
}

TEST(HiddenLines, PartsBehindASquareAreHidden) {
    SceneBuilder b;
    add_square(b, {-10, -10}, {10, 10}, 5);
    add_square(b, {-30, -5}, {40, 30}, -5);
    const Drawing d = drawn(b);
    EXPECT_EQ(length_along(d, at(-30, -5), at(40, -5), true), 50);
    EXPECT_EQ(length_along(d, at(-30, -5), at(40, -5), false), 20);
    EXPECT_EQ(length_along(d, at(-30, 30), at(40, 30), true), 70);
    EXPECT_EQ(length_along(d, at(-10, 10), at(10, 10), true), 20);
    EXPECT_EQ(d.counts.visible_length, length_of(d, kFeatureEdges, true));
    EXPECT_EQ(d.counts.hidden_length, length_of(d, kFeatureEdges, false));
    EXPECT_EQ(d.counts.hidden_segments, 1u);
}

TEST(HiddenLines, HiddenPartsAreKeptOnDemandOnly) {
    SceneBuilder b;
    add_square(b, {-10, -10}, {10, 10}, 5);
    add_square(b, {-30, -5}, {40, 30}, -5);
    const Drawing all = drawn(b), visible = drawn(b, {});
    EXPECT_EQ(visible.counts.hidden_length, all.counts.hidden_length);
    EXPECT_EQ(length_of(visible, kFeatureEdges, false), 0);
    EXPECT_EQ(length_of(visible, kFeatureEdges, true), length_of(all, kFeatureEdges, true));
}

TEST(HiddenLines, NoGapBehindTheSeamOfTwoFaces) {
    SceneBuilder b;
    add_square(b, {-30, -30}, {0, 30}, 10);
    add_square(b, {0, -30}, {30, 30}, 10);
    add_square(b, {0, -20}, {15, 20}, -10);
    // Behind the diagonal of a square.
    b.triangle({-25, -25, -5}, {-5, -5, -5}, {-25, -10, -5});
    const Drawing d = drawn(b);
    EXPECT_EQ(length_along(d, at(0, -20), at(0, 20), true), 0);
    EXPECT_EQ(length_along(d, at(0, -20), at(0, 20), false), 40);
    EXPECT_EQ(length_along(d, at(-25, -25), at(-5, -5), true), 0);
    EXPECT_EQ(d.counts.hidden_segments, 7u);  // one an edge
}

// The same where both occluders slope and meet only along their seam, and where corners meet.
TEST(HiddenLines, NoGapBehindARidgeOrACorner) {
    SceneBuilder b;
    b.quad({-30, -30, 0}, {0, -30, 10}, {0, 30, 10}, {-30, 30, 0});
    b.quad({0, -30, 10}, {30, -30, 0}, {30, 30, 0}, {0, 30, 10});
    add_square(b, {0, -20}, {15, 20}, -10);
    const Drawing ridge = drawn(b);
    EXPECT_EQ(length_along(ridge, at(0, -20), at(0, 20), false), 40);

    SceneBuilder fan;
    for (const double x : {-30.0, 0.0})
        for (const double y : {-30.0, 0.0}) add_square(fan, {x, y}, {x + 30, y + 30}, 10);
    fan.triangle({-20, -20, -5}, {20, 20, -5}, {-20, 10, -5});
    const Drawing corner = drawn(fan);
    EXPECT_EQ(corner.counts.hidden_segments, 3u);
    EXPECT_EQ(length_along(corner, at(-20, -20), at(20, 20), true), 0);
}

TEST(HiddenLines, AlongTheRimOfAFaceInFrontTheyAreVisible) {
    for (const double side : {-1.0, 1.0}) {
        SceneBuilder b;
        add_square(b, {-30, -30}, {0, 30}, 10);
        add_square(b, {std::min(0.0, 20 * side), -20}, {std::max(0.0, 20 * side), 20}, -10);
        const Drawing d = drawn(b);
        EXPECT_EQ(length_along(d, at(0, -30), at(0, 30), true), 60 + 40);
        EXPECT_EQ(length_along(d, at(0, -30), at(0, 30), false), 0);
    }
}

// Where the rim of a nearer face ends, what is behind its corner goes on.
TEST(HiddenLines, ALineAlongARimIsHiddenWhereAnotherFaceHasTheOtherSide) {
    SceneBuilder b;
    add_square(b, {-30, -30}, {0, 30}, 10);
    add_square(b, {0, -5}, {30, 5}, 12);
    add_square(b, {0, -20}, {15, 20}, -10);
    const Drawing d = drawn(b);
    EXPECT_EQ(length_along(d, at(0, -20), at(0, 20), false), 10);
    EXPECT_EQ(length_along(d, at(0, -30), at(0, 30), true), 60 + 30 + 10);
}

TEST(HiddenLines, FacesOfEqualDepthDoNotHide) {
    SceneBuilder b;
    add_square(b, {-30, -30}, {30, 30}, 0);
    add_square(b, {-10, -10}, {20, 20}, 0);
    const Drawing d = drawn(b);
    EXPECT_EQ(length_of(d, kFeatureEdges, true), 240 + 120);
    EXPECT_EQ(d.counts.hidden_segments, 0u);
}

/// From all around, in perspective.
Camera around(const Scene& scene, int k, Projection projection = Projection::perspective) {
    CameraOptions options;
    const double turn = 0.1 + 0.77 * k;
    options.direction = glm::dvec3(std::cos(turn), -0.5, std::sin(turn));
    options.projection = projection;
    return must(make_camera(options, scene.bounds, {400, 300}));
}

double distance(const Camera& camera, const glm::dvec3& p, const glm::dvec3& q) {
    return glm::length(camera.pixel_of(p) - camera.pixel_of(q));
}

TEST(HiddenLines, TheBorderOfADecalIsVisibleFromEverywhere) {
    SceneBuilder b;
    const glm::dvec3 u = glm::normalize(glm::dvec3(1, 0.3, 0.2));
    const glm::dvec3 v = glm::normalize(glm::cross(u, glm::dvec3(0.1, 0.2, 1)));
    const auto at = [&](double s, double t) { return glm::dvec3(0.1, 0.2, 0.3) + s * u + t * v; };
    b.quad(at(-3, -2), at(3, -2), at(3, 2), at(-3, 2));
    b.quad(at(-1, -1), at(1.5, -1), at(1.3, 1.1), at(-1, 1));
    const Scene scene = b.build();
    for (int k = 0; k < 24; ++k) {
        const Camera camera = around(scene, k);
        const Drawing d = must(trace(page(scene, camera), with_hidden()));
        EXPECT_EQ(d.counts.hidden_segments, 0u) << k;
        double expected = 0;
        for (const std::uint32_t quad : {0u, 4u})
            for (std::uint32_t i = 0; i < 4; ++i)
                expected += distance(camera, scene.positions[quad + i],
                                     scene.positions[quad + (i + 1) % 4]);
        EXPECT_NEAR(length_of(d, kFeatureEdges, true), expected, 1e-2) << k;
    }
}

struct BoxEdge {
    glm::dvec3 p, q;
    bool visible;
};

/// The edges of the box that are drawn, and which of them are seen: those of its fronts.
std::vector<BoxEdge> box_edges(const Camera& camera, glm::dvec3 lo, glm::dvec3 hi, bool bottom) {
    const auto front = [&](int axis, int high) {
        glm::dvec3 normal(0), point = high != 0 ? hi : lo;
        normal[axis] = high != 0 ? 1 : -1;
        return glm::dot(camera.view_vector(point), normal) < 0;
    };
    std::vector<BoxEdge> edges;
    for (int axis = 0; axis < 3; ++axis)
        for (int k = 0; k < 4; ++k) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            glm::dvec3 p = lo;
            if ((k & 1) != 0) p[u] = hi[u];
            if ((k & 2) != 0) p[v] = hi[v];
            glm::dvec3 q = p;
            q[axis] = hi[axis];
            // Without a bottom only the wall shows its lower edge.
            const bool at_u = front(u, k & 1) && (bottom || u != 1 || (k & 1) != 0);
            const bool at_v = front(v, k >> 1) && (bottom || v != 1 || (k & 2) != 0);
            edges.push_back({p, q, at_u || at_v});
        }
    return edges;
}

void expect_box(const Drawing& d, const Camera& camera, const std::vector<BoxEdge>& edges) {
    for (const BoxEdge& e : edges) {
        const glm::dvec2 p = camera.pixel_of(e.p), q = camera.pixel_of(e.q);
        const double length = glm::length(p - q);
        EXPECT_NEAR(length_along(d, p, q, true), e.visible ? length : 0, 1e-2);
        EXPECT_NEAR(length_along(d, p, q, false), e.visible ? 0 : length, 1e-2);
    }
}

TEST(HiddenLines, OfABoxThoseOfItsFrontsAreVisibleInAllProjections) {
    SceneBuilder b;
    const glm::dvec3 lo(-1, -0.7, -0.5), hi(1, 0.7, 0.9);
    b.box(lo, hi);
    const Scene scene = b.build();
    for (const Projection projection : {Projection::perspective, Projection::orthographic,
                                        Projection::cavalier, Projection::cabinet})
        for (int k = 0; k < 12; ++k)
            for (const Cull cull : {Cull::none, Cull::automatic}) {
                const Camera camera = around(scene, k, projection);
                const Drawing d = must(trace(page(scene, camera, cull), with_hidden()));
                SCOPED_TRACE(std::string(name_of(projection)) + " " + std::to_string(k));
                expect_box(d, camera, box_edges(camera, lo, hi, true));
                EXPECT_EQ(d.counts.edges, 12u);
                EXPECT_EQ(d.counts.visible_segments + d.counts.hidden_segments, 12u);
            }
}

// Its lower edges lie in the plane: they are seen where the walls above them are, at full length,
// and no curve is found there besides.
TEST(HiddenLines, ABoxStandsOnAPlane) {
    const glm::dvec3 lo(-1, 0, -0.5), hi(1, 1.5, 0.7);
    for (const bool bottom : {true, false}) {
        SceneBuilder b;
        b.quad({-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3});
        b.box(lo, hi);
        if (!bottom) {
            // The third quad of box().
            b.scene.triangles.erase(b.scene.triangles.begin() + 6, b.scene.triangles.begin() + 8);
            b.scene.triangle_polygon.resize(b.scene.triangles.size());
            for (std::uint32_t t = 0; t < b.size(); ++t) b.scene.triangle_polygon[t] = t / 2;
            b.scene.polygon_edges.resize(b.size());
            b.scene.objects[0].triangle_count = static_cast<std::uint32_t>(b.size());
            b.scene.objects[0].polygon_count = 6;
        }
        const Scene scene = b.build();
        for (int k = 0; k < 24; ++k) {
            const Camera camera = around(scene, k);
            const Drawing d = must(trace(page(scene, camera), with_hidden()));
            SCOPED_TRACE(std::string(bottom ? "closed " : "open ") + std::to_string(k));
            EXPECT_EQ(d.counts.intersections, 0u);
            expect_box(d, camera, box_edges(camera, lo, hi, bottom));
        }
    }
}

/// Three bars, each over the next one at one end.
Scene cyclic_bars(double width) {
    SceneBuilder b;
    std::array<glm::dvec2, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
        const double turn = 0.3 + 2 * std::acos(-1.0) * static_cast<double>(k) / 3;
        corner[k] = 20.0 * glm::dvec2(std::cos(turn), std::sin(turn));
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 along = glm::normalize(corner[(k + 1) % 3] - corner[k]);
        const glm::dvec2 across = 0.5 * width * glm::dvec2(-along.y, along.x);
        const glm::dvec2 p = corner[k] - 8.0 * along, q = corner[(k + 1) % 3] + 8.0 * along;
        b.quad({p - across, -10}, {q - across, 10}, {q + across, 10}, {p + across, -10});
    }
    return b.build();
}

TEST(HiddenLines, FacesMayHideEachOtherInACircle) {
    const double width = 3, sine = std::sqrt(0.75);
    const Scene scene = cyclic_bars(width);
    const ScreenScene screen = page(scene, pixel_camera(kPage));
    const Drawing d = must(trace(screen, with_hidden()));
    EXPECT_EQ(d.counts.intersections, 0u);
    EXPECT_EQ(d.counts.hidden_segments, 6u);
    EXPECT_NEAR(d.counts.hidden_length, 6 * width / sine, 1e-3);
    double visible = 0, projected = 0;
    for (const FaceArea& area : must(visible_areas(screen, {}))) {
        visible += area.visible;
        projected += area.projected;
    }
    EXPECT_NEAR(projected - visible, 3 * width * width / sine, 1e-3);
}

TEST(HiddenLines, EdgesSeenEndOnAreDropped) {
    SceneBuilder b;
    b.box({-20, -20, -20}, {20, 20, 20});
    const Drawing d = drawn(b);
    EXPECT_EQ(d.counts.edges, 8u);
    for (std::size_t i = 0; i < d.lines.size(); ++i) EXPECT_NE(d.lines.from[i], d.lines.to[i]);
    EXPECT_EQ(length_along(d, at(-20, -20), at(20, -20), true),
              80);  // those behind run along a rim
}

/// Whether the visible lines of one drawing are in the other one, but for a few steps of the page:
/// beside the contour, snapping may show some of a back.
void expect_contained(const Drawing& part, const Drawing& whole) {
    for (std::size_t i = 0; i < part.lines.size(); ++i) {
        const glm::dvec2 &p = part.lines.from[i], &q = part.lines.to[i];
        if (part.lines.visible[i] == 0 || glm::length(q - p) < 0.01) continue;
        EXPECT_GT(length_along(whole, p, q, true), glm::length(q - p) - 2e-3) << i;
    }
}

void expect_same_without_backs(const Scene& scene, EdgeKinds kinds) {
    for (int k = 0; k < 6; ++k) {
        const Camera camera = around(scene, k);
        const ScreenScene all = page(scene, camera), fronts = page(scene, camera, Cull::automatic);
        ASSERT_GT(fronts.counts().culled, 0u);
        const Drawing a = must(trace(all, with_hidden(kinds)));
        const Drawing b = must(trace(fronts, with_hidden(kinds)));
        EXPECT_NEAR(a.counts.visible_length, b.counts.visible_length, 1e-2) << k;
        EXPECT_NEAR(a.counts.hidden_length, b.counts.hidden_length, 1e-2) << k;
        expect_contained(a, b);
        expect_contained(b, a);
    }
}

TEST(HiddenLines, WithoutItsBackAClosedObjectLooksTheSame) {
    expect_same_without_backs(sphere_scene(12, 20), kAllEdges);
    SceneBuilder b;
    b.box({-1, -0.7, -0.5}, {1, 0.7, 0.9});
    expect_same_without_backs(b.build(), kAllEdges);
}

TEST(HiddenLines, WithoutItsBackAModelLooksTheSame) {
    const std::optional<Scene> scene = real_model("fandisk.obj");
    if (!scene) GTEST_SKIP() << "fandisk.obj is not there; set SIGHTLINE_MODELS";
    expect_same_without_backs(*scene, kFeatureEdges);
}

}  // namespace
}  // namespace sightline
