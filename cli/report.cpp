// Tables and JSON (the only file that includes the JSON library: it is heavy), and measuring.
#include "report.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "errors.hpp"
#include "image/write_all.hpp"
#include "scene/load/text.hpp"
#include "streams.hpp"

namespace sightline::cli {
namespace {

using Json = nlohmann::ordered_json;

struct JsonMaker {
    Json operator()(std::nullptr_t) const { return nullptr; }
    Json operator()(bool flag) const { return flag; }
    Json operator()(std::uint64_t number) const { return number; }
    Json operator()(double number) const { return number; }
    Json operator()(const std::string& text) const { return text; }
    Json operator()(const Value::List& list) const {
        Json json = Json::array();
        for (const Value& item : list) json.push_back(std::visit(*this, item.data()));
        return json;
    }
    Json operator()(const Value::Object& object) const {
        // As they are, also one that is there twice: the tests find it, while the last one would
        // silently take the place of the first.
        Json::object_t members;
        for (const auto& [key, value] : object) {
            members.push_back({key, std::visit(*this, value.data())});
        }
        return members;
    }
};

std::string cell(const Value& value) {
    const Value::Data& data = value.data();
    if (const auto* text = std::get_if<std::string>(&data)) return load::clean_text(*text);
    if (const auto* number = std::get_if<double>(&data)) return fmt::format("{:.2f}", *number);
    if (const auto* flag = std::get_if<bool>(&data)) return *flag ? "yes" : "no";
    return to_json(value);
}

bool is_number(std::string_view text) {
    return !text.empty() && text.find_first_not_of("0123456789.-+e%") == std::string_view::npos;
}

/// JSON allows the control characters from U+007F on as they are; some terminals obey them.
std::string with_controls_escaped(const std::string& json) {
    std::string text;
    text.reserve(json.size());
    for (std::size_t i = 0; i < json.size(); ++i) {
        const auto byte = static_cast<unsigned char>(json[i]);
        const bool two = byte == 0xc2 && i + 1 < json.size();
        const unsigned code = two ? static_cast<unsigned char>(json[i + 1]) : byte;
        if (code < 0x7f || code > 0x9f || (!two && byte != 0x7f)) {
            text += json[i];
        } else {
            text += fmt::format("\\u{:04x}", code);
            i += two;
        }
    }
    return text;
}

/// "VmHWM:   1234 kB" of /proc/self/status.
std::optional<double> high_water_mib() {
    std::ifstream status("/proc/self/status");
    std::string word;
    while (status >> word) {
        double kib = 0;
        if (word == "VmHWM:" && status >> kib) return kib / 1024;
    }
    return std::nullopt;
}

}  // namespace

std::string to_json(const Value& value) {
    const Json json = std::visit(JsonMaker{}, value.data());
    return with_controls_escaped(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::optional<Value::Object> parse_flat_json(std::string_view text) {
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object()) return std::nullopt;
    Value::Object object;
    for (const auto& [key, value] : json.items()) {
        if (value.is_string()) object.emplace_back(key, value.get<std::string>());
        if (value.is_boolean()) object.emplace_back(key, value.get<bool>());
        if (value.is_number()) object.emplace_back(key, value.get<double>());
    }
    return object;
}

Value milliseconds(double ms) { return std::round(ms * 1000) / 1000; }

std::string to_table(const std::vector<Row>& rows) {
    std::size_t left = 0, right = 0;
    for (const Row& row : rows) {
        left = std::max(left, row.title.size());
        if (!std::holds_alternative<std::string>(row.value.data())) {
            right = std::max(right, cell(row.value).size());
        }
    }
    std::string table;
    for (const Row& row : rows) {
        table +=
            fmt::format("{:<{}}  {:>{}} {}", row.title, left, cell(row.value), right, row.unit);
        while (table.back() == ' ') table.pop_back();
        table += '\n';
    }
    return table;
}

Value::Object to_object(const std::vector<Row>& rows) {
    Value::Object object;
    for (const Row& row : rows) object.emplace_back(row.key, row.value);
    return object;
}

std::string to_grid(const std::vector<std::vector<std::string>>& rows) {
    std::vector<std::size_t> widths;
    for (const auto& row : rows) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
    }
    std::vector<bool> is_right(widths.size(), rows.size() > 1);
    for (std::size_t r = 1; r < rows.size(); ++r) {
        for (std::size_t i = 0; i < widths.size(); ++i) {
            is_right[i] = is_right[i] && i < rows[r].size() && is_number(rows[r][i]);
        }
    }
    std::string grid;
    for (const auto& row : rows) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            const std::string text = load::clean_text(row[i]);
            grid += is_right[i] ? fmt::format("{:>{}}  ", text, widths[i])
                                : fmt::format("{:<{}}  ", text, widths[i]);
        }
        while (!grid.empty() && grid.back() == ' ') grid.pop_back();
        grid += '\n';
    }
    return grid;
}

Status print(std::string_view text) {
    const int error_number = write_all(STDOUT_FILENO, text.data(), text.size());
    if (error_number == 0) return success();
    return failure("cannot write to standard output: {}; free some space or write elsewhere",
                   std::system_category().message(error_number));
}

Status print_rows(const std::vector<Row>& rows, bool as_table, bool as_json) {
    if (as_table) tell(to_table(rows));
    return as_json ? print(to_json(to_object(rows)) + "\n") : success();
}

double peak_memory_mib() {
    if (const auto mib = high_water_mib()) return *mib;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

bool reset_peak_memory() {
    std::ofstream clear("/proc/self/clear_refs");
    clear << "5" << std::flush;
    return clear.good();
}

}  // namespace sightline::cli
