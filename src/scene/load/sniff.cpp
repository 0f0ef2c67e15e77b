#include "scene/load/sniff.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "scene/load/text.hpp"

namespace sightline::load {
namespace {

constexpr std::size_t kLooked = 4096;

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// A binary STL file has no mark, but its size follows from the count in its header.
bool is_binary_stl(std::string_view bytes, std::size_t size) {
    constexpr std::size_t kHeader = 84, kFacet = 50;
    if (bytes.size() <= kHeader) return false;
    std::uint32_t facets = 0;
    std::memcpy(&facets, bytes.data() + kHeader - sizeof facets, sizeof facets);
    return size == kHeader + kFacet * std::size_t{facets};
}

/// Lines of an OBJ file: a vertex, and before it nothing but comments and other statements.
bool is_obj(std::string_view text) {
    constexpr std::array<std::string_view, 9> kWords = {"#",  "mtllib", "o",      "g", "s",
                                                        "vn", "vt",     "usemtl", "f"};
    for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
        const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
        const std::string_view word = line.substr(0, line.find_first_of(" \t"));
        if (word == "v") return line.find_first_of("0123456789") != std::string_view::npos;
        if (!line.starts_with('#') && std::ranges::count(kWords, word) == 0) return false;
        text.remove_prefix(line.size());
    }
    return false;
}

std::string format_of_text(std::string_view text) {
    constexpr std::array<std::string_view, 6> kOffWords = {"OFF",   "COFF",  "NOFF",
                                                           "CNOFF", "STOFF", "4OFF"};
    const std::string_view word = text.substr(
        0, static_cast<std::size_t>(std::ranges::find_if(text, is_space) - text.begin()));
    if (word == "ply") return "ply";
    if (word == "solid" && text.find("facet") != std::string_view::npos) return "stl";
    if (std::ranges::count(kOffWords, word) > 0) return "off";
    if (text.starts_with('<')) return text.find("<COLLADA") != std::string_view::npos ? "dae" : "";
    if (text.starts_with('{')) {
        if (text.find("\"asset\"") != std::string_view::npos) return "gltf";
        return text.find("\"models\"") != std::string_view::npos ? "json" : "";
    }
    return is_obj(text) ? "obj" : "";
}

}  // namespace

std::string sniff_format(std::string_view beginning, std::size_t size) {
    if (beginning.starts_with("glTF")) return "glb";
    if (beginning.starts_with("PK\x03\x04")) return "3mf";
    if (beginning.starts_with("Kaydara FBX Binary")) return "fbx";
    if (is_binary_stl(beginning, size)) return "stl";
    return format_of_text(trimmed(without_mark(beginning.substr(0, kLooked))));
}

bool can_sniff(std::string_view format) {
    constexpr std::array<std::string_view, 10> kFormats = {"obj", "stl", "ply", "off", "gltf",
                                                           "glb", "dae", "3mf", "fbx", "json"};
    return std::ranges::count(kFormats, format) > 0;
}

bool is_other_format(std::string_view format, std::string_view looks_like) {
    const auto family = [](std::string_view name) {
        return name == "glb" || name == "vrm" ? std::string_view("gltf") : name;
    };
    return !looks_like.empty() && family(format) != family(looks_like);
}

}  // namespace sightline::load
