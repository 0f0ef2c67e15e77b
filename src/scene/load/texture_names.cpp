#include "scene/load/texture_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>
#include <utility>

#include "scene/load/scan.hpp"
#include "scene/load/text.hpp"

namespace sightline::load {
namespace {

constexpr std::string_view kBlanks = " \t\v\f\r\n";

std::string_view first_word(std::string_view text) {
    return text.substr(0, text.find_first_of(kBlanks));
}

std::string_view without_first_word(std::string_view text) {
    return trimmed(text.substr(first_word(text).size()));
}

std::string_view last_word(std::string_view text) {
    return text.substr(text.find_last_of(kBlanks) + 1);
}

class Names {
public:
    void add(std::string_view name) {
        name = trimmed(name);
        if (!name.empty() && std::ranges::find(all_, name) == all_.end()) all_.emplace_back(name);
    }
    /// A name that may stand in quotes.
    void add_quoted(std::string_view name) {
        name = trimmed(name);
        if (name.starts_with('"') || name.starts_with('\'')) {
            add(name.substr(1, name.find(name.front(), 1) - 1));
        }
        add(name);
    }
    void add_line(std::string_view text) {
        text = trimmed(text);
        for (const std::string_view comment : {" #", "\t#"}) {
            add_quoted(text.substr(0, text.find(comment)));
        }
        add_quoted(text);
        add_quoted(last_word(text));
    }
    [[nodiscard]] std::vector<std::string> take() { return std::move(all_); }

private:
    std::vector<std::string> all_;
};

bool is_number(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double number = 0;
    const char* const end = word.data() + word.size();
    const auto [stop, problem] = std::from_chars(word.data(), end, number);
    return problem == std::errc() && stop == end;
}

/// How many words belong to an option of a texture; 0 when the word is none.
int arguments_of(std::string_view word) {
    constexpr std::array<std::pair<std::string_view, int>, 14> kOptions = {{
        {"-blendu", 1},
        {"-blendv", 1},
        {"-boost", 1},
        {"-mm", 2},
        {"-o", 3},
        {"-s", 3},
        {"-t", 3},
        {"-texres", 1},
        {"-clamp", 1},
        {"-bm", 1},
        {"-imfchan", 1},
        {"-type", 1},
        {"-cc", 1},
        {"-colorspace", 1},
    }};
    const auto* const found =
        std::ranges::find(kOptions, word, [](const auto& option) { return option.first; });
    return found == kOptions.end() ? 0 : found->second;
}

}  // namespace

std::vector<std::string> names_in(std::string_view text) {
    Names names;
    names.add_line(text);
    return names.take();
}

std::vector<std::string> names_in_map(std::string_view text) {
    text = trimmed(text);
    std::string_view rest = text, arguments;  // `arguments`: of the last option, and all after it
    while (const int most = arguments_of(first_word(rest))) {
        arguments = rest = without_first_word(rest);
        // Of several numbers the last ones may be left out.
        for (int i = 0; i < most && (most == 1 || is_number(first_word(rest))); ++i) {
            rest = without_first_word(rest);
        }
    }
    Names names;
    for (std::string_view tail = rest; !tail.empty(); tail = without_first_word(tail)) {
        if (arguments_of(first_word(tail)) == 0) continue;  // some write the options at the end
        names.add_line(rest.substr(0, rest.size() - tail.size()));
        break;
    }
    names.add_line(rest);
    for (; arguments.size() > rest.size(); arguments = without_first_word(arguments)) {
        names.add_quoted(arguments);
    }
    names.add(text);
    return names.take();
}

std::vector<std::string> places_of(const std::filesystem::path& folder, std::string_view name) {
    const std::string portable = portable_path(name);
    std::vector<std::string> places = {(folder / name).string()};
    if (portable != name) places.push_back((folder / portable).string());
    std::error_code ignored;
    const std::string_view last = last_component(portable);
    if (last != portable && !last.empty() && !std::filesystem::exists(places.back(), ignored)) {
        places.push_back((folder / last).string());
    }
    return places;
}

TextureNames textures_in(const std::vector<std::string>& texts, const std::string& model) {
    const std::filesystem::path folder = std::filesystem::path(model).parent_path();
    TextureNames result;
    for (const std::string& text : texts) {
        const std::vector<std::string> names = names_in(text);
        if (!names.empty()) result.names.insert(names.front());
        if (model.empty()) continue;
        for (const std::string& name : names) {
            const std::vector<std::string> places = places_of(folder, name);
            result.places.insert(result.places.end(), places.begin(), places.end());
        }
    }
    return result;
}

std::string note_of_textures(const std::set<std::string>& names) {
    if (names.empty()) return {};
    return fmt::format("textures are not drawn: {} ('{}'{})", names.size(),
                       one_line(*names.begin()), names.size() > 1 ? ", ..." : "");
}

}  // namespace sightline::load
