#include "scene/load/json_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "scene/load/text.hpp"

namespace sightline::load {
namespace {

std::string joined(std::initializer_list<std::string_view> words) {
    std::string text;
    for (const std::string_view word : words) {
        if (!text.empty()) text += ", ";
        text += word;
    }
    return text;
}

/// What a message about a file begins with.
std::string beginning_with(const std::string& name) { return name.empty() ? "" : name + ": "; }

/// Notices keys that stand twice in one object; JSON leaves their meaning open.
class KeyWatch {
public:
    bool operator()(nlohmann::json::parse_event_t event, const nlohmann::json& parsed) {
        using Event = nlohmann::json::parse_event_t;
        if (event == Event::object_start) open_.emplace_back();
        if (event == Event::object_end) open_.pop_back();
        if (event == Event::key && !open_.back().insert(parsed.get<std::string>()).second) {
            throw JsonFault{clean_text(parsed.get<std::string>()),
                            "this key stands twice in one object"};
        }
        return true;
    }

private:
    std::vector<std::set<std::string>> open_;
};

}  // namespace

void JsonValue::fail(std::string problem) const { throw JsonFault{path_, std::move(problem)}; }

std::string JsonValue::text() const {
    if (!value_->is_string()) fail("expected a string");
    return value_->get<std::string>();
}

double JsonValue::number() const {
    if (!value_->is_number()) fail("expected a number");
    const double number = value_->get<double>();
    if (!std::isfinite(number)) fail("expected a finite number");
    return number;
}

double JsonValue::number_in(double least, double most) const {
    const double value = number();
    if (value < least || value > most) {
        fail(fmt::format("expected a number from {:g} to {:g}", least, most));
    }
    return value;
}

double JsonValue::positive() const {
    const double value = number();
    if (!(value > 0)) fail("expected a number above 0");
    return value;
}

glm::dvec3 JsonValue::vector() const {
    if (!value_->is_array() || value_->size() != 3 ||
        !std::ranges::all_of(*value_, [](const auto& v) { return v.is_number(); })) {
        fail("expected [x, y, z], three numbers");
    }
    const std::vector<JsonValue> all = items();
    return {all[0].number(), all[1].number(), all[2].number()};
}

glm::dvec3 JsonValue::direction() const {
    const glm::dvec3 direction = vector();
    if (direction == glm::dvec3{0, 0, 0}) fail("expected a direction other than [0, 0, 0]");
    return direction;
}

std::vector<JsonValue> JsonValue::items() const {
    if (!value_->is_array()) fail("expected a list");
    std::vector<JsonValue> all;
    for (const auto& item : *value_) {
        all.emplace_back(item, fmt::format("{}[{}]", path_, all.size()));
    }
    return all;
}

void JsonValue::allow_keys(std::initializer_list<std::string_view> keys) const {
    if (!value_->is_object())
        fail(fmt::format("expected an object with the keys {}", joined(keys)));
    for (const auto& [key, value] : value_->items()) {
        if (std::ranges::find(keys, key) != keys.end()) continue;
        const std::string unknown = clean_text(key);
        throw JsonFault{path_.empty() ? unknown : path_ + "." + unknown,
                        fmt::format("unknown key; known ones are {}", joined(keys))};
    }
}

JsonValue JsonValue::at(const char* key) const {
    std::string path = path_.empty() ? key : path_ + "." + key;
    if (!has(key)) throw JsonFault{std::move(path), "missing"};
    return JsonValue(value_->at(key), std::move(path));
}

std::string JsonValue::only_key() const {
    if (!value_->is_object() || value_->size() != 1) fail("expected an object with one key");
    return value_->begin().key();
}

Result<nlohmann::json> parse_json(std::string_view text, const std::string& name) {
    // The parser takes this byte for the end of the text.
    if (const std::size_t nul = text.find('\0'); nul != std::string_view::npos) {
        return Error{ErrorKind::bad_input, fmt::format("{}not valid JSON: byte {} is NUL",
                                                       beginning_with(name), nul + 1)};
    }
    KeyWatch watch;
    try {
        return nlohmann::json::parse(
            text, [&](int, nlohmann::json::parse_event_t event, nlohmann::json& parsed) {
                return watch(event, parsed);
            });
    } catch (const JsonFault& fault) {
        return json_error(name, fault);
    } catch (const nlohmann::json::exception& exception) {
        // "[json.exception.parse_error.101] parse error at line 1, column 2: ..."
        std::string_view what = exception.what();
        what.remove_prefix(std::min(what.size(), what.find("] ") + 2));
        return Error{ErrorKind::bad_input,
                     fmt::format("{}not valid JSON: {}", beginning_with(name), one_line(what))};
    }
}

Error json_error(const std::string& name, const JsonFault& fault) {
    const std::string where = fault.path.empty() ? "" : fault.path + ": ";
    return {ErrorKind::bad_input,
            fmt::format("{}{}{}", beginning_with(name), where, fault.problem)};
}

}  // namespace sightline::load
