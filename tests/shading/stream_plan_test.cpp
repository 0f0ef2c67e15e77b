// Parts that lie in one plane with one another: with a plan they make the picture of the whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>
#include <glm/geometric.hpp>

#include "sightline/stream.hpp"
#include "support/files.hpp"
#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

/// All in one scene, as if they were files that are loaded together.
Scene joined(const std::vector<Scene>& parts) {
    Scene all;
    for (std::uint32_t k = 0; k < parts.size(); ++k) {
        const Scene& part = parts[k];
        const auto base = static_cast<std::uint32_t>(all.positions.size());
        const std::uint32_t first = all.triangle_count();
        const auto polygons = static_cast<std::uint32_t>(all.counts.polygons);
        const auto materials = static_cast<std::uint32_t>(all.materials.size());
        all.positions.insert(all.positions.end(), part.positions.begin(), part.positions.end());
        for (const Corners& c : part.triangles) all.triangles.push_back(c + Corners(base));
        for (const std::uint32_t p : part.triangle_polygon)
            all.triangle_polygon.push_back(polygons + p);
        all.polygon_edges.insert(all.polygon_edges.end(), part.polygon_edges.begin(),
                                 part.polygon_edges.end());
        all.materials.insert(all.materials.end(), part.materials.begin(), part.materials.end());
        all.lights.insert(all.lights.end(), part.lights.begin(), part.lights.end());
        for (Object object : part.objects) {
            object.first_triangle += first;
            object.first_polygon += polygons;
            object.material += materials;
            object.part = k;
            all.objects.push_back(object);
        }
        all.counts.polygons += part.counts.polygons;
    }
    finish_scene(all);
    return all;
}

/// Walls of which each has pieces in several parts: decals, neighbours, copies, boxes that touch
/// them; and loose triangles. Some walls are tilted, and corners rounded as those of files are.
std::vector<Scene> walls_in_parts(std::uint64_t seed) {
    Random random(seed);
    const std::uint32_t count = 2 + random.below(4);
    std::vector<SceneBuilder> builders(count);
    const auto any = [&]() -> SceneBuilder& { return builders[random.below(count)]; };
    const bool far = random.chance(0.2);
    for (int wall = 0; wall < 6; ++wall) {
        const bool tilted = random.chance(0.5);
        const glm::dvec3 o = random.point(0.7);
        const glm::dvec3 u = tilted ? random.point() : glm::dvec3(1, 0, 0);
        const glm::dvec3 v = tilted ? random.point() : glm::dvec3(0, 0, 1);
        const auto at = [&](double s, double t) {
            const glm::dvec3 p = o + s * u + t * v + (far ? glm::dvec3(4096) : glm::dvec3(0));
            return tilted ? glm::dvec3(glm::vec3(p)) : p;
        };
        const auto rectangle = [&](double s0, double t0, double s1, double t1) {
            if (random.chance(0.3))
                any().triangle(at(s0, t0), at(s1, t0), at(s0, t1));
            else
                any().quad(at(s0, t0), at(s1, t0), at(s1, t1), at(s0, t1));
        };
        rectangle(-1, -1, 1, 1);
        for (std::uint32_t decals = random.below(6); decals > 0; --decals) {
            const double s = random.uniform(-1.2, 1), t = random.uniform(-1.2, 1);
            rectangle(s, t, s + random.uniform(0.05, 0.6), t + random.uniform(0.05, 0.6));
        }
        if (!tilted && random.chance(0.5))
            any().box(at(0.2, 0.2), at(0.5, 0.6) + glm::dvec3(0, 0.3, 0));
    }
    std::vector<Scene> parts;
    for (SceneBuilder& b : builders) {
        const glm::dvec3 p = random.point(), q = random.point();
        b.triangle(p, q, random.point());
        b.scene.materials[0].base_color =
            glm::vec3(0.2f + 0.6f * static_cast<float>(parts.size()) / static_cast<float>(count));
        parts.push_back(b.build());
        if (random.chance(0.3)) {
            Light light;
            light.kind = LightKind::directional;
            light.direction = random.point();
            parts.back().lights.push_back(light);
        }
    }
    return parts;
}

std::vector<PictureFile> files_in(const TemporaryFolder& folder, const std::string& prefix) {
    const auto name = [&](const char* end) { return folder.file(prefix + end); };
    return {{PictureContent::color, name("c.npy"), ImageFormat::npy},
            {PictureContent::depth, name("d.npy"), ImageFormat::npy},
            {PictureContent::ids, name("i.exr"), ImageFormat::exr}};
}

/// The pictures of the parts, made with a plan, or without one.
void stream(std::vector<Scene> parts, const std::function<Camera(const Scene&)>& camera_for,
            const DrawOptions& options, const ProjectOptions& projecting,
            std::span<const PictureFile> files, bool planned) {
    StreamPlan plan;
    for (const Scene& part : parts) plan.survey(part);
    plan.finish_survey();
    for (std::uint32_t k = 0; k < parts.size(); ++k)
        if (plan.is_shared(k)) plan.compare(k, parts[k]);
    plan.finish_comparison();
    const Camera camera = camera_for(plan.frame());
    ASSERT_TRUE(plan.set_view(camera, projecting).ok());
    StreamedPicture picture(camera, options, files, planned ? &plan : nullptr);
    for (std::uint32_t k = 0; k < parts.size(); ++k) {
        Scene& part = parts[k];
        if (planned)
            plan.adopt(k, part);
        else
            finish_scene(part);
        ScreenScene screen = must(project(part, camera, projecting));
        if (planned) plan.adopt(k, screen);
        ASSERT_TRUE(picture.add(screen).ok());
    }
    ASSERT_TRUE(picture.write().ok());
}

std::uint64_t trials() { return std::getenv("SIGHTLINE_FULL") != nullptr ? 3000 : 170; }

TEST(StreamPlan, MakesTheBytesOfTheWhole) {
    const TemporaryFolder folder;
    const auto whole = files_in(folder, "whole-"), streamed = files_in(folder, "parts-"),
               alone = files_in(folder, "alone-");
    std::uint64_t alone_differ = 0;
    for (std::uint64_t seed = 0; seed < trials(); ++seed) {
        const std::vector<Scene> parts = walls_in_parts(seed);
        const Scene scene = joined(parts);
        constexpr std::array kCulls = {Cull::automatic, Cull::none, Cull::back, Cull::front};
        const ProjectOptions projecting{kCulls[seed % 4], 0};
        const auto view_of = [&](const Scene& any) { return hostile_camera(any, seed, {64, 48}); };
        DrawOptions options;
        options.samples_per_axis = seed % 3 == 0 ? 2 : 1;
        const ScreenScene screen = must(project(scene, view_of(scene), projecting));
        ASSERT_TRUE(draw(screen, default_algorithm(), options, whole).ok());
        stream(parts, view_of, options, projecting, streamed, true);
        stream(parts, view_of, options, projecting, alone, false);
        bool differs = false;
        for (std::size_t k = 0; k < whole.size(); ++k) {
            const std::string bytes = read_file(whole[k].path);
            ASSERT_TRUE(bytes == read_file(streamed[k].path)) << whole[k].path << ", seed " << seed;
            differs = differs || bytes != read_file(alone[k].path);
        }
        alone_differ += differs ? 1 : 0;
    }
    // The scenes are worth something: what is found by each part on its own is not that.
    EXPECT_GT(alone_differ, trials() / 20);
}

TEST(StreamPlan, NumbersQuadricsAsTheWholeDoes) {
    const TemporaryFolder folder;
    const auto whole = files_in(folder, "whole-"), streamed = files_in(folder, "parts-");
    std::vector<Scene> parts = walls_in_parts(5);
    const auto ball = [](double x) { return make_sphere({x, 0.1, 0.2}, 0.4); };
    for (std::size_t k = 0; k < parts.size(); ++k) {
        add_quadric(parts[k], ball(0.3 * static_cast<double>(k)), "ball", Material{});
        finish_scene(parts[k]);
    }
    std::vector<Scene> meshes = parts;
    for (Scene& mesh : meshes) {
        mesh.objects.pop_back();
        mesh.quadrics.clear();
    }
    Scene scene = joined(meshes);
    for (std::size_t k = 0; k < parts.size(); ++k)
        add_quadric(scene, ball(0.3 * static_cast<double>(k)), "ball", Material{});
    finish_scene(scene);
    const auto view_of = [&](const Scene& any) {
        return must(make_camera({}, any.reach, {80, 60}));
    };
    ASSERT_TRUE(draw(must(project(scene, view_of(scene))), default_algorithm(), {}, whole).ok());
    stream(parts, view_of, {}, {}, streamed, true);
    for (std::size_t k = 0; k < whole.size(); ++k)
        EXPECT_TRUE(read_file(whole[k].path) == read_file(streamed[k].path)) << whole[k].path;
}

// Two scans far from each other's planes are not looked at again.
TEST(StreamPlan, LooksAgainOnlyWherePlanesMayBeShared) {
    SceneBuilder a, b, c;
    a.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0.3});
    b.triangle({0, 0, 1}, {1, 0, 1.5}, {0, 1, 1});
    c.triangle({3, 0, 0}, {4, 0, 0}, {3, 1, 0.3});  // in the plane of a
    StreamPlan plan;
    for (const SceneBuilder* builder : {&a, &b, &c}) plan.survey(builder->build());
    plan.finish_survey();
    EXPECT_TRUE(plan.is_shared(0));
    EXPECT_FALSE(plan.is_shared(1));
    EXPECT_TRUE(plan.is_shared(2));
}

}  // namespace
}  // namespace sightline
