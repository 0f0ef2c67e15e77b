// The table of commands: it drives dispatch, parsing and help. One file a command; a new command is
// one file that defines a `const Command` and one line in commands.cpp.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/error.hpp"

namespace sightline::cli {

class Arguments;

/// One option of a command.
struct Option {
    std::string_view name;             ///< "--fov"
    std::string_view value;            ///< what stands after it ("DEG"); empty for a flag
    std::string_view help;             ///< one line
    std::string_view short_name = "";  ///< "-o", or empty
};

/// Options that stand together in the help.
struct OptionGroup {
    std::string_view title;
    std::span<const Option> options;
};

struct Example {
    std::string_view command;
    std::string_view what;
};

/// One row of the table.
struct Command {
    std::string_view name;
    std::string_view title;      ///< one line, for the list of commands
    std::string_view arguments;  ///< as in the usage line: "MODEL..."; empty: takes none
    std::string_view help;       ///< a paragraph
    std::span<const OptionGroup> groups;
    std::span<const Example> examples;
    /// Does the job and returns the exit status, or the error to print.
    Result<int> (*run)(const Arguments&) = nullptr;
};

extern const Command kRender, kDraw, kVisible, kPlot, kComposite, kInfo, kAlgorithms, kCompare,
    kBench;

/// All commands, in the order of the help.
[[nodiscard]] std::span<const Command* const> commands();
[[nodiscard]] const Command* find_command(std::string_view name);

/// The texts of `sightline --help` and `sightline COMMAND --help`.
[[nodiscard]] std::string program_help();
[[nodiscard]] std::string command_help(const Command& command);

}  // namespace sightline::cli
