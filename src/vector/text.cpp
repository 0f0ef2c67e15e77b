// Text for files of drawings. Decimals are printed here, from integers: it is what writing an SVG
// takes its time with, and the numbers must add up when they are relative.
#include "vector/text.hpp"

#include <algorithm>
#include <array>

namespace sightline {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD

/// A character in front of `text`: its length in bytes and its number; length 0 when these bytes
/// are no UTF-8 (RFC 3629: no overlong forms, no surrogates, nothing above U+10FFFF).
struct Character {
    std::size_t length = 0;
    std::uint32_t number = 0;
};

Character first_character(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned lead = byte(0);
    if (lead < 0x80) return {1, lead};
    const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
    if (lead < 0xC2 || lead > 0xF4 || text.size() < length) return {};
    std::uint32_t number = lead & (0x7Fu >> length);
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xC0u) != 0x80u) return {};
        number = number << 6 | (byte(i) & 0x3Fu);
    }
    constexpr std::array<std::uint32_t, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
    const bool surrogate = number >= 0xD800 && number <= 0xDFFF;
    if (number < kLeast[length] || surrogate || number > 0x10FFFF) return {};
    return {length, number};
}

bool is_plain(std::uint32_t number) {
    const bool control = number < 0x20 || (number >= 0x7F && number < 0xA0);
    return !control && number != 0x2028 && number != 0x2029 && (number & 0xFFFE) != 0xFFFE;
}

std::string_view escaped(char c) {
    switch (c) {
        case '&':
            return "&amp;";
        case '<':
            return "&lt;";
        case '>':
            return "&gt;";
        case '"':
            return "&quot;";
        default:
            return {};
    }
}

}  // namespace

void TextSink::put(std::string_view text) {
    while (text.size() > kSize - used_) {
        const std::size_t part = kSize - used_;
        std::copy_n(text.data(), part, buffer_.data() + used_);
        used_ = kSize;
        flush();
        text.remove_prefix(part);
    }
    std::copy_n(text.data(), text.size(), buffer_.data() + used_);
    used_ += text.size();
}

void TextSink::put_integer(std::uint32_t n) { put_decimal(n, 0); }

void TextSink::put_decimal(std::int64_t n, int decimals) {
    std::array<char, kLongestNumber> digits;  // filled from its end
    char* const end = digits.data() + digits.size();
    char* begin = end;
    auto rest = static_cast<std::uint64_t>(n < 0 ? -n : n);
    bool any = false;  // a digit stands behind the point, and zeros before it count
    for (int k = 0; k < decimals; ++k) {
        const auto digit = static_cast<char>(rest % 10);
        rest /= 10;
        any = any || digit != 0;
        if (any) *--begin = static_cast<char>('0' + digit);
    }
    if (any) *--begin = '.';
    for (; rest > 0; rest /= 10) *--begin = static_cast<char>('0' + rest % 10);
    if (begin == end) *--begin = '0';
    if (n < 0) *--begin = '-';
    const auto length = static_cast<std::size_t>(end - begin);
    std::copy_n(begin, length, room(length));
    used_ += length;
}

void TextSink::flush() {
    static_cast<void>(file_->write(buffer_.data(), used_));
    used_ = 0;
}

DecimalGrid::DecimalGrid(int decimals) : decimals_(decimals) {
    for (int k = 0; k < decimals; ++k) factor_ *= 10;
}

std::int64_t DecimalGrid::round(double length) const {
    constexpr double kFarthest = 1e14;  // integers up to 2^53 = 9e15 are exact
    const double steps = std::clamp(length * factor_, -kFarthest, kFarthest);
    return static_cast<std::int64_t>(steps < 0 ? steps - 0.5 : steps + 0.5);
}

std::string clean_utf8(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    while (!text.empty()) {
        const Character c = first_character(text);
        const bool good = c.length > 0 && is_plain(c.number);
        out += good ? text.substr(0, c.length) : kReplacement;
        text.remove_prefix(std::max<std::size_t>(c.length, 1));
    }
    return out;
}

std::string xml_text(std::string_view text) {
    std::string out;
    for (const char c : clean_utf8(text)) {
        const std::string_view instead = escaped(c);
        if (instead.empty()) {
            out += c;
        } else {
            out += instead;
        }
    }
    return out;
}

}  // namespace sightline
