// Counts the triangles of a model that can be seen from a direction.
#include <cstdint>
#include <cstdio>
#include <set>
#include <sightline/sightline.hpp>
#include <string>
#include <vector>

int fail(const sightline::Error& error) {
    std::fprintf(stderr, "render_ids: %s\n", error.message.c_str());
    return sightline::exit_status(error.kind);
}

int main(int argc, char** argv) {
    const std::vector<std::string> paths(argv + 1, argv + argc);
    const auto scene = sightline::load_scene(paths);
    if (!scene) return fail(scene.error());

    sightline::CameraOptions view;
    view.direction = glm::dvec3(-1, -0.6, -1.2);  // the rest is fitted to the model
    const auto camera = sightline::make_camera(view, scene.value(), {640, 480});
    if (!camera) return fail(camera.error());

    const auto screen = sightline::project(scene.value(), camera.value());
    if (!screen) return fail(screen.error());

    sightline::Visibility seen;  // an id and a depth for every pixel
    const auto status = sightline::resolve(sightline::default_algorithm(), *screen, {}, seen);
    if (!status) return fail(status.error());

    std::set<std::uint32_t> ids(seen.ids.begin(), seen.ids.end());
    ids.erase(sightline::kNone);  // the background
    std::printf("%zu of %u triangles are seen\n", ids.size(), scene.value().triangle_count());
}
