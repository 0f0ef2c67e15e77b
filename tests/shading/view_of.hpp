// Small scenes seen through the whole of the public interface: finish, project, resolve.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <initializer_list>
#include <vector>

#include "sightline/camera.hpp"
#include "sightline/scene.hpp"
#include "sightline/screen_scene.hpp"
#include "sightline/shading.hpp"
#include "sightline/visibility.hpp"

namespace sightline::test {

/// A scene of one object with one matt grey material; fill it, then view it.
class SceneBuilder {
public:
    SceneBuilder() {
        scene.objects.resize(1);
        scene.materials.resize(1);
        scene.materials[0].specular = 0;
    }

    /// Adds one polygon as a fan.
    void polygon(std::initializer_list<glm::dvec3> corners) {
        const auto first = static_cast<std::uint32_t>(scene.positions.size());
        scene.positions.insert(scene.positions.end(), corners);
        const auto count = static_cast<std::uint32_t>(corners.size());
        for (std::uint32_t k = 2; k < count; ++k) {
            scene.triangles.push_back({first, first + k - 1, first + k});
            scene.triangle_polygon.push_back(polygons_);
            scene.polygon_edges.push_back(7);
        }
        ++polygons_;
        scene.objects[0].triangle_count = scene.triangle_count();
        scene.objects[0].polygon_count = polygons_;
    }

    /// One normal for each position.
    void vertex_normals(std::vector<glm::vec3> normals) {
        scene.normals = std::move(normals);
        scene.triangle_normals = scene.triangles;
    }
    /// One colour for each position.
    void vertex_colors(std::vector<glm::vec4> colors) {
        scene.colors = std::move(colors);
        scene.triangle_colors = scene.triangles;
    }

    Scene scene;

private:
    std::uint32_t polygons_ = 0;
};

/// A scene made ready, projected and resolved. The scene must outlive it.
struct View {
    Camera camera;
    ScreenScene screen;
    Visibility visibility;

    [[nodiscard]] ColorImage shade(Shading shading, glm::vec4 background = {0, 0, 0, 0},
                                   int threads = 1) const {
        return sightline::shade(screen, visibility, {shading, background, threads});
    }
};

inline View view_of(Scene& scene, const CameraOptions& options, Resolution resolution,
                    std::uint32_t samples_per_axis = 1) {
    finish_scene(scene);
    View view;
    Result<Camera> camera = make_camera(options, scene.bounds, resolution);
    EXPECT_TRUE(camera.ok()) << (camera.ok() ? "" : camera.error().message);
    view.camera = *camera;
    Result<ScreenScene> screen = project(scene, view.camera, {.cull = Cull::none, .threads = 1});
    EXPECT_TRUE(screen.ok());
    view.screen = std::move(*screen);
    const Status resolved =
        resolve(*find_algorithm("brute"), view.screen,
                {.samples_per_axis = samples_per_axis, .threads = 1}, view.visibility);
    EXPECT_TRUE(resolved.ok());
    return view;
}

/// From the origin along -z, 90 degrees high: a pixel of a W x H picture sees (x, y, -1) with
/// y in -1..1.
inline CameraOptions forward_camera() {
    CameraOptions options;
    options.eye = glm::dvec3(0, 0, 0);
    options.target = glm::dvec3(0, 0, -1);
    options.fov = 90;
    return options;
}

}  // namespace sightline::test
