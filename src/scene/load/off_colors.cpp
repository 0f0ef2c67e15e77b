#include "scene/load/off_colors.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <vector>

#include "scene/load/scan.hpp"

namespace sightline::load {
namespace {

/// Takes lines off the text up to the first that holds words; '#' begins a comment.
void take_line(std::string_view& text, std::vector<std::string_view>& words) {
    words.clear();
    while (words.empty() && !text.empty()) {
        std::string_view line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(line.size() + 1, text.size()));
        line = line.substr(0, line.find('#'));
        while (!line.empty()) {
            const std::string_view word = line.substr(0, line.find_first_of(" \t\r"));
            if (!word.empty()) words.push_back(word);
            line.remove_prefix(std::min(word.size() + 1, line.size()));
        }
    }
}

std::uint64_t number_of(std::string_view word) {
    std::uint64_t number = 0;
    std::from_chars(word.data(), word.data() + word.size(), number);
    return number;
}

}  // namespace

bool off_has_face_colors(std::string_view text) {
    constexpr std::uint64_t kMostCorners = 1'000'000;
    std::vector<std::string_view> words;
    take_line(text, words);
    if (!words.empty() && !is_digit(words[0][0])) words.erase(words.begin());  // "OFF"
    if (words.empty()) take_line(text, words);
    if (words.size() < 2) return false;
    for (std::uint64_t i = number_of(words[0]); i > 0 && !text.empty(); --i) take_line(text, words);
    take_line(text, words);
    // One number more would be an index into a table of colours that nobody has.
    return !words.empty() && number_of(words[0]) < kMostCorners &&
           words.size() >= number_of(words[0]) + 4;
}

}  // namespace sightline::load
