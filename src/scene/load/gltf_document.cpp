#include "scene/load/gltf_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "scene/load/json_reader.hpp"
#include "scene/load/text.hpp"

namespace sightline::load {
namespace {

using nlohmann::json;

constexpr std::size_t kHeader = 12, kChunkHeader = 8;  // of the binary form

bool is_binary(std::string_view file) { return file.starts_with("glTF"); }

std::uint32_t number_at(std::string_view file, std::size_t offset) {
    std::uint32_t number = 0;
    std::memcpy(&number, file.data() + offset, sizeof number);
    return number;
}

/// What is wrong with the sizes that a binary file states; "" when nothing is. Memory would be
/// taken for them before they are found to be wrong.
std::string fault_of_sizes(std::string_view file) {
    if (file.size() < kHeader + kChunkHeader) return "it ends within its header";
    const std::uint32_t version = number_at(file, 4), total = number_at(file, 8);
    std::string_view rest = file.substr(kHeader);
    if (version == 1) {  // one header for all, and what follows the JSON goes to the end
        if (total > file.size()) {
            return fmt::format("it states {} bytes, but has {}", total, file.size());
        }
        rest = rest.substr(0, kChunkHeader + number_at(rest, 0));
    }
    constexpr int kChunksRead = 2;  // JSON and the buffer
    for (int i = 0; i < kChunksRead && rest.size() >= kChunkHeader; ++i) {
        const std::size_t size = number_at(rest, 0);
        rest.remove_prefix(kChunkHeader);
        if (size > rest.size()) {
            return fmt::format("a chunk states {} bytes, but {} are left", size, rest.size());
        }
        rest.remove_prefix(std::min((size + 3) / 4 * 4, rest.size()));  // the next one is aligned
    }
    return {};
}

/// The JSON of a file whose sizes are right: the first chunk of a binary one, without the zeros to
/// which some programs fill it up.
std::string_view json_of(std::string_view file) {
    if (!is_binary(file)) return without_mark(file);
    const std::string_view text = file.substr(kHeader + kChunkHeader, number_at(file, kHeader));
    return text.substr(0, text.find_last_not_of('\0') + 1);
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

/// The text of a member; nullptr when there is none.
const std::string* text_at(const json& object, const char* key) {
    if (!object.is_object()) return nullptr;
    const auto found = object.find(key);
    return found == object.end() ? nullptr : found->get_ptr<const std::string*>();
}

std::string fault_of_extensions(const json& document) {
    const auto required = document.find("extensionsRequired");
    if (required == document.end() || !required->is_array()) return {};
    for (const json& entry : *required) {
        const auto* const name = entry.get_ptr<const std::string*>();
        if (name != nullptr && !is_harmless(*name)) {
            return fmt::format("it requires the extension {}, which is not supported",
                               one_line(*name));
        }
    }
    return {};
}

bool names_file(std::string_view uri) { return !uri.empty() && !uri.starts_with("data:"); }

std::optional<int> hexadecimal(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return std::nullopt;
}

/// A URI with its %XX replaced by the bytes that they stand for (RFC 3986).
std::string decoded(std::string_view uri) {
    std::string text;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const bool escapes = uri[i] == '%' && i + 2 < uri.size();
        const auto high = escapes ? hexadecimal(uri[i + 1]) : std::nullopt;
        const auto low = escapes ? hexadecimal(uri[i + 2]) : std::nullopt;
        if (high && low) {
            text += static_cast<char>(16 * *high + *low);
            i += 2;
        } else {
            text += uri[i];
        }
    }
    return text;
}

/// Extensions have files of their own, so what is called a URI anywhere counts.
std::set<std::string> files_of(const json& document) {
    std::set<std::string> files;
    std::vector<const json*> left = {&document};  // no recursion: it may be nested deeply
    while (!left.empty()) {
        const json& value = *left.back();
        left.pop_back();
        if (const std::string* uri = text_at(value, "uri"); uri != nullptr && names_file(*uri)) {
            files.insert(*uri);
            files.insert(decoded(*uri));
        }
        for (const json& part : value) {
            if (part.is_structured()) left.push_back(&part);
        }
    }
    return files;
}

/// In glTF 1.0 the images are the members of an object.
std::set<std::string> images_of(const json& document) {
    std::set<std::string> names;
    const auto images = document.find("images");
    if (images == document.end() || !images->is_structured()) return names;
    std::size_t number = 0;
    for (const json& image : *images) {
        const std::string* const uri = text_at(image, "uri");
        const std::string* const name = text_at(image, "name");
        if (uri != nullptr && names_file(*uri)) {
            names.insert(decoded(*uri));
        } else if (name != nullptr && !name->empty()) {
            names.insert(*name);
        } else {
            names.insert(fmt::format("image {}", number));
        }
        ++number;
    }
    return names;
}

}  // namespace

GltfDocument read_gltf_document(std::string_view file) {
    GltfDocument result;
    if (is_binary(file)) result.fault = fault_of_sizes(file);
    if (!result.fault.empty()) return result;
    const Result<json> document = parse_json(json_of(file), "");
    result.fault = !document               ? document.error().message
                   : document->is_object() ? fault_of_extensions(*document)
                                           : "its JSON is no object";
    if (!result.fault.empty()) return result;
    result.files = files_of(*document);
    result.images = images_of(*document);
    return result;
}

}  // namespace sightline::load
