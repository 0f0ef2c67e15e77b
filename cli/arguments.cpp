// Parsing with CLI11 (the only file that includes it: it is heavy). CLI11 sorts the words; its
// exceptions become errors of one line here, and the values stay text until options.cpp reads them.
#include "arguments.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>

#include "errors.hpp"
#include "suggest.hpp"

namespace sightline::cli {
namespace {

std::vector<std::string_view> option_names(const Command& command) {
    std::vector<std::string_view> names;
    for (const OptionGroup& group : command.groups) {
        for (const Option& option : group.options) names.push_back(option.name);
    }
    return names;
}

const Option* find_option(const Command& command, std::string_view word) {
    for (const OptionGroup& group : command.groups) {
        for (const Option& option : group.options) {
            if (word == option.name || (word == option.short_name && !word.empty())) {
                return &option;
            }
        }
    }
    return nullptr;
}

Error unknown_option(const Command& command, std::string_view word) {
    const std::string_view name = word.substr(0, word.find('='));
    return wrong_use("unknown option '{}' of '{}'; {}", name, command.name,
                     did_you_mean(name, option_names(command),
                                  fmt::format("'sightline {} --help' lists them", command.name)));
}

/// What CLI11 would let pass: an option without its value ("--near --far 5"), a flag with one, a
/// long option with a single dash (CLI11 reads "-output" as -o utput).
std::optional<Error> check_words(const Command& command, std::span<const std::string> words) {
    for (std::size_t i = 0; i < words.size() && words[i] != "--"; ++i) {
        const std::string name = words[i].substr(0, words[i].find('='));
        const Option* option = find_option(command, name);
        if (option == nullptr) {
            if (find_option(command, "-" + name) != nullptr) return unknown_option(command, name);
            continue;
        }
        const bool has_value = name != words[i];
        if (option->value.empty()) {
            if (has_value) return wrong_use("{} takes no value, but '{}' is given", name, words[i]);
            continue;
        }
        if (has_value) continue;
        const bool last = i + 1 == words.size();
        if (last || find_option(command, words[i + 1]) != nullptr) {
            return wrong_use("{} needs a value ({}){}", name, option->value,
                             last ? "" : fmt::format(", but '{}' follows it", words[i + 1]));
        }
        ++i;
    }
    return std::nullopt;
}

/// The words backwards, as CLI11 wants them, with "-o=FILE" in its long spelling: CLI11 would take
/// the sign for a part of the name.
std::vector<std::string> reversed(const Command& command, std::span<const std::string> words) {
    std::vector<std::string> result(words.rbegin(), words.rend());
    for (std::string& word : result) {
        const std::size_t sign = word.find('=');
        if (sign != 2) continue;
        const Option* option = find_option(command, word.substr(0, sign));
        if (option != nullptr) word.replace(0, sign, option->name);
    }
    return result;
}

std::string one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
}

}  // namespace

bool Arguments::has(std::string_view option) const { return values_.contains(option); }

std::optional<std::string> Arguments::value(std::string_view option) const {
    const auto found = values_.find(option);
    if (found == values_.end() || found->second.empty()) return std::nullopt;
    return found->second.back();
}

std::vector<std::string> Arguments::values(std::string_view option) const {
    const auto found = values_.find(option);
    return found == values_.end() ? std::vector<std::string>{} : found->second;
}

Result<Arguments> parse_arguments(const Command& command, std::span<const std::string> words) try {
    if (auto error = check_words(command, words)) return *error;
    CLI::App app;
    app.set_help_flag();
    app.allow_extras();
    for (const OptionGroup& group : command.groups) {
        for (const Option& option : group.options) {
            std::string names(option.name);
            if (!option.short_name.empty()) names += fmt::format(",{}", option.short_name);
            if (option.value.empty()) {
                app.add_flag(names);
            } else {
                app.add_option(names)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
            }
        }
    }
    CLI::Option* models = nullptr;
    if (!command.arguments.empty()) {
        models = app.add_option("MODEL")->expected(-1);
        models->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    }

    app.parse(reversed(command, words));
    for (const std::string& word : app.remaining()) {
        if (word == "--") continue;  // only marks the end of the options
        if (word.size() > 1 && word.front() == '-') return unknown_option(command, word);
        return wrong_use("'{}' takes no arguments, but '{}' is given", command.name, word);
    }
    Arguments result;
    for (const OptionGroup& group : command.groups) {
        for (const Option& option : group.options) {
            const CLI::Option* parsed = app.get_option(std::string(option.name));
            if (parsed->count() == 0) continue;
            result.values_[std::string(option.name)] =
                option.value.empty() ? std::vector<std::string>{} : parsed->results();
        }
    }
    if (models != nullptr) result.models_ = models->results();
    return result;
} catch (const CLI::Error& error) {
    return wrong_use("'{}': {}", command.name, one_line(error.what()));
}

}  // namespace sightline::cli
