// Names of the formats of drawings, and the way to their writers.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "sightline/vector.hpp"
#include "vector/writers.hpp"

namespace sightline {
namespace {

constexpr std::array<std::pair<std::string_view, VectorFormat>, 5> kFormats = {
    {{"svg", VectorFormat::svg},
     {"pdf", VectorFormat::pdf},
     {"eps", VectorFormat::eps},
     {"dxf", VectorFormat::dxf},
     {"png", VectorFormat::png}}};

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

VectorCounts count(const Paths& paths, double scale) {
    VectorCounts counts;
    for (std::size_t p = 0; p < paths.size(); ++p) {
        double length = 0;
        for (std::uint32_t k = paths.first_point[p] + 1; k < paths.first_point[p + 1]; ++k) {
            const glm::dvec2 step = paths.points[k] - paths.points[k - 1];
            length += scale * std::sqrt(step.x * step.x + step.y * step.y);
        }
        const bool visible = paths.visible[p] != 0;
        ++(visible ? counts.visible_paths : counts.hidden_paths);
        (visible ? counts.visible_length : counts.hidden_length) += length;
    }
    return counts;
}

}  // namespace

std::optional<VectorFormat> parse_vector_format(std::string_view name) {
    const auto* found = std::find_if(kFormats.begin(), kFormats.end(),
                                     [name](const auto& row) { return row.first == name; });
    if (found == kFormats.end()) return std::nullopt;
    return found->second;
}

std::optional<VectorFormat> vector_format_of(std::string_view path) {
    const std::size_t dot = path.find_last_of("./");
    if (dot == std::string_view::npos || path[dot] != '.') return std::nullopt;
    std::string extension(path.substr(dot + 1));
    std::transform(extension.begin(), extension.end(), extension.begin(), lower);
    return parse_vector_format(extension);
}

std::string_view name_of(VectorFormat format) {
    const auto* found = std::find_if(kFormats.begin(), kFormats.end(),
                                     [format](const auto& row) { return row.second == format; });
    return found == kFormats.end() ? std::string_view{} : found->first;
}

Status write_drawing(const std::string& path, VectorFormat format, const Drawing& drawing,
                     const VectorOptions& options) {
    const Paths paths = chain(drawing.lines, options.sorted);
    if (options.counts != nullptr) *options.counts = count(paths, options.layout.scale);
    switch (format) {
        case VectorFormat::svg:
            return write_svg(path, drawing, paths, options);
        case VectorFormat::dxf:
            return write_dxf(path, drawing, paths, options);
        case VectorFormat::pdf:
        case VectorFormat::eps:
        case VectorFormat::png:
            break;
    }
    return write_with_cairo(path, format, drawing, paths, options);
}

}  // namespace sightline
