// The words of a command line, sorted into options and arguments, values still as text.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "commands.hpp"
#include "sightline/error.hpp"

namespace sightline::cli {

class Arguments {
public:
    /// Whether the option was given at all.
    [[nodiscard]] bool has(std::string_view option) const;
    /// The value of an option; of several, the last.
    [[nodiscard]] std::optional<std::string> value(std::string_view option) const;
    /// All values of an option that may be repeated, in order.
    [[nodiscard]] std::vector<std::string> values(std::string_view option) const;
    /// What stands without an option: model files.
    [[nodiscard]] const std::vector<std::string>& models() const { return models_; }

private:
    friend Result<Arguments> parse_arguments(const Command&, std::span<const std::string>);
    std::map<std::string, std::vector<std::string>, std::less<>> values_;
    std::vector<std::string> models_;
};

/// Sorts the words after the command's name. Errors (bad_option): an unknown option, an option
/// without its value, arguments where the command takes none.
[[nodiscard]] Result<Arguments> parse_arguments(const Command& command,
                                                std::span<const std::string> words);

}  // namespace sightline::cli
