// The materials of an OBJ file.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "scene/load/obj_materials.hpp"
#include "scene_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using sightline::fuzz::require;
    const sightline::load::ReadContext context("input", "", 20, std::size_t{1} << 30);
    sightline::load::ObjMaterials materials(context);
    materials.parse({reinterpret_cast<const char*>(data), size});
    for (const sightline::Material& material : materials.take()) require(material.opacity > 0);
    return 0;
}
