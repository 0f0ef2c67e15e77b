// Lines against an independent ray caster (Embree): from points of a visible part nothing lies on
// the way to the eye, from points of a hidden part something does.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <limits>
#include <memory>

#include "drawing/crossing_parts.hpp"
#include "drawing/pages.hpp"
#include "drawing/surfaces.hpp"
#include "support/embree_scene.hpp"
#include "support/models.hpp"

namespace sightline {
namespace {

using namespace testing;

class RayCaster {
public:
    explicit RayCaster(const Scene& scene) : scene_(scene) {}

    /// Whether something lies between two points, away from both ends by some shares of the way.
    [[nodiscard]] bool blocked(const glm::dvec3& from, const glm::dvec3& to, double begin,
                               double end) const {
        const glm::dvec3 way = to - from;
        RTCRay ray{};
        ray.org_x = static_cast<float>(from.x);
        ray.org_y = static_cast<float>(from.y);
        ray.org_z = static_cast<float>(from.z);
        ray.dir_x = static_cast<float>(way.x);
        ray.dir_y = static_cast<float>(way.y);
        ray.dir_z = static_cast<float>(way.z);
        ray.tnear = static_cast<float>(begin);
        ray.tfar = static_cast<float>(end);
        ray.mask = ~0u;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcOccluded1(scene_.get(), &context, &ray);
        return ray.tfar < 0;
    }

private:
    EmbreeScene scene_;
};

struct Score {
    std::uint64_t visible = 0, hidden = 0, unsure = 0, wrong = 0;
    std::string first;
};

/// Judges points of lines.
class Judge {
public:
    Judge(const ScreenScene& page, const RayCaster& caster)
        : page_(page), caster_(caster), unit_(std::ldexp(1.0, page.subpixel_bits())) {
        size_ = glm::length(page.scene().bounds.extent());
    }

    void judge(const PageEdge& edge, double t, bool visible, Score& score) const {
        const glm::dvec2 pixel =
            glm::mix(glm::dvec2(edge.p.x, edge.p.y), glm::dvec2(edge.q.x, edge.q.y), t) / unit_;
        const double depth = page_.metric_depth(edge.p.z + t * (edge.q.z - edge.p.z));
        ++(visible ? score.visible : score.hidden);
        if (blocked(pixel, depth, kNear) != visible) return;
        // Single precision on one side, snapping on the other: ask around the point. Not the truth
        // of the point itself but of its surroundings must agree with the drawing.
        if (is_unsure(pixel, depth, visible, edge)) {
            ++score.unsure;
            return;
        }
        if (score.wrong++ == 0)
            score.first = std::string(visible ? "visible" : "hidden") + " at pixel " +
                          std::to_string(pixel.x) + ", " + std::to_string(pixel.y) + ", depth " +
                          std::to_string(depth) + ", " + std::string(name_of(edge.kind));
    }

private:
    static constexpr double kNear = 1e-5;  // of the scene's size: nearer occluders do not count

    [[nodiscard]] bool blocked(glm::dvec2 pixel, double depth, double apart) const {
        const Camera& camera = page_.camera();
        const glm::dvec3 point = camera.unproject(pixel, depth);
        // As far as the near plane: what lies before it is not drawn.
        const glm::dvec3 front = camera.unproject(pixel, camera.near_plane);
        const double way = glm::length(front - point);
        if (way <= 2 * apart * size_) return false;
        return caster_.blocked(point, front, apart * size_ / way, 1 + 1e-6);
    }
    /// Whether the answer is another one a hair beside the line or with another distance.
    [[nodiscard]] bool is_unsure(glm::dvec2 pixel, double depth, bool visible,
                                 const PageEdge& edge) const {
        if (blocked(pixel, depth, 10 * kNear) != visible) return true;
        if (!visible && blocked(pixel, depth, kNear / 100)) return true;
        const glm::dvec2 along(edge.q.x - edge.p.x, edge.q.y - edge.p.y);
        const glm::dvec2 across = glm::dvec2(-along.y, along.x) / glm::length(along);
        const double hair = 1e-5 * page_.resolution().width;
        for (const glm::dvec2 step :
             {across, -across, along / glm::length(along), -along / glm::length(along)})
            if (blocked(pixel + hair * step, depth, kNear) != visible) return true;
        return false;
    }

    const ScreenScene& page_;
    const RayCaster& caster_;
    double unit_, size_ = 1;
};

/// Points inside of the parts of an edge, the ends left out.
void judge_edge(const Judge& judge, const PageEdge& edge, std::span<const EdgeInterval> hidden,
                Random& random, Score& score) {
    const double steps = glm::length(glm::dvec2(edge.q.x - edge.p.x, edge.q.y - edge.p.y));
    const auto judge_part = [&](double from, double to, bool visible) {
        // By so much rounding may have moved the ends of a curve.
        if (to - from < 1e-3 || (to - from) * steps < 2 * kJoinedSteps) return;
        for (int k = 0; k < 2; ++k)
            judge.judge(edge, from + (to - from) * random.uniform(0.02, 0.98), visible, score);
    };
    double at = 0;
    for (const EdgeInterval& part : hidden) {
        judge_part(at, part.from.value, true);
        judge_part(part.from.value, part.to.value, false);
        at = part.to.value;
    }
    judge_part(at, 1, true);
}

void judge_scene(const Scene& scene, const Camera& camera, std::uint64_t seed, Score& score,
                 EdgeKinds kinds = kAllEdges) {
    const ScreenScene screen = page(scene, camera);
    const RayCaster caster(scene);
    const Judge judge(screen, caster);
    const Occluders occluders(screen, TraceMethod::fast, 0);
    TraceOptions options;
    options.edges = kinds;
    const CutLines lines = cut_lines(screen, occluders, options);
    Random random(seed);
    for (std::size_t i = 0; i < lines.edges.edges.size(); ++i)
        judge_edge(judge, lines.edges.edges[i], lines.hidden_of(i), random, score);
}

/// As Embree sees it, in single precision.
Scene in_floats(Scene scene) {
    for (glm::dvec3& p : scene.positions) p = glm::dvec3(glm::vec3(p));
    finish_scene(scene);
    return scene;
}

void expect_good(const Score& score, const std::string& what) {
    std::cout << what << ": " << score.visible << " visible points, " << score.hidden
              << " hidden ones, " << score.unsure << " too close to tell\n";
    EXPECT_GT(score.visible, 100u) << what;
    EXPECT_GT(score.hidden, 100u) << what;
    EXPECT_EQ(score.wrong, 0u) << what << ": " << score.first;
    EXPECT_LT(score.unsure, (score.visible + score.hidden) / 50) << what;
}

Scene random_triangles(std::uint64_t seed) {
    Random random(seed);
    SceneBuilder b;
    for (int k = 0; k < 40; ++k) {
        const glm::dvec3 p = random.point(), q = p + random.point(0.7), r = p + random.point(0.7);
        b.triangle(p, q, r);
    }
    return in_floats(b.build());
}

TEST(DrawingRays, AgreeOnRandomTriangles) {
    Score score;
    for (std::uint64_t seed = 0; seed < amount(200, 200, 20); ++seed) {
        const Scene scene = random_triangles(seed);
        judge_scene(scene, hostile_camera(scene, seed, {400, 300}), seed, score);
    }
    expect_good(score, "random triangles");
}

TEST(DrawingRays, AgreeOnASphere) {
    const Scene scene = in_floats(sphere_scene(24, 36));
    Score score;
    judge_scene(scene, must(make_camera({}, scene.bounds, {400, 300})), 1, score);
    expect_good(score, "sphere");
}

// Curves of surfaces that cross are seen in full where nothing lies before them.
TEST(DrawingRays, AgreeOnSurfacesThatCross) {
    Score score;
    for (std::uint64_t seed = 0; seed < amount(60, 6, 1); ++seed) {
        for (const int kind : {0, 1, 4}) {
            const Scene scene = in_floats(surface_pair(kind, seed).builder.build());
            judge_scene(scene, random_view(scene, seed, {400, 300}), seed, score,
                        {EdgeKind::intersection});
        }
    }
    expect_good(score, "surfaces that cross");
}

class RaysOfModel : public ::testing::TestWithParam<const char*> {};

TEST_P(RaysOfModel, Agree) {
    if (amount(1, 1, 0) == 0) GTEST_SKIP() << "takes too long under the sanitizers";
    const std::optional<Scene> scene = real_model(GetParam());
    if (!scene)
        GTEST_SKIP() << models_folder() / GetParam() << " is not there; set SIGHTLINE_MODELS";
    Score score;
    judge_scene(in_floats(*scene), must(make_camera({}, scene->bounds, {400, 300})), 2, score);
    expect_good(score, GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, RaysOfModel, ::testing::Values("cow.obj", "fandisk.obj"));

}  // namespace
}  // namespace sightline
