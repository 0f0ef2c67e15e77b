// Numbers, points, sizes and colours from text; whatever the locale says.
#include <charconv>
#include <cmath>

#include "options.hpp"

namespace sightline::cli {
namespace {

std::string_view trim(std::string_view text) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    return text;
}

template <class T>
std::optional<T> parse_all(std::string_view text) {
    text = trim(text);
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
    T number{};
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, number);
    if (error != std::errc{} || rest != end) return std::nullopt;
    return number;
}

std::optional<glm::u8vec4> parse_hex_color(std::string_view digits) {
    if (digits.size() != 6 && digits.size() != 8) return std::nullopt;
    glm::u8vec4 color(0, 0, 0, 255);
    for (std::size_t i = 0; 2 * i < digits.size(); ++i) {
        const char* const end = digits.data() + 2 * i + 2;
        std::uint8_t component = 0;
        const auto [rest, error] = std::from_chars(end - 2, end, component, 16);
        if (error != std::errc{} || rest != end) return std::nullopt;
        color[static_cast<int>(i)] = component;
    }
    return color;
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
    const auto number = parse_all<double>(text);
    return number && std::isfinite(*number) ? number : std::nullopt;
}

std::optional<std::uint64_t> parse_count(std::string_view text) {
    return parse_all<std::uint64_t>(text);
}

std::vector<std::string_view> split_list(std::string_view text) {
    std::vector<std::string_view> items;
    for (;;) {
        const std::size_t comma = text.find(',');
        items.push_back(trim(text.substr(0, comma)));
        if (comma == std::string_view::npos) return items;
        text.remove_prefix(comma + 1);
    }
}

std::optional<glm::dvec3> parse_point(std::string_view text) {
    const auto items = split_list(text);
    if (items.size() != 3) return std::nullopt;
    glm::dvec3 point;
    for (int i = 0; i < 3; ++i) {
        const auto number = parse_number(items[static_cast<std::size_t>(i)]);
        if (!number) return std::nullopt;
        point[i] = *number;
    }
    return point;
}

std::optional<glm::u64vec2> parse_size(std::string_view text) {
    const std::size_t x = text.find('x');
    if (x == std::string_view::npos) return std::nullopt;
    const auto width = parse_count(text.substr(0, x)), height = parse_count(text.substr(x + 1));
    if (!width || !height) return std::nullopt;
    return glm::u64vec2(*width, *height);
}

std::optional<glm::u8vec4> parse_color(std::string_view text) {
    text = trim(text);
    if (text == "none") return glm::u8vec4(0);
    if (text.starts_with('#')) return parse_hex_color(text.substr(1));
    const auto items = split_list(text);
    if (items.size() != 3 && items.size() != 4) return std::nullopt;
    glm::u8vec4 color(0, 0, 0, 255);
    for (std::size_t i = 0; i < items.size(); ++i) {
        const auto component = parse_all<std::uint8_t>(items[i]);
        if (!component) return std::nullopt;
        color[static_cast<int>(i)] = *component;
    }
    return color;
}

}  // namespace sightline::cli
