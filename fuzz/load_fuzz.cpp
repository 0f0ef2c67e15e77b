// The whole way of a foreign file: reader in the child process, soup, scene. The first byte picks
// the format. A crash of the reader is no finding (that is what the child is for); a crash, hang or
// nonsense on this side is.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <span>

#include "scene_check.hpp"
#include "sightline/load.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const char* const kFormats[] = {"obj", "ply", "stl", "off", "gltf", "glb", "dae", "3ds"};
    if (size == 0) return 0;
    sightline::LoadOptions options;
    options.format = kFormats[data[0] % std::size(kFormats)];
    options.time_limit_seconds = 2;
    options.memory_limit_bytes = std::size_t{256} << 20;
    const auto bytes = std::as_bytes(std::span(data, size).subspan(1));
    const auto scene = sightline::load_scene_from_memory(bytes, "input", options);
    sightline::fuzz::check(scene);
    return 0;
}
