// Heights from tables in text: one row a line.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <string_view>

#include "plot/height_table.hpp"
#include "scene/load/text.hpp"

namespace sightline::heights {
namespace {

constexpr double kNoData = std::numeric_limits<double>::quiet_NaN();
constexpr char kRunOfBlanks = ' ';

bool is_blank(char c) { return c == ' ' || c == '\t'; }

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

/// How many characters stand before the first that is such; quicker than find_first_of().
template <class Is>
std::size_t count_until(std::string_view text, const Is& is) {
    return static_cast<std::size_t>(std::find_if(text.begin(), text.end(), is) - text.begin());
}

/// Takes the next line, which LF, CR or CR LF ends, off the text.
std::string_view take_line(std::string_view& text) {
    const auto is_end = [](char c) { return c == '\n' || c == '\r'; };
    const std::size_t end = count_until(text, is_end);
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end);
    if (text.starts_with("\r\n")) {
        text.remove_prefix(2);
    } else if (!text.empty()) {
        text.remove_prefix(1);
    }
    return line;
}

/// What separates the numbers of this line. Semicolons come first: whoever uses them may have
/// commas for other things. Tabs with spaces among them only align what blanks separate.
char separator_of(std::string_view line) {
    for (const char candidate : {';', ','}) {
        if (line.find(candidate) != std::string_view::npos) return candidate;
    }
    const bool has_tabs = line.find('\t') != std::string_view::npos;
    return has_tabs && line.find(' ') == std::string_view::npos ? '\t' : kRunOfBlanks;
}

/// Takes the next field, without blanks around it, off the line; `more` tells whether another one
/// follows.
std::string_view take_field(std::string_view& line, char separator, bool& more) {
    const bool blanks = separator == kRunOfBlanks;
    const std::size_t end =
        count_until(line, [&](char c) { return blanks ? is_blank(c) : c == separator; });
    more = end < line.size();
    const std::string_view field = line.substr(0, end);
    line.remove_prefix(more ? end + 1 : end);
    if (blanks) {
        while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
    }
    return trimmed(field);
}

bool is_na(std::string_view field) {
    return field.size() == 2 && (field[0] | 0x20) == 'n' && (field[1] | 0x20) == 'a';
}

/// What keeps a field from being a height; nothing when it is one.
const char* parse(std::string_view field, double& value) {
    value = kNoData;
    if (field.empty() || is_na(field)) return nullptr;
    if (field.front() == '+' && !field.starts_with("+-")) field.remove_prefix(1);
    const char* const end = field.data() + field.size();
    const std::from_chars_result result = std::from_chars(field.data(), end, value);
    if (result.ec == std::errc::invalid_argument || result.ptr != end) return "is no number";
    if (result.ec != std::errc()) return "is beyond the range of numbers";
    return nullptr;
}

class TableParser {
public:
    TableParser(std::string_view text, const std::string& name)
        : text_(text), size_(text.size()), name_(name) {}

    [[nodiscard]] Result<HeightTable> parse_all() {
        constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
        if (text_.starts_with(kByteOrderMark)) text_.remove_prefix(kByteOrderMark.size());
        while (!text_.empty()) {
            const std::string_view whole = take_line(text_);
            ++line_number_;
            const std::string_view line = whole.substr(0, whole.find('#'));
            if (trimmed(line).empty()) continue;
            if (std::optional<Error> error = add_row(line)) return std::move(*error);
        }
        return std::move(table_);
    }

private:
    [[nodiscard]] Error wrong(const std::string& what) const {
        return {ErrorKind::bad_input, fmt::format("{}:{}: {}", name_, line_number_, what)};
    }
    [[nodiscard]] Error wrong_field(std::size_t column, std::string_view field,
                                    const char* what) const {
        constexpr std::size_t kShown = 40;
        return wrong(
            fmt::format("column {}: '{}' {}; write heights as 1234.5, nothing or nan "
                        "where there are none, and # before comments",
                        column, load::clean_text(field.substr(0, kShown)), what));
    }

    [[nodiscard]] std::optional<Error> add_row(std::string_view line) {
        const bool is_first = table_.rows == 0;
        if (is_first) separator_ = separator_of(line);
        const std::size_t line_size = line.size();
        if (separator_ == kRunOfBlanks) line = trimmed(line);
        std::size_t columns = 0;
        for (bool more = true; more; ++columns) {
            const std::string_view field = take_field(line, separator_, more);
            double value = 0;
            if (const char* problem = parse(field, value)) {
                return wrong_field(columns + 1, field, problem);
            }
            table_.values.push_back(value);
        }
        ++table_.rows;
        if (is_first) {
            table_.columns = columns;
            const std::uint64_t expected = columns * (size_ / line_size + 1);
            table_.values.reserve(std::min(expected, kMostNodes));
        }
        if (columns != table_.columns) {
            return wrong(
                fmt::format("{} heights, but the rows before have {}; give all rows as "
                            "many (empty ones count)",
                            columns, table_.columns));
        }
        return too_many_nodes(name_, table_.columns, table_.rows);
    }

    std::string_view text_;  ///< what is left
    std::size_t size_;
    const std::string& name_;
    std::size_t line_number_ = 0;
    char separator_ = kRunOfBlanks;
    HeightTable table_;
};

}  // namespace

Result<HeightTable> read_csv_heights(std::span<const std::byte> bytes, const std::string& name) {
    return TableParser(load::text_of(bytes), name).parse_all();
}

}  // namespace sightline::heights
