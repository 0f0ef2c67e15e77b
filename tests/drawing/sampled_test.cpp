// Regions against the definition: in any point of the page, the region that holds it is that of the
// polygon that the canonical answer names.
#include "drawing/sampled.hpp"

#include <gtest/gtest.h>

#include <iostream>

#include "drawing/pages.hpp"
#include "drawing/surfaces.hpp"
#include "support/models.hpp"
#include "support/nasty.hpp"

namespace sightline {
namespace {

using namespace testing;

bool is_full() { return std::getenv("SIGHTLINE_FULL") != nullptr; }

struct Score {
    std::uint64_t samples = 0, covered = 0, skipped = 0, wrong = 0;
    std::uint64_t slivers = 0;  ///< wrong, and within two units of what is thinner than a region is
    std::string first;

    void expect_good(const std::string& what) const {
        std::cout << what << ": " << samples << " samples, " << covered << " covered, " << skipped
                  << " on edges, " << slivers << " in slivers\n";
        EXPECT_EQ(wrong, 0u) << what << ": " << first;
        EXPECT_LT(slivers, 10 + samples / 500) << what;
        EXPECT_LT(skipped, samples / 2) << what;
    }
};

TraceOptions regions_only() {
    TraceOptions options;
    options.edges = {};
    options.fill = FillStyle::flat;
    return options;
}

/// Anywhere, and half of them beside a corner of a region, where mistakes would be.
glm::ivec2 sample_of(const ScreenScene& page, const Drawing& drawing, Random& random) {
    const int bits = page.subpixel_bits();
    const std::uint32_t width = page.resolution().width << bits;
    const std::uint32_t height = page.resolution().height << bits;
    glm::ivec2 p(random.below(width), random.below(height));
    if (drawing.regions.points.empty() || random.chance(0.5)) return p;
    const auto n = static_cast<std::uint32_t>(drawing.regions.points.size());
    const double reach = std::pow(10.0, random.uniform(0.5, 4));
    p = glm::ivec2(std::ldexp(1.0, bits) * drawing.regions.points[random.below(n)]) +
        glm::ivec2(random.uniform(-reach, reach), random.uniform(-reach, reach));
    return glm::clamp(p, glm::ivec2(0), glm::ivec2(width - 1, height - 1));
}

void judge(const ScreenScene& page, const Drawing& drawing, std::uint64_t seed, int samples,
           Score& score) {
    const CanonicalAnswer canonical(page);
    const RegionAnswer regions(drawing, page.subpixel_bits(), 1.0);
    Random random(seed);
    for (int k = 0; k < samples; ++k) {
        const glm::ivec2 p = sample_of(page, drawing, random);
        const auto at = regions.at(glm::dvec2(p));
        ++score.samples;
        if (at.on_edge) {
            ++score.skipped;
            continue;
        }
        const std::uint32_t expected = canonical.polygon_at(p.x, p.y);
        score.covered += expected != kNone;
        const bool right = expected == kNone
                               ? at.polygons.empty()
                               : at.polygons.size() == 1 && at.polygons[0] == expected;
        if (right) continue;
        if (canonical.near_border(p.x, p.y)) {
            ++score.slivers;
            continue;
        }
        if (score.wrong++ == 0)
            score.first = "seed " + std::to_string(seed) + " at " + std::to_string(p.x) + ", " +
                          std::to_string(p.y) + ": polygon " +
                          std::to_string(static_cast<int>(expected)) + ", the drawing has " +
                          std::to_string(at.polygons.size()) + " regions there, first " +
                          std::to_string(at.polygons.empty() ? -1 : int(at.polygons[0]));
    }
}

TEST(SampledRegions, AreThoseOfTheDefinitionOnHostileScenes) {
    Score score;
    for (std::uint64_t seed = 0; seed < amount(3000, 300, 40); ++seed) {
        const Scene scene = hostile_scene(seed);
        const Camera camera = hostile_camera(scene, seed, {200, 150});
        const ScreenScene screen =
            page(scene, camera, seed % 4 == 0 ? Cull::automatic : Cull::none);
        judge(screen, must(trace(screen, regions_only())), seed, 200, score);
    }
    score.expect_good("hostile scenes");
    EXPECT_GT(score.covered, score.samples / 4);
}

TEST(SampledRegions, AreThoseOfTheDefinitionOnNastyScenes) {
    for (const NastyScene& nasty : nasty_scenes()) {
        // Where every face is before and behind every other one, time grows as their third power.
        const bool slow = nasty.entangled || nasty.name == "bundle of needles";
        const Scene scene =
            beginning(nasty.scene, !slow ? 10000 : static_cast<std::uint32_t>(amount(250, 80, 40)));
        Score score;
        const ScreenScene screen = page(scene, page_camera(scene, {64, 64}));
        judge(screen, must(trace(screen, regions_only())), 1, 2000, score);
        score.expect_good(std::string(nasty.name));
    }
}

// Points spread evenly over the sphere (a Fibonacci lattice).
glm::dvec3 direction(int k, int count) {
    const double golden = std::acos(-1.0) * (3 - std::sqrt(5.0));
    const double y = 1 - 2 * (k + 0.5) / count, r = std::sqrt(1 - y * y);
    return {r * std::cos(golden * k), y, r * std::sin(golden * k)};
}

Camera view_of(const Scene& scene, int k, int count, Resolution size) {
    CameraOptions options;
    options.direction = direction(k, count);
    options.projection = k % 2 == 0 ? Projection::perspective : Projection::orthographic;
    return must(make_camera(options, scene.bounds, size));
}

int view_count(std::uint64_t usual) { return static_cast<int>(amount(20, usual, 1)); }

void expect_definition(const Scene& scene, const std::string& name, int views) {
    const int samples = static_cast<int>(amount(10000, 3000, 1000));
    Score score;
    for (int k = 0; k < views; ++k) {
        const ScreenScene screen =
            page(scene, view_of(scene, k, views, {320, 240}), Cull::automatic);
        judge(screen, must(trace(screen, regions_only())), static_cast<std::uint64_t>(k), samples,
              score);
    }
    score.expect_good(name);
    EXPECT_GT(score.covered, score.samples / 5);
}

// What snapping to the coarser grid of a picture can move a depth, in its units.
double snapping_bound(const Plane& p) {
    const auto c = static_cast<double>(p.c);
    return 0.5 +
           0.5 * (std::abs(static_cast<double>(p.a)) + std::abs(static_cast<double>(p.b))) / c;
}

/// Of samples farther than 1/256 pixel from all edges of regions.
struct PictureScore {
    std::uint64_t samples = 0, covered = 0, close_depths = 0, wrong = 0;
    std::string first;
};

bool is_close(const ScreenScene& picture, std::uint32_t a, std::uint32_t b, std::int32_t x,
              std::int32_t y) {
    if (a == kNone || b == kNone) return false;
    const Plane p = picture.plane(a), q = picture.plane(b);
    return std::abs(evaluate_depth(p, x, y) - evaluate_depth(q, x, y)) <=
           snapping_bound(p) + snapping_bound(q);
}

void compare_to_picture(const Scene& scene, const Camera& camera, PictureScore& score) {
    // Both with backs: where a closed mesh cuts through itself, one may be seen.
    ProjectOptions options;
    options.cull = Cull::none;
    const ScreenScene screen = page(scene, camera, options.cull);
    const ScreenScene picture = must(project(scene, camera, options));
    const CanonicalAnswer canonical(screen);
    const Visibility seen = run("zbuffer", picture);
    const double unit = std::ldexp(1.0, screen.subpixel_bits());
    const RegionAnswer regions(must(trace(screen, regions_only())), screen.subpixel_bits(),
                               unit / 256);
    const Resolution size = camera.resolution;
    for (std::uint32_t j = 0; j < size.height; ++j)
        for (std::uint32_t i = 0; i < size.width; ++i) {
            const glm::dvec2 centre = unit * glm::dvec2(i + 0.5, j + 0.5);
            const auto at = regions.at(centre);
            if (at.on_edge) continue;
            const std::uint32_t id = seen.ids[std::size_t{j} * size.width + i];
            ++score.samples;
            score.covered += id != kNone;
            if (id == kNone
                    ? at.polygons.empty()
                    : at.polygons.size() == 1 && at.polygons[0] == scene.triangle_polygon[id])
                continue;
            const std::uint32_t exact = canonical.at(static_cast<std::int32_t>(centre.x),
                                                     static_cast<std::int32_t>(centre.y));
            if (is_close(picture, id, exact, static_cast<std::int32_t>(256 * i + 128),
                         static_cast<std::int32_t>(256 * j + 128))) {
                ++score.close_depths;
                continue;
            }
            if (score.wrong++ == 0)
                score.first = "pixel " + std::to_string(i) + ", " + std::to_string(j) +
                              ": triangle " + std::to_string(static_cast<int>(id)) +
                              " in the picture, " + std::to_string(static_cast<int>(exact)) +
                              " on the page";
        }
}

void expect_picture(const Scene& scene, const std::string& name, int views) {
    PictureScore score;
    const Resolution size = is_full() ? Resolution{320, 240} : Resolution{120, 90};
    for (int k = 0; k < views; ++k)
        compare_to_picture(scene, view_of(scene, k, views, size), score);
    std::cout << name << ": " << score.samples << " pixels, " << score.covered << " covered, "
              << score.close_depths << " differ where depths are closer than snapping moves them\n";
    EXPECT_GT(score.covered, score.samples / 20) << name;
    EXPECT_LT(score.close_depths, score.samples / 1000) << name;
    EXPECT_EQ(score.wrong, 0u) << name << ": " << score.first;
}

TEST(SampledRegions, AreThoseOfTheDefinitionOnASphere) {
    expect_definition(sphere_scene(40, 60), "sphere", view_count(3));
}

TEST(SampledRegions, AgreeWithPicturesOfASphere) {
    expect_picture(sphere_scene(40, 60), "sphere", view_count(2));
}

TEST(SampledRegions, AgreeWithPicturesOfHostileScenes) {
    PictureScore score;
    for (std::uint64_t seed = 0; seed < amount(1000, 40, 10); ++seed) {
        const Scene scene = hostile_scene(seed);
        const Camera camera = hostile_camera(scene, seed, {60, 50});
        compare_to_picture(scene, camera, score);
        ASSERT_EQ(score.wrong, 0u) << "seed " << seed << ", " << score.first;
    }
    std::cout << "hostile scenes: " << score.samples << " pixels, " << score.close_depths
              << " differ where depths are closer than snapping moves them\n";
    EXPECT_LT(score.close_depths, score.samples / 50);
}

TEST(SampledRegions, AgreeWithPicturesOfSurfacesThatCross) {
    PictureScore score;
    for (std::uint64_t seed = 0; seed < amount(100, 6, 1); ++seed)
        for (const int kind : {0, 1, 4}) {
            const Scene scene = surface_pair(kind, seed).builder.build();
            compare_to_picture(scene, random_view(scene, seed, {80, 60}), score);
            ASSERT_EQ(score.wrong, 0u)
                << "kind " << kind << " seed " << seed << ", " << score.first;
        }
    std::cout << "surfaces that cross: " << score.samples << " pixels, " << score.close_depths
              << " differ where depths are closer than snapping moves them\n";
    EXPECT_GT(score.covered, score.samples / 20);
    EXPECT_LT(score.close_depths, score.samples / 1000);
}

/// Beside a visible curve, 1/256 pixel away, each of its two faces is seen on one side.
TEST(SampledRegions, BorderOnEachOtherAlongCurves) {
    std::uint64_t curves = 0, others = 0, wrong = 0;
    for (std::uint64_t seed = 0; seed < amount(200, 20, 3); ++seed) {
        const Scene scene = surface_pair(static_cast<int>(seed % 5), seed).builder.build();
        const ScreenScene screen = page(scene, random_view(scene, seed, {400, 300}));
        const CanonicalAnswer canonical(screen);
        const Drawing drawing = must(trace(screen, [] {
            TraceOptions options;
            options.edges = {EdgeKind::intersection};
            return options;
        }()));
        const double unit = std::ldexp(1.0, screen.subpixel_bits());
        for (std::size_t i = 0; i < drawing.lines.size(); ++i) {
            const glm::dvec2 p = drawing.lines.from[i], q = drawing.lines.to[i], way = q - p;
            const double length = std::sqrt(way.x * way.x + way.y * way.y);
            if (length < 0.125) continue;
            const glm::uvec2 own = drawing.lines.polygons[i];
            const glm::dvec2 beside = glm::dvec2(-way.y, way.x) / (256 * length);
            std::uint32_t seen[2] = {};
            bool both_are_there = true;
            for (const int side : {0, 1}) {
                const glm::dvec2 s = unit * (0.5 * (p + q) + (side == 0 ? -1.0 : 1.0) * beside);
                const auto x = static_cast<std::int32_t>(s.x), y = static_cast<std::int32_t>(s.y);
                seen[side] = canonical.polygon_at(x, y);
                both_are_there = both_are_there && canonical.is_over(own.x, x, y) &&
                                 canonical.is_over(own.y, x, y);
            }
            const auto is_own = [&](std::uint32_t id) { return id == own.x || id == own.y; };
            ++curves;
            // Near the end of a face another one is seen, or where the faces are slivers.
            if (!both_are_there || !is_own(seen[0]) || !is_own(seen[1]))
                ++others;
            else if (seen[0] == seen[1])
                ++wrong;
        }
    }
    std::cout << curves << " pieces of curves, beside " << others << " other faces are seen\n";
    EXPECT_GT(curves, amount(500, 500, 50));
    EXPECT_LE(others, curves / 50);
    EXPECT_EQ(wrong, 0u);
}

class RegionsOfModel : public ::testing::TestWithParam<const char*> {
protected:
    void SetUp() override {
        if (amount(1, 1, 0) == 0) GTEST_SKIP() << "takes too long under the sanitizers";
        scene_ = real_model(GetParam());
        if (!scene_)
            GTEST_SKIP() << models_folder() / GetParam() << " is not there; set SIGHTLINE_MODELS";
    }
    /// Usually only one of a large model: a drawing of the bunny takes a second.
    [[nodiscard]] int few_views(std::uint64_t usual) const {
        return view_count(scene_->triangle_count() > 50000 ? 1 : usual);
    }
    std::optional<Scene> scene_;
};

TEST_P(RegionsOfModel, AreThoseOfTheDefinition) {
    expect_definition(*scene_, GetParam(), few_views(3));
}
TEST_P(RegionsOfModel, AgreeWithPictures) { expect_picture(*scene_, GetParam(), few_views(2)); }

INSTANTIATE_TEST_SUITE_P(All, RegionsOfModel,
                         ::testing::Values("cow.obj", "fandisk.obj", "teapot.obj",
                                           "stanford-bunny.obj"));

}  // namespace
}  // namespace sightline
