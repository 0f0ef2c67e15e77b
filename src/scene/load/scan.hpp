// Words and numbers of text formats, scanned in place.
//
// Every text here ends with '\n', which ends every loop: no function reads past it. Numbers are
// rounded correctly to float or double, as the caller asks: most of them by one exact division or
// multiplication in double (William D. Clinger, "How to read floating point numbers accurately",
// 1990), the rest by std::from_chars.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

namespace sightline::load {

inline bool is_digit(char c) { return static_cast<unsigned char>(c - '0') < 10; }
inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
inline bool is_line_end(char c) { return c == '\n' || c == '\r'; }

inline const char* skip_blanks(const char* p) {
    while (is_blank(*p)) ++p;
    return p;
}
/// The end of the line that p stands in.
inline const char* skip_to_line_end(const char* p) {
    while (!is_line_end(*p)) ++p;
    return p;
}
/// The end of the word that p stands in.
inline const char* skip_word(const char* p) {
    while (!is_line_end(*p) && !is_blank(*p)) ++p;
    return p;
}
/// What stands between p and the end of its line, without blanks around it.
[[nodiscard]] std::string_view rest_of_line(const char* p);

/// Whether the text begins with this word in lower-case ASCII letters, in capitals or not.
[[nodiscard]] bool starts_with_word(const char* p, std::string_view lower_case);

/// Number of the line (from 1) that the byte at `offset` stands in; CR, LF and CR LF end lines.
[[nodiscard]] std::size_t line_number(std::string_view text, std::size_t offset);

/// What scan_real() leaves to the general routine: long or special numbers, and nonsense.
[[nodiscard]] const char* scan_unusual_real(const char* p, float& value);
[[nodiscard]] const char* scan_unusual_real(const char* p, double& value);

/// Scans a decimal number as a float or a double, correctly rounded (too large: infinite), "inf" or
/// "nan" (also as Microsoft's libraries write it). The end of the number, or nullptr when there is
/// none.
template <class Real>
const char* scan_real(const char* const begin, Real& value) {
    static constexpr std::array<double, 23> kPowers = {
        1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
        1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    constexpr std::ptrdiff_t kMostDigits = 19;  // of an integer that fits 64 bits
    const char* p = begin;
    const bool negative = *p == '-';
    if (negative || *p == '+') ++p;
    std::uint64_t digits = 0;
    const char* const first = p;
    for (; is_digit(*p); ++p) digits = 10 * digits + static_cast<unsigned>(*p - '0');
    std::ptrdiff_t count = p - first, exponent = 0;
    if (*p == '.') {
        const char* const fraction = ++p;
        for (; is_digit(*p); ++p) digits = 10 * digits + static_cast<unsigned>(*p - '0');
        exponent = fraction - p;
        count += p - fraction;
    }
    if (*p == 'e' || *p == 'E') {
        const char* q = p + 1;
        const bool minus = *q == '-';
        if (minus || *q == '+') ++q;
        const char* const power = q;
        int stated = 0;
        for (; is_digit(*q) && q - power < 4; ++q) stated = 10 * stated + (*q - '0');
        if (q == power || is_digit(*q)) return scan_unusual_real(begin, value);
        exponent += minus ? -stated : stated;
        p = q;
    }
    if (count == 0 || count > kMostDigits || *p == '#' || digits > (std::uint64_t{1} << 53) ||
        exponent < -22 || exponent > 22) {
        return scan_unusual_real(begin, value);
    }
    // Both operands are exact, so the double is rounded once.
    const auto integer = static_cast<double>(digits);
    const double exact = exponent < 0 ? integer / kPowers[static_cast<std::size_t>(-exponent)]
                                      : integer * kPowers[static_cast<std::size_t>(exponent)];
    if constexpr (std::is_same_v<Real, float>) {
        // Rounding it again is right unless it lies exactly between two floats, where what the
        // first rounding dropped decides.
        constexpr std::uint64_t kDropped = (std::uint64_t{1} << 29) - 1, kHalf = kDropped / 2 + 1;
        if ((std::bit_cast<std::uint64_t>(exact) & kDropped) == kHalf) {
            return scan_unusual_real(begin, value);
        }
    }
    value = static_cast<Real>(negative ? -exact : exact);
    return p;
}

/// Scans a decimal integer, of which the first 18 digits count. The end of it, or nullptr when
/// there is none.
inline const char* scan_integer(const char* p, std::int64_t& value) {
    constexpr std::int64_t kLongest = 100'000'000'000'000'000;  // nothing is appended from here on
    const bool negative = *p == '-';
    if (negative || *p == '+') ++p;
    if (!is_digit(*p)) return nullptr;
    std::int64_t size = 0;
    for (; is_digit(*p); ++p) {
        if (size < kLongest) size = 10 * size + (*p - '0');
    }
    value = negative ? -size : size;
    return p;
}

}  // namespace sightline::load
