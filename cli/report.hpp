// What a command found out, as data: printed as JSON or as a table.
#pragma once

#include <chrono>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "sightline/error.hpp"

namespace sightline::cli {

/// A JSON value; objects keep the order of their keys. A number that is not finite becomes null.
class Value {
public:
    using List = std::vector<Value>;
    using Object = std::vector<std::pair<std::string, Value>>;
    using Data =
        std::variant<std::nullptr_t, bool, std::uint64_t, double, std::string, List, Object>;

    Value() : data_(nullptr) {}
    Value(bool flag) : data_(flag) {}
    Value(int number) : data_(static_cast<std::uint64_t>(number)) {}
    Value(std::uint32_t number) : data_(std::uint64_t{number}) {}
    Value(std::uint64_t number) : data_(number) {}
    Value(double number) : data_(number) {}
    Value(const char* text) : data_(std::string(text)) {}
    Value(std::string_view text) : data_(std::string(text)) {}
    Value(std::string text) : data_(std::move(text)) {}
    Value(List list) : data_(std::move(list)) {}
    Value(Object object) : data_(std::move(object)) {}
    Value(glm::dvec2 v) : data_(List{v.x, v.y}) {}
    Value(glm::dvec3 v) : data_(List{v.x, v.y, v.z}) {}

    [[nodiscard]] const Data& data() const { return data_; }

private:
    Data data_;
};

/// On one line, without the line's end. Bytes that are no UTF-8 are replaced.
[[nodiscard]] std::string to_json(const Value& value);

/// The text, numbers and flags at the top level of one JSON object; values that are lists or
/// objects are left out. Nothing where the text is no JSON object.
[[nodiscard]] std::optional<Value::Object> parse_flat_json(std::string_view text);

/// A number of milliseconds, rounded to what can be measured.
[[nodiscard]] Value milliseconds(double ms);

/// One row of --stats, which --json prints too.
struct Row {
    std::string key;    ///< of JSON: snake_case
    std::string title;  ///< of the table
    Value value;
    std::string unit;  ///< of the table: "ms", "MiB", ...
};

/// A table with one row a line, for people.
[[nodiscard]] std::string to_table(const std::vector<Row>& rows);
[[nodiscard]] Value::Object to_object(const std::vector<Row>& rows);

/// Rows of cells with aligned columns; the first row is the heading. Numbers go to the right.
[[nodiscard]] std::string to_grid(const std::vector<std::vector<std::string>>& rows);

/// Writes to standard output and makes sure that it arrived.
[[nodiscard]] Status print(std::string_view text);

/// What --stats and --json ask for: a table on standard error, one line on standard output.
[[nodiscard]] Status print_rows(const std::vector<Row>& rows, bool as_table, bool as_json);

/// Time since it was made or restarted.
class Stopwatch {
public:
    [[nodiscard]] double ms() const {
        return std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
    }
    /// The time until now; begins anew.
    double lap() {
        const double elapsed = ms();
        start_ = Clock::now();
        return elapsed;
    }

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
};

/// Largest resident memory of this process so far, in MiB.
[[nodiscard]] double peak_memory_mib();
/// Starts measuring the peak anew; false where the system doesn't allow it.
bool reset_peak_memory();

}  // namespace sightline::cli
