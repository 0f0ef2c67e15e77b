// The tree itself: its shape, its order, and that threads do not change it.
#include "visibility/bsp_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "math/predicates.hpp"
#include "sightline/bsp.hpp"
#include "sightline/generate.hpp"
#include "support/models.hpp"
#include "support/nasty.hpp"
#include "visibility/bsp.hpp"

namespace sightline {
namespace {

using namespace testing;

bool same_tree(const BspTree& a, const BspTree& b) {
    const bsp::Tree &s = a.data(), &t = b.data();
    return s.nodes == t.nodes && s.planes == t.planes && s.parts == t.parts && s.cuts == t.cuts;
}

TEST(BspTree, AnyNumberOfThreadsBuildsTheSameTree) {
    const Scene scenes[] = {sphere_scene(60, 90), must(random_triangles(6000, 2)),
                            hostile_scene(11)};
    for (const Scene& scene : scenes) {
        const BspTree one = must(build_bsp(scene, {1, {}}));
        for (const int threads : {2, 8})
            EXPECT_TRUE(same_tree(one, must(build_bsp(scene, {threads, {}}))));
    }
}

TEST(BspTree, FrontToBackIsTheReverseOfBackToFront) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        const Scene scene = hostile_scene(seed);
        std::vector<std::uint8_t> moving(scene.triangles.size());
        for (std::size_t t = 0; t < moving.size(); ++t) moving[t] = seed % 2 == 1 && t % 3 == 0;
        const BspTree tree = must(build_bsp(scene, {1, moving}));
        const ScreenScene screen =
            must(project(scene, hostile_camera(scene, seed, {80, 60}), {Cull::none, 1}));
        const auto back = bsp::order_pieces(screen, tree, bsp::Order::back_to_front, 1);
        const auto front = bsp::order_pieces(screen, tree, bsp::Order::front_to_back, 1);
        ASSERT_EQ(back.pieces.size(), front.pieces.size());
        EXPECT_EQ(back.back_faces_met, front.back_faces_met);
        const std::size_t n = back.pieces.size();
        for (std::size_t k = 0; k < n; ++k) {
            const Piece &p = back.pieces[k], &q = front.pieces[n - 1 - k];
            ASSERT_EQ(p.triangle, q.triangle) << seed;
            ASSERT_EQ(p.end_cut - p.first_cut, q.end_cut - q.first_cut) << seed;
            for (std::uint32_t c = 0; c < p.end_cut - p.first_cut; ++c)
                EXPECT_EQ(back.cuts[p.first_cut + c].line, front.cuts[q.first_cut + c].line);
        }
    }
}

// The pieces of a screen triangle hold each of its samples exactly once, pruned or not.
TEST(BspTree, PiecesOfATriangleHoldEachSampleOnce) {
    constexpr Resolution kSize{20, 15};
    const auto position = [](std::uint32_t i) { return static_cast<std::int32_t>(i) * 256 + 128; };
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        const Scene scene = seed < 20 ? hostile_scene(seed) : must(random_triangles(60, 1, {20}));
        const ScreenScene screen =
            must(project(scene, hostile_camera(scene, seed, kSize), {Cull::none, 1}));
        const bsp::OrderedPieces order = bsp::order_pieces(screen, must(build_bsp(scene)));
        const auto holds = [&](const Piece& piece, std::int32_t x, std::int32_t y) {
            for (std::uint32_t k = piece.first_cut; k < piece.end_cut; ++k) {
                const bsp::PageCut& cut = order.cuts[k];
                if (y < cut.top || y > cut.bottom || !cut.holds(x, y)) return false;
            }
            return true;
        };
        for (std::uint32_t s = 0; s < kSize.width * kSize.height; ++s) {
            const std::int32_t x = position(s % kSize.width), y = position(s / kSize.width);
            std::vector<int> held(screen.triangle_count());
            for (const Piece& piece : order.pieces) held[piece.triangle] += holds(piece, x, y);
            for (std::uint32_t t = 0; t < screen.triangle_count(); ++t) {
                if (!screen.drawable(t)) continue;
                const Corners c = screen.corners(t);
                const OrientedTriangle o(screen.point(c.x), screen.point(c.y), screen.point(c.z));
                if (covers(o, x, y)) {
                    ASSERT_EQ(held[t], 1) << "seed " << seed << ", triangle " << t;
                }
            }
        }
    }
}

TEST(BspTree, AnObserverSeesTheNodesOnTheWay) {
    struct Recorder : Observer {
        std::uint64_t nodes = 0, pieces = 0;
        void step(const Step& step) override {
            nodes += step.kind == StepKind::node_entered;
            pieces += step.kind == StepKind::polygon_painted;
        }
    };
    const Scene scene = hostile_scene(7);
    const ScreenScene screen = must(project(scene, hostile_camera(scene, 7, {64, 48})));
    Recorder recorder;
    ResolveOptions options;
    options.observer = &recorder;
    const Visibility watched = run("bsp", screen, options);
    EXPECT_EQ(count_differences(watched, run("bsp", screen)), 0u);
    EXPECT_EQ(recorder.nodes, must(build_bsp(scene)).stats().nodes);
    EXPECT_GE(recorder.pieces, scene.triangles.size() / 2);
}

TEST(BspTree, DegenerateTrianglesAndEmptyScenesAreTaken) {
    SceneBuilder b;
    for (int k = 0; k < 300; ++k) b.triangle({0, 0, 0}, {1, 0, 0}, {1.0 * k / 300, 0, 0});
    b.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const BspTree tree = must(build_bsp(b.build()));
    EXPECT_EQ(tree.stats().triangles, 1u);
    const Scene nothing = SceneBuilder().build();
    EXPECT_EQ(must(build_bsp(nothing)).stats().nodes, 0u);
    const ScreenScene screen =
        must(project(nothing, must(make_camera({}, nothing.bounds, {16, 16}))));
    const Visibility seen = run("bsp", screen);
    EXPECT_TRUE(std::ranges::all_of(seen.ids, [](std::uint32_t id) { return id == kNone; }));
}

// Planes through one line with all else on one side of each: a chain without end for recursion.
TEST(BspTree, LongChainsNeedNoStack) {
    SceneBuilder b;
    constexpr int kFaces = 3000;
    for (int k = 0; k < kFaces; ++k) {
        // On a cone, tangent planes all through its apex.
        const double t = 6.283185307179586 * k / kFaces, u = 6.283185307179586 * (k + 1) / kFaces;
        b.triangle({0, 0, 0}, {std::cos(t), std::sin(t), 1}, {std::cos(u), std::sin(u), 1});
    }
    const Scene scene = b.build();
    const BspTree tree = must(build_bsp(scene));
    EXPECT_LT(tree.stats().pieces, std::uint64_t{3 * kFaces});
}

TEST(BspTree, MarksOfWhatMovesMustBeOneATriangle) {
    const Scene scene = SceneBuilder().box({0, 0, 0}, {1, 1, 1}).build();
    const std::vector<std::uint8_t> marks(5);
    const Result<BspTree> tree = build_bsp(scene, {0, marks});
    ASSERT_FALSE(tree.ok());
    EXPECT_EQ(tree.error().kind, ErrorKind::bad_option);
}

}  // namespace
}  // namespace sightline
