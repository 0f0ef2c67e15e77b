#include "scene/load/scan.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <system_error>

namespace sightline::load {
namespace {

/// What a number beyond the range of doubles rounds to: zero or infinity.
template <class Real>
Real out_of_range(std::string_view number) {
    const bool negative = number.starts_with('-');
    const std::size_t exponent = number.find_first_of("eE");
    bool tiny = false;
    if (exponent != std::string_view::npos) {
        tiny =
            number.substr(exponent).starts_with("e-") || number.substr(exponent).starts_with("E-");
    } else {
        const std::string_view integer = number.substr(0, number.find('.'));
        tiny = integer.find_first_of("123456789") == std::string_view::npos;
    }
    const Real size = tiny ? Real{0} : std::numeric_limits<Real>::infinity();
    return negative ? -size : size;
}

template <class Real>
const char* scan_unusual(const char* p, Real& value) {
    if (*p == '+') ++p;
    const char* const end = skip_word(p);
    Real read = 0;
    const std::from_chars_result result = std::from_chars(p, end, read);
    if (result.ec == std::errc::invalid_argument) return nullptr;
    if (result.ec == std::errc::result_out_of_range) {
        double wide = 0;
        const bool fits = std::from_chars(p, end, wide).ec == std::errc();
        const std::string_view number(p, static_cast<std::size_t>(result.ptr - p));
        read = fits ? static_cast<Real>(wide) : out_of_range<Real>(number);
    }
    if (*result.ptr == '#') {  // 1.#QNAN, -1.#IND, 1.#INF
        const bool infinite = std::string_view(result.ptr, end).starts_with("#INF");
        const Real size = infinite ? std::numeric_limits<Real>::infinity()
                                   : std::numeric_limits<Real>::quiet_NaN();
        value = *p == '-' ? -size : size;
        return end;
    }
    value = read;
    return result.ptr;
}

}  // namespace

std::string_view rest_of_line(const char* p) {
    p = skip_blanks(p);
    const char* end = skip_to_line_end(p);
    while (end > p && is_blank(end[-1])) --end;
    return {p, static_cast<std::size_t>(end - p)};
}

bool starts_with_word(const char* p, std::string_view lower_case) {
    for (const char c : lower_case) {
        const char here = *p++;
        if (here != c && here != static_cast<char>(c - 'a' + 'A')) return false;
    }
    return is_blank(*p) || is_line_end(*p);
}

std::size_t line_number(std::string_view text, std::size_t offset) {
    std::size_t line = 1;
    for (std::size_t i = 0; i < std::min(offset, text.size()); ++i) {
        const bool first_of_two = text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n';
        if (is_line_end(text[i]) && !first_of_two) ++line;
    }
    return line;
}

const char* scan_unusual_real(const char* p, float& value) { return scan_unusual(p, value); }
const char* scan_unusual_real(const char* p, double& value) { return scan_unusual(p, value); }

}  // namespace sightline::load
