// The materials of an OBJ file.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "scene/load/obj_materials.hpp"
#include "scene_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using sightline::fuzz::require;
    sightline::load::ObjMaterials materials("");
    materials.parse({reinterpret_cast<const char*>(data), size});
    for (const sightline::Material& material : materials.take()) require(material.opacity > 0);
    return 0;
}
