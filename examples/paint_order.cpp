// Paints a model back to front with a means of its own: an SVG in which every piece is a polygon.
//
//     paint_order MODEL ALGORITHM OUT.svg     (depth-sort, bsp or painter)
#include <cstdio>
#include <fstream>
#include <sightline/sightline.hpp>
#include <string>

int fail(const sightline::Error& error) {
    std::fprintf(stderr, "paint_order: %s\n", error.message.c_str());
    return sightline::exit_status(error.kind);
}

int main(int argc, char** argv) {
    if (argc != 4) {
        std::fprintf(stderr, "usage: paint_order MODEL ALGORITHM OUT.svg\n");
        return 2;
    }
    const sightline::Algorithm* algorithm = sightline::find_algorithm(argv[2]);
    if (algorithm == nullptr) {
        std::fprintf(stderr, "paint_order: no algorithm is called '%s'\n", argv[2]);
        return 2;
    }
    const std::string paths[] = {argv[1]};
    const auto scene = sightline::load_scene(paths);
    if (!scene) return fail(scene.error());
    const sightline::Resolution size{800, 600};
    const auto camera = sightline::make_camera({}, *scene, size);
    if (!camera) return fail(camera.error());
    const auto screen = sightline::project(*scene, *camera);
    if (!screen) return fail(screen.error());

    std::ofstream svg(argv[3]);
    svg << "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 800 600'>\n";
    std::size_t count = 0;
    const auto status = sightline::for_each_back_to_front(
        *algorithm, *screen, {}, [&](const sightline::OrderedPiece& piece) {
            svg << "<path stroke='black' stroke-width='0.4' fill='hsl("
                << scene->object_of(piece.triangle) * 137 % 360 << ",60%,75%)' d='";
            char command = 'M';
            for (const glm::dvec2& corner : piece.outline) {
                svg << command << corner.x << ',' << corner.y;
                command = 'L';
            }
            svg << "Z'/>\n";
            ++count;
            return true;
        });
    if (!status) return fail(status.error());
    svg << "</svg>\n";
    std::printf("%zu pieces of %u triangles\n", count, scene->triangle_count());
    return svg ? 0 : 1;
}
