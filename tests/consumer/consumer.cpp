// Uses the installed library as a stranger would: two triangles, one in front of the other, and the
// ids that must be seen.
#include <cstdint>
#include <cstdio>
#include <sightline/sightline.hpp>

namespace {

/// A triangle that faces +z: its lower left corner, its size, and its z.
void add_triangle(sightline::Scene& scene, double x, double y, double size, double z) {
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    scene.positions.insert(scene.positions.end(), {{x, y, z}, {x + size, y, z}, {x, y + size, z}});
    scene.triangle_polygon.push_back(scene.triangle_count());
    scene.triangles.emplace_back(first, first + 1, first + 2);
    scene.polygon_edges.push_back(0b111);
}

sightline::Scene two_triangles() {
    sightline::Scene scene;
    add_triangle(scene, -1, -1, 4, 0);  // 0: large, behind
    add_triangle(scene, -1, -1, 1, 1);  // 1: small, in front, in the lower left corner
    scene.materials.emplace_back();
    sightline::Object object;
    object.name = "two triangles";
    object.triangle_count = object.polygon_count = scene.triangle_count();
    scene.objects.push_back(object);
    sightline::finish_scene(scene);
    return scene;
}

int fail(const char* what, const sightline::Error& error) {
    std::fprintf(stderr, "consumer: %s: %s\n", what, error.message.c_str());
    return 1;
}

}  // namespace

int main() {
    const sightline::Scene scene = two_triangles();
    sightline::CameraOptions options;
    options.view = sightline::NamedView::front;
    options.projection = sightline::Projection::orthographic;
    options.target = glm::dvec3(0, 0, 0);
    options.ortho_height = 2;
    const auto camera = sightline::make_camera(options, scene, {64, 64});
    if (!camera.ok()) return fail("camera", camera.error());
    const auto screen = sightline::project(scene, camera.value());
    if (!screen.ok()) return fail("project", screen.error());

    sightline::Visibility seen;
    const auto status =
        sightline::resolve(sightline::default_algorithm(), screen.value(), {}, seen);
    if (!status.ok()) return fail("resolve", status.error());
    const sightline::IdImage ids = sightline::triangle_map(seen);

    // The view shows -1..1: the small triangle ends at the middle of the lower edge and the left
    // one, the large one covers the rest.
    const std::uint32_t lower_left = ids.at(2, 61), upper_right = ids.at(61, 2);
    std::printf("sightline: lower left %u, upper right %u\n", lower_left, upper_right);
    return lower_left == 1 && upper_right == 0 ? 0 : 1;
}
