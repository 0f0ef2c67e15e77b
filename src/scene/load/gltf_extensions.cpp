#include "scene/load/gltf_extensions.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

#include "scene/load/text.hpp"

namespace sightline::load {
namespace {

/// The JSON of a file: the first chunk of a binary one.
std::string_view json_of(std::string_view file) {
    constexpr std::size_t kHeader = 12, kChunkHeader = 8;
    if (!file.starts_with("glTF")) return without_mark(file);
    if (file.size() < kHeader + kChunkHeader) return {};
    std::uint32_t size = 0;
    std::memcpy(&size, file.data() + kHeader, sizeof size);
    return file.substr(kHeader + kChunkHeader, size);
}

/// Whether an extension changes materials, textures, lights or remarks only: shapes are read right
/// without it.
bool is_harmless(std::string_view name) {
    constexpr std::array<std::string_view, 9> kPrefixes = {
        "KHR_materials_", "KHR_texture_",    "EXT_texture_",   "MSFT_texture_", "KHR_lights_",
        "EXT_lights_",    "ADOBE_materials", "EXT_materials_", "MSFT_packing_"};
    return name.starts_with("KHR_xmp") ||
           std::ranges::any_of(kPrefixes, [&](std::string_view p) { return name.starts_with(p); });
}

}  // namespace

std::string unsupported_gltf_extension(std::string_view file) {
    const nlohmann::json document = nlohmann::json::parse(json_of(file), nullptr, false);
    if (!document.is_object()) return {};
    const auto required = document.find("extensionsRequired");
    if (required == document.end() || !required->is_array()) return {};
    for (const nlohmann::json& entry : *required) {
        const auto* const name = entry.get_ptr<const std::string*>();
        if (name != nullptr && !is_harmless(*name)) return *name;
    }
    return {};
}

}  // namespace sightline::load
