#include "scene/load/text.hpp"

#include <algorithm>
#include <filesystem>

namespace sightline::load {
namespace {

constexpr std::size_t kLongestMessage = 200;

/// Whether a character of three bytes breaks lines or changes the order in which a terminal shows
/// what stands around it: U+200E, U+200F, U+2028 to U+202E, U+2066 to U+2069.
bool turns_text(std::string_view character) {
    if (character.size() != 3 || character[0] != '\xe2') return false;
    const auto second = static_cast<unsigned char>(character[1]),
               third = static_cast<unsigned char>(character[2]);
    if (second == 0x81) return third >= 0xa6 && third <= 0xa9;
    return second == 0x80 && (third == 0x8e || third == 0x8f || (third >= 0xa8 && third <= 0xae));
}

/// Length of the well-formed UTF-8 character (RFC 3629) that the text begins with, or 0.
std::size_t character_length(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned lead = byte(0);
    if (lead < 0x80) return lead >= 0x20 && lead != 0x7f ? 1 : 0;
    const std::size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
    if (lead < 0xc2 || lead > 0xf4 || text.size() < length) return 0;
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xc0) != 0x80) return 0;
    }
    // Over-long forms, surrogates, and what lies beyond U+10FFFF.
    // Control characters again, which some terminals obey: U+0080 to U+009F.
    const unsigned second = byte(1);
    const bool wrong = (lead == 0xc2 && second < 0xa0) || (lead == 0xe0 && second < 0xa0) ||
                       (lead == 0xed && second > 0x9f) || (lead == 0xf0 && second < 0x90) ||
                       (lead == 0xf4 && second > 0x8f);
    return wrong || turns_text(text.substr(0, length)) ? 0 : length;
}

}  // namespace

std::string_view text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kWhiteSpace = " \t\v\f\r\n";
    const std::size_t first = text.find_first_not_of(kWhiteSpace);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kWhiteSpace) + 1 - first);
}

std::string clean_text(std::string_view text) {
    std::string clean;
    clean.reserve(text.size());
    while (!text.empty()) {
        const std::size_t length = character_length(text);
        if (length == 0) {
            clean += '?';
        } else {
            clean += text.substr(0, length);
        }
        text.remove_prefix(std::max<std::size_t>(length, 1));
    }
    return clean;
}

std::string_view without_mark(std::string_view text) {
    constexpr std::string_view kMark = "\xef\xbb\xbf";
    if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
    return text;
}

bool is_utf16(std::string_view text) {
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) return true;
    if (text.size() < 4) return false;
    const auto zeros = [&](std::size_t first) {
        return text[first] == '\0' && text[first + 2] == '\0' && text[1 - first] != '\0' &&
               text[3 - first] != '\0';
    };
    return zeros(0) || zeros(1);
}

std::string portable_path(std::string_view path) {
    std::string portable(path);
    std::ranges::replace(portable, '\\', '/');
    return portable;
}

std::string_view last_component(std::string_view path) {
    return path.substr(path.find_last_of("/\\") + 1);
}

std::string extension_of(std::string_view path) {
    std::string extension = std::filesystem::path(path).extension().string();
    extension.erase(0, 1);
    for (char& c : extension) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return extension;
}

std::string stem_of(std::string_view path) { return std::filesystem::path(path).stem().string(); }

std::string one_line(std::string_view message) {
    message = message.substr(0, message.find_first_of("\r\n"));
    while (!message.empty() && (message.back() == ' ' || message.back() == '.')) {
        message.remove_suffix(1);
    }
    return clean_text(message.substr(0, kLongestMessage));
}

std::string shortened(std::string_view text) {
    constexpr std::size_t kLongest = 80;
    constexpr std::string_view kMore = "...";
    if (text.size() <= kLongest) return std::string(text);
    std::size_t end = kLongest - kMore.size();
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;  // of UTF-8
    return std::string(text.substr(0, end)).append(kMore);
}

}  // namespace sightline::load
