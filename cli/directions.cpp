#include "directions.hpp"

#include <algorithm>
#include <optional>
#include <string_view>

#include "errors.hpp"
#include "options.hpp"
#include "scene/load/input.hpp"
#include "scene/load/text.hpp"

namespace sightline::cli {
namespace {

constexpr std::size_t kLargestFile = std::size_t{1} << 26;
constexpr std::string_view kBlanks = " \t\r\v\f,";

/// The words of a line, as many as three and one more.
std::vector<std::string_view> words_of(std::string_view line) {
    std::vector<std::string_view> words;
    while (words.size() <= 3) {
        line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
        if (line.empty()) break;
        const std::size_t end = std::min(line.find_first_of(kBlanks), line.size());
        words.push_back(line.substr(0, end));
        line.remove_prefix(end);
    }
    return words;
}

/// Nothing: it is no direction.
std::optional<glm::dvec3> direction_of(const std::vector<std::string_view>& words) {
    glm::dvec3 direction(0);
    if (words.size() != 3) return std::nullopt;
    for (int k = 0; k < 3; ++k) {
        const auto value = parse_number(words[static_cast<std::size_t>(k)]);
        if (!value) return std::nullopt;
        direction[k] = *value;
    }
    if (direction == glm::dvec3(0)) return std::nullopt;
    return direction;
}

}  // namespace

Result<std::vector<glm::dvec3>> read_directions(const std::string& path) {
    const auto file = load::InputFile::open(path, kLargestFile);
    if (!file) return file.error();
    const auto bytes = file->read_all();
    if (!bytes) return bytes.error();
    std::string_view text = load::without_mark(load::text_of(*bytes));
    std::vector<glm::dvec3> directions;
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        line = line.substr(0, line.find('#'));
        const auto words = words_of(line);
        if (words.empty()) continue;
        const auto direction = direction_of(words);
        if (!direction) {
            return failure("{}:{}: not a direction x,y,z other than 0,0,0; write three numbers",
                           path, number);
        }
        directions.push_back(*direction);
    }
    if (directions.empty()) return failure("{}: no direction in it; write one x,y,z a line", path);
    return directions;
}

}  // namespace sightline::cli
