// Strict reading of JSON: every error names the value by its path, unknown keys are errors.
#pragma once

#include <glm/vec3.hpp>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "sightline/error.hpp"

namespace sightline::load {

/// Thrown by JsonValue and caught where a document is parsed; never leaves the library.
struct JsonFault {
    std::string path;     ///< such as models[1].transform[0].rotate
    std::string problem;  ///< such as "expected a number"
};

/// A value of a document and its path. Refers to the document, which must outlive it.
class JsonValue {
public:
    explicit JsonValue(const nlohmann::json& value, std::string path = {})
        : value_(&value), path_(std::move(path)) {}

    [[noreturn]] void fail(std::string problem) const;

    [[nodiscard]] bool is_array() const { return value_->is_array(); }
    [[nodiscard]] bool is_string() const { return value_->is_string(); }
    [[nodiscard]] bool is_number() const { return value_->is_number(); }

    // Each fails with "expected ..." when the value is something else.
    [[nodiscard]] std::string text() const;
    [[nodiscard]] double number() const;
    [[nodiscard]] double number_in(double least, double most) const;  ///< ends included
    [[nodiscard]] double positive() const;
    [[nodiscard]] glm::dvec3 vector() const;     ///< [x, y, z]
    [[nodiscard]] glm::dvec3 direction() const;  ///< a vector that is not zero
    [[nodiscard]] std::vector<JsonValue> items() const;

    /// Fails unless this is an object with keys from this list only.
    void allow_keys(std::initializer_list<std::string_view> keys) const;
    [[nodiscard]] bool has(const char* key) const { return value_->contains(key); }
    /// The value of a key; fails when it is absent.
    [[nodiscard]] JsonValue at(const char* key) const;
    /// Calls use(value of the key) when the key is there.
    template <class Use>
    void if_has(const char* key, const Use& use) const {
        if (has(key)) use(at(key));
    }
    /// The only key of an object; fails when there is none or another.
    [[nodiscard]] std::string only_key() const;

private:
    const nlohmann::json* value_;
    std::string path_;
};

/// Parses a document without NUL bytes in which no object has a key twice. `name` is the file in
/// messages; "" for messages without one.
[[nodiscard]] Result<nlohmann::json> parse_json(std::string_view text, const std::string& name);

/// "FILE: PATH: PROBLEM" as an error; without the file if that is "".
[[nodiscard]] Error json_error(const std::string& name, const JsonFault& fault);

}  // namespace sightline::load
