// What the child process hands over, taken as hostile: deserialised, built, finished, with normals.
#include <cstddef>
#include <cstdint>
#include <span>

#include "scene/finish.hpp"
#include "scene/load/build.hpp"
#include "scene/load/soup.hpp"
#include "scene_check.hpp"
#include "sightline/scene.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace sightline;
    const auto soup = load::deserialise(std::as_bytes(std::span(data, size)));
    if (!soup) return 0;
    load::SceneBuilder builder(std::size_t{16} << 20);
    load::Placement placement;
    placement.file = "input";
    if (const Status built = builder.append(*soup, placement); !built) {
        fuzz::check_message(built.error());
        return 0;
    }
    Scene scene = builder.take();
    finish_joined_scene(scene);
    fuzz::check(scene);
    make_normals(scene, 30);
    fuzz::check(scene);
    return 0;
}
