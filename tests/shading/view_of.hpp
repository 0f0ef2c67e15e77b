// Small scenes seen through the whole of the public interface: finish, project, resolve.
#pragma once

#include <gtest/gtest.h>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "sightline/camera.hpp"
#include "sightline/scene.hpp"
#include "sightline/screen_scene.hpp"
#include "sightline/shading.hpp"
#include "sightline/visibility.hpp"

namespace sightline::test {

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
