// The scan-line family: intervals of columns, coherence by its counts, and rows on demand.
#include <gtest/gtest.h>

#include <map>

#include "support/nasty.hpp"
#include "visibility/scan_edges.hpp"

namespace sightline {
namespace {

using namespace testing;

std::uint64_t counter(const std::vector<Counter>& counters, std::string_view name) {
    for (const Counter& c : counters)
        if (c.name == name) return c.value;
    ADD_FAILURE() << "no counter '" << name << "'";
    return 0;
}

// Every interval of every row against the predicate, over triangles of all shapes and over corners
// that lie on samples.
TEST(ScanLine, IntervalsAreWhatTheTopLeftRuleCovers) {
    Random random(3);
    const SampleUnits units(SampleGrid{{24, 20}, 2}, 8);
    std::uint64_t covered = 0;
    for (int k = 0; k < 4000; ++k) {
        const auto corner = [&](std::int32_t extent) {
            const std::int32_t v =
                static_cast<std::int32_t>(random.below(static_cast<std::uint32_t>(extent + 2000))) -
                1000;
            return k % 2 == 0 ? v : v / 64 * 64;
        };
        const ScreenPoint p{corner(24 * 256), corner(20 * 256), 0},
            q{corner(24 * 256), corner(20 * 256), 0}, r{corner(24 * 256), corner(20 * 256), 0};
        const OrientedTriangle triangle(p, q, r);
        RowTriangle rows(p, q, r, units, 0);
        for (std::int32_t j = 0; j < units.rows; ++j) {
            const bool here = !rows.empty() && rows.row() == j;
            for (std::int32_t i = 0; i < units.columns; ++i) {
                const bool inside = here && i >= rows.left() && i < rows.right();
                ASSERT_EQ(inside, covers(triangle, units.position(i), units.position(j)))
                    << k << ": " << i << ", " << j;
                covered += inside;
            }
            if (here) rows.advance(units);
        }
    }
    EXPECT_GT(covered, 100000u);
}

// The example of the notes: S1 = ABCD and S2 = EFGH overlap on lines 2 and 3 and not on line 1.
TEST(ScanLine, TwoRectanglesNeedDepthOnTheSecondLineOnly) {
    struct Recorder : Observer {
        std::map<std::uint32_t, std::uint64_t> compared;                // by line
        std::map<std::uint32_t, std::vector<std::uint32_t>> activated;  // triangles, by line
        void step(const Step& s) override {
            if (s.kind == StepKind::depths_compared) ++compared[s.y0];
            if (s.kind == StepKind::edge_activated) activated[s.y0].push_back(s.triangle);
        }
    };
    SceneBuilder b;
    // On the page of three lines: S1 begins above line 1 and widens to the right below it; S2 is
    // farther and begins where S1 comes to overlap it.
    b.triangle({-0.9, 0.9, 0.5}, {-0.9, -0.9, 0.5}, {0.5, -0.9, 0.5});
    b.triangle({0.9, 0.9, 0.0}, {-0.2, -0.9, 0.0}, {0.9, -0.9, 0.0});
    const Scene scene = b.build();
    const ScreenScene screen = must(project(scene, page_camera(scene, {30, 30}), {Cull::none, 1}));
    Recorder recorder;
    std::vector<Counter> counters;
    ResolveOptions options;
    options.observer = &recorder;
    options.counters = &counters;
    const Visibility seen = run("scanline", screen, options);
    EXPECT_EQ(count_differences(seen, run("brute", screen)), 0u);

    std::uint32_t first_overlap = 30, last_overlap = 0;
    for (std::uint32_t j = 0; j < 30; ++j) {
        // Where both surfaces are on, S1 hides a part of S2: it ends right of where S2 begins.
        std::uint32_t s1_end = 0;
        for (std::uint32_t i = 0; i < 30; ++i)
            if (seen.ids[j * 30 + i] == 0) s1_end = i + 1;
        if (s1_end > 0 && s1_end < 30 && seen.ids[j * 30 + s1_end] == 1) {
            first_overlap = std::min(first_overlap, j);
            last_overlap = std::max(last_overlap, j);
        }
    }
    ASSERT_GT(first_overlap, 2u);                // lines like line 1: one surface at a time
    ASSERT_GT(last_overlap, first_overlap + 3);  // lines like 2 and 3
    // Depths of the two are computed once, on the first line on which both are on, and never again.
    ASSERT_EQ(recorder.compared.size(), 1u);
    EXPECT_LE(recorder.compared.begin()->first, first_overlap);
    EXPECT_EQ(recorder.compared.begin()->second, 1u);
    EXPECT_EQ(counter(counters, "depth comparisons"), 1u);
    EXPECT_GE(counter(counters, "decisions kept from lines before"), last_overlap - first_overlap);
    // Each surface brings its two edges, once.
    EXPECT_EQ(counter(counters, "edges activated"), 4u);
}

TEST(ScanLine, CrossingSurfacesAreSplitOnEachLine) {
    SceneBuilder b;
    b.quad({-0.9, -0.9, -0.5}, {0.9, -0.9, 0.5}, {0.9, 0.9, 0.5}, {-0.9, 0.9, -0.5});
    b.quad({-0.9, -0.9, 0.5}, {0.9, -0.9, -0.5}, {0.9, 0.9, -0.5}, {-0.9, 0.9, 0.5});
    const Scene scene = b.build();
    const ScreenScene screen = must(project(scene, page_camera(scene, {20, 20}), {Cull::none, 1}));
    const Visibility truth = run("brute", screen);
    for (const auto& [algorithm, name] :
         {std::pair{"scanline", "crossings"}, std::pair{"spans", "spans split at crossings"}}) {
        std::vector<Counter> counters;
        ResolveOptions options;
        options.counters = &counters;
        EXPECT_EQ(count_differences(truth, run(algorithm, screen, options)), 0u);
        EXPECT_GE(counter(counters, name), 16u) << algorithm;
        EXPECT_LE(counter(counters, name), 60u) << algorithm;
    }
}

// Two large squares behind each other: 80 x 80 samples for a handful of decisions a row.
TEST(ScanLine, SpansReportTheCoherenceTheyWon) {
    SceneBuilder b;
    b.quad({-0.8, -0.8, 0.5}, {0.8, -0.8, 0.5}, {0.8, 0.8, 0.5}, {-0.8, 0.8, 0.5});
    b.quad({-0.8, -0.8, 0.0}, {0.8, -0.8, 0.0}, {0.8, 0.8, 0.0}, {-0.8, 0.8, 0.0});
    const Scene scene = b.build();
    const ScreenScene screen =
        must(project(scene, page_camera(scene, {100, 100}), {Cull::none, 1}));
    std::vector<Counter> counters;
    ResolveOptions options;
    options.counters = &counters;
    EXPECT_EQ(count_differences(run("spans", screen, options), run("brute", screen)), 0u);
    EXPECT_EQ(counter(counters, "samples in spans"), 6400u);
    EXPECT_LE(counter(counters, "span decisions"), 2 * 80u);
    EXPECT_GE(counter(counters, "span decisions"), 80u);
}

TEST(ScanLine, BandsOnDemandAreTheWholePicture) {
    const Scene scene = hostile_scene(5);
    const Camera camera = hostile_camera(scene, 5, {70, 150});
    const ScreenScene screen = must(project(scene, camera));
    std::size_t sources = 0;
    for (const Algorithm& algorithm : algorithms()) {
        if (algorithm.open_rows == nullptr) {
            EXPECT_FALSE(open_rows(algorithm, screen, {}).ok());
            continue;
        }
        ++sources;
        const Visibility whole = run(std::string(algorithm.name), screen);
        const auto rows = must(open_rows(algorithm, screen, {}));
        const std::uint32_t height = rows->band_rows();
        for (std::uint32_t band = (150 + height - 1) / height; band-- > 0;) {
            const std::uint32_t first = band * height, end = std::min(150u, first + height);
            std::vector<std::uint32_t> ids((end - first) * 70);
            std::vector<float> depth(ids.size());
            rows->resolve_band(band, ids.data(), depth.data());
            for (std::size_t i = 0; i < ids.size(); ++i) {
                ASSERT_EQ(ids[i], whole.ids[first * 70 + i]);
                ASSERT_EQ(depth[i], whole.depth[first * 70 + i]);
            }
        }
    }
    EXPECT_GE(sources, 3u);
}

}  // namespace
}  // namespace sightline
