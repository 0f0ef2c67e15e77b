#include "scene/load/ply_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>

#include "scene/load/scan.hpp"
#include "scene/load/text.hpp"

namespace sightline::load {
namespace {

constexpr std::size_t kLargestHeader = std::size_t{1} << 20;

constexpr std::pair<std::string_view, PlyType> kTypes[] = {
    {"char", PlyType::int8},      {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
    {"uint8", PlyType::uint8},    {"short", PlyType::int16},     {"int16", PlyType::int16},
    {"ushort", PlyType::uint16},  {"uint16", PlyType::uint16},   {"int", PlyType::int32},
    {"int32", PlyType::int32},    {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
    {"float", PlyType::float32},  {"float32", PlyType::float32}, {"double", PlyType::float64},
    {"float64", PlyType::float64}};

std::optional<PlyType> type_of(std::string_view word) {
    const auto* const found =
        std::ranges::find(kTypes, word, [](const auto& t) { return t.first; });
    return found == std::end(kTypes) ? std::nullopt : std::optional(found->second);
}

std::vector<std::string_view> words_of(std::string_view line) {
    std::vector<std::string_view> words;
    while (!line.empty()) {
        const auto end =
            static_cast<std::size_t>(std::ranges::find_if(line, is_blank) - line.begin());
        if (end > 0) words.push_back(line.substr(0, end));
        line.remove_prefix(std::min(end + 1, line.size()));
    }
    return words;
}

/// Takes one line of the header; false when it can't be understood.
bool take_line(const std::vector<std::string_view>& words, PlyHeader& header) {
    using enum PlyHeader::Format;
    const std::size_t n = words.size();
    if (n == 0) return true;
    if (words[0] == "format") {
        if (n < 2) return false;
        if (words[1] == "ascii")
            header.format = ascii;
        else if (words[1] == "binary_little_endian")
            header.format = binary_little_endian;
        else if (words[1] == "binary_big_endian")
            header.format = binary_big_endian;
        else
            return false;
        return true;
    }
    if (words[0] == "element") {
        if (n != 3) return false;
        PlyElement element;
        element.name = words[1];
        const char* const end = words[2].data() + words[2].size();
        const auto [stop, problem] = std::from_chars(words[2].data(), end, element.count);
        if (problem != std::errc() || stop != end) return false;
        header.elements.push_back(std::move(element));
        return true;
    }
    // As MeshLab writes it. The name may hold blanks.
    if (n > 2 && words[0] == "comment" && words[1] == "TextureFile") {
        const char* const end = words.back().data() + words.back().size();
        header.textures.emplace_back(words[2].data(), end);
    }
    if (words[0] != "property") return true;  // a comment, or what somebody took for one
    if (header.elements.empty()) return false;
    const bool list = n == 5 && words[1] == "list";
    if (!list && n != 3) return false;
    const std::optional<PlyType> type = type_of(words[list ? 3 : 1]);
    const std::optional<PlyType> count = list ? type_of(words[2]) : std::nullopt;
    if (!type || (list && !count)) return false;
    header.elements.back().properties.push_back({std::string(words.back()), *type, count});
    return true;
}

}  // namespace

std::size_t size_of(PlyType type) {
    switch (type) {
        case PlyType::int8:
        case PlyType::uint8:
            return 1;
        case PlyType::int16:
        case PlyType::uint16:
            return 2;
        case PlyType::float64:
            return 8;
        default:
            return 4;
    }
}

Result<PlyHeader> parse_ply_header(std::string_view bytes, const ReadContext& context) {
    bytes = bytes.substr(0, kLargestHeader);
    const std::size_t first_end = bytes.find_first_of("\r\n");
    if (first_end == std::string_view::npos ||
        words_of(bytes.substr(0, first_end)) != std::vector<std::string_view>{"ply"}) {
        return Error{ErrorKind::bad_input,
                     fmt::format("{}: not a PLY file: it does not begin with \"ply\"; check the "
                                 "format",
                                 context.name())};
    }
    // A line ends with LF, whatever others end with, and maybe CR before it; or, in old files, with
    // CR alone. A file's binary part may begin with any byte.
    const std::size_t feed = bytes.find('\n');
    const bool feeds = bytes[first_end] == '\n' || feed == first_end + 1;
    const char line_end = feeds ? '\n' : '\r';
    PlyHeader header;
    std::size_t start = (feeds ? feed : first_end) + 1;
    while (true) {
        const std::size_t end = bytes.find(line_end, start);
        std::string_view line = bytes.substr(start, std::min(end, bytes.size()) - start);
        if (line.ends_with('\r')) line.remove_suffix(1);
        const std::vector<std::string_view> words = words_of(line);
        const bool last = words.size() == 1 && words[0] == "end_header";
        header.size = end == std::string_view::npos ? bytes.size() : end + 1;
        if (last) return header;
        if (end == std::string_view::npos) {
            return context.unreadable("ply", "it ends within its header");
        }
        if (!take_line(words, header)) {
            return context.at_line(bytes, start,
                                   fmt::format("'{}' is no line of a PLY header", one_line(line)));
        }
        start = end + 1;
    }
}

}  // namespace sightline::load
