// Names of the picture formats.
#include "sightline/image.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace sightline {
namespace {

constexpr std::array<std::pair<std::string_view, ImageFormat>, 3> kFormats = {
    {{"png", ImageFormat::png}, {"exr", ImageFormat::exr}, {"npy", ImageFormat::npy}}};

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

}  // namespace

std::optional<ImageFormat> parse_image_format(std::string_view name) {
    const auto* found = std::find_if(kFormats.begin(), kFormats.end(),
                                     [name](const auto& row) { return row.first == name; });
    if (found == kFormats.end()) return std::nullopt;
    return found->second;
}

std::optional<ImageFormat> image_format_of(std::string_view path) {
    const std::size_t dot = path.find_last_of("./");
    if (dot == std::string_view::npos || path[dot] != '.') return std::nullopt;
    std::string extension(path.substr(dot + 1));
    std::transform(extension.begin(), extension.end(), extension.begin(), lower);
    return parse_image_format(extension);
}

}  // namespace sightline
