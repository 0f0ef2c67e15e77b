// The spatial structure leaves nothing out: what it finds is, before any rounding, what trying all
// against all finds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "drawing/pages.hpp"
#include "support/nasty.hpp"

namespace sightline {
namespace {

using namespace testing;

constexpr Resolution kPage{400, 300};

struct Totals {
    std::uint64_t edges = 0, crossings = 0, partly = 0, pieces = 0;
};

/// Edges in an order of their own: curves are found in an order that depends on the method.
std::vector<std::size_t> sorted_edges(const PageEdges& all) {
    const auto key = [&](std::size_t i) {
        const PageEdge& e = all.edges[i];
        return std::tuple(e.kind, all.faces_of(e)[0], all.faces_of(e).back(), e.p.x, e.p.y, e.p.z,
                          e.q.x, e.q.y, e.q.z);
    };
    std::vector<std::size_t> order(all.edges.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::sort(order, {}, key);
    return order;
}

bool equal_edges(const PageEdge& e, const PageEdge& f) {
    return e.p == f.p && e.q == f.q && e.kind == f.kind && e.culled == f.culled &&
           e.face_count == f.face_count;
}

bool equal_parts(std::span<const EdgeInterval> a, std::span<const EdgeInterval> b) {
    return std::ranges::equal(a, b, [](const EdgeInterval& x, const EdgeInterval& y) {
        return x.from == y.from && x.to == y.to;
    });
}

void expect_proper(std::span<const EdgeInterval> hidden) {
    for (std::size_t k = 0; k < hidden.size(); ++k) {
        ASSERT_TRUE(hidden[k].from < hidden[k].to);
        ASSERT_TRUE(k == 0 || hidden[k - 1].to < hidden[k].from);
    }
}

void expect_equal_lines(const ScreenScene& page, const Occluders& fast, const Occluders& pairwise,
                        const TraceOptions& options, Totals& totals) {
    const CutLines a = cut_lines(page, fast, options), b = cut_lines(page, pairwise, options);
    ASSERT_EQ(a.edges.edges.size(), b.edges.edges.size());
    ASSERT_EQ(a.edges.crossings, b.edges.crossings);
    const auto order_a = sorted_edges(a.edges), order_b = sorted_edges(b.edges);
    for (std::size_t i = 0; i < order_a.size(); ++i) {
        const PageEdge &e = a.edges.edges[order_a[i]], &f = b.edges.edges[order_b[i]];
        ASSERT_TRUE(equal_edges(e, f)) << "edge " << i;
        ASSERT_TRUE(std::ranges::equal(a.edges.faces_of(e), b.edges.faces_of(f))) << "edge " << i;
        const auto hidden = a.hidden_of(order_a[i]);
        ASSERT_TRUE(equal_parts(hidden, b.hidden_of(order_b[i]))) << "edge " << i;
        ASSERT_NO_FATAL_FAILURE(expect_proper(hidden));
        totals.partly +=
            !hidden.empty() && !(hidden[0].from.num == 0 && hidden[0].to.num == hidden[0].to.den);
    }
    totals.edges += order_a.size();
    totals.crossings += a.edges.crossings;
}

void sort_pieces(std::vector<BorderPiece>& pieces) {
    std::ranges::sort(pieces, {}, [](const BorderPiece& p) {
        return std::tuple(p.from.x, p.from.y, p.to.x, p.to.y, p.exact_from.x, p.exact_from.y,
                          p.exact_to.x, p.exact_to.y);
    });
}

bool near(const glm::dvec2& a, const glm::dvec2& b) {
    return std::abs(a.x - b.x) <= 0x1p-15 && std::abs(a.y - b.y) <= 0x1p-15;
}

void expect_equal_pieces(std::vector<BorderPiece>& a, std::vector<BorderPiece>& b) {
    ASSERT_EQ(a.size(), b.size());
    sort_pieces(a);
    sort_pieces(b);
    for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(a[i].from, b[i].from);
        ASSERT_EQ(a[i].to, b[i].to);
        // Which of the lines through a corner computes it may differ.
        ASSERT_TRUE(near(a[i].exact_from, b[i].exact_from));
        ASSERT_TRUE(near(a[i].exact_to, b[i].exact_to));
        // Rounding takes the nearest point of the grid.
        ASSERT_LE(std::abs(a[i].exact_from.x - a[i].from.x), 0.5 + 0x1p-15);
        ASSERT_LE(std::abs(a[i].exact_from.y - a[i].from.y), 0.5 + 0x1p-15);
    }
}

// What arrives at a point leaves it, so that loops close.
void expect_balanced(const std::vector<BorderPiece>& pieces) {
    std::vector<std::tuple<int, int, int>> ends;
    for (const BorderPiece& p : pieces) {
        ends.emplace_back(p.from.x, p.from.y, 1);
        ends.emplace_back(p.to.x, p.to.y, -1);
    }
    std::ranges::sort(ends);
    int sum = 0;
    for (std::size_t i = 0; i < ends.size(); ++i) {
        sum += std::get<2>(ends[i]);
        const bool last = i + 1 == ends.size() ||
                          std::get<0>(ends[i]) != std::get<0>(ends[i + 1]) ||
                          std::get<1>(ends[i]) != std::get<1>(ends[i + 1]);
        ASSERT_TRUE(!last || sum == 0);
    }
}

void expect_equal_regions(const Occluders& fast, const Occluders& pairwise, Totals& totals) {
    RegionFinder finder(fast, TraceMethod::fast), oracle(pairwise, TraceMethod::pairwise);
    std::vector<BorderPiece> a, b;
    ASSERT_EQ(fast.size(), pairwise.size());
    for (std::uint32_t k = 0; k < fast.size(); ++k) {
        a.clear();
        b.clear();
        const FaceFate fate = finder.find(k, a), expected = oracle.find(k, b);
        // Nothing near it, or nothing that hides it: either way all three sides are the border.
        ASSERT_TRUE(fate == expected || a.size() == 3) << "face " << k;
        ASSERT_NO_FATAL_FAILURE(expect_equal_pieces(a, b)) << "face " << k;
        ASSERT_NO_FATAL_FAILURE(expect_balanced(a)) << "face " << k;
        totals.pieces += a.size();
    }
}

void expect_equal_areas(const ScreenScene& page) {
    TraceOptions fast, pairwise;
    pairwise.method = TraceMethod::pairwise;
    const auto a = must(visible_areas(page, fast)), b = must(visible_areas(page, pairwise));
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t t = 0; t < a.size(); ++t) {
        ASSERT_EQ(a[t].projected, b[t].projected) << "triangle " << t;
        ASSERT_NEAR(a[t].visible, b[t].visible, 1e-9 * a[t].projected) << "triangle " << t;
        ASSERT_GE(a[t].visible, -1e-9 * a[t].projected) << "triangle " << t;
        // Slivers of others can be added, each at most four steps wide along its border.
        const double most = 4 * std::ldexp(256.0, -page.subpixel_bits());
        ASSERT_LE(a[t].visible, a[t].projected * (1 + 1e-9) + most) << "triangle " << t;
    }
}

void expect_equal_methods(const ScreenScene& page, const TraceOptions& options, Totals& totals) {
    const Occluders fast(page, TraceMethod::fast, 0), pairwise(page, TraceMethod::pairwise, 0);
    ASSERT_NO_FATAL_FAILURE(expect_equal_lines(page, fast, pairwise, options, totals));
    ASSERT_NO_FATAL_FAILURE(expect_equal_regions(fast, pairwise, totals));
    ASSERT_NO_FATAL_FAILURE(expect_equal_areas(page));
}

/// Triangles of all sizes in one heap.
Scene heap_scene(std::uint64_t seed) {
    Random random(seed);
    SceneBuilder b;
    for (int k = 0; k < 70; ++k) {
        const glm::dvec3 p = random.point();
        const double size = std::pow(10.0, random.uniform(-2, 0.2));
        const glm::dvec3 q = p + size * random.point(), r = p + size * random.point();
        b.triangle(p, q, r);
    }
    return b.build();
}

TEST(DrawingMethods, FastEqualsPairwiseOnHostileScenes) {
    Totals totals;
    const std::uint64_t count = amount(5000, 500, 60);
    for (std::uint64_t seed = 0; seed < count; ++seed) {
        const Scene scene = seed % 5 == 4 ? heap_scene(seed) : hostile_scene(seed);
        const Camera camera = hostile_camera(scene, seed, kPage);
        TraceOptions options;
        options.edges = seed % 2 == 0 ? kFeatureEdges : kAllEdges;
        options.crease_angle = seed % 3 == 0 ? 0 : 30;
        const Cull cull = seed % 4 == 0 ? Cull::automatic : Cull::none;
        ASSERT_NO_FATAL_FAILURE(expect_equal_methods(page(scene, camera, cull), options, totals))
            << "seed " << seed;
    }
    // The scenes are worth something.
    EXPECT_GT(totals.edges, 50 * count);
    EXPECT_GT(totals.crossings, 10 * count);
    EXPECT_GT(totals.partly, 10 * count);
    EXPECT_GT(totals.pieces, 50 * count);
}

TEST(DrawingMethods, FastEqualsPairwiseOnNastyScenes) {
    const auto simple = static_cast<std::uint32_t>(amount(1000, 150, 60));
    for (const NastyScene& nasty : nasty_scenes()) {
        // Trying all against all takes the third power of them, and an entangled scene has nearly
        // as many crossings as pairs.
        const std::uint32_t most = nasty.entangled ? 60 : simple;
        const Scene scene = beginning(nasty.scene, most);
        Totals totals;
        ASSERT_NO_FATAL_FAILURE(
            expect_equal_methods(page(scene, page_camera(scene, {64, 64})), TraceOptions{}, totals))
            << nasty.name;
        // The layers of the whole checkerboard complete each other, and inside of a sheet there are
        // no boundaries.
        EXPECT_GE(totals.edges, 16u) << nasty.name;
        EXPECT_GT(totals.pieces, 3u) << nasty.name;
    }
}

}  // namespace
}  // namespace sightline
