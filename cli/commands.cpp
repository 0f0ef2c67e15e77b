// The table of commands, and the help that is made from it.
#include "commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace sightline::cli {
namespace {

constexpr std::array<const Command*, 9> kCommands = {
    &kRender, &kDraw, &kVisible, &kPlot, &kComposite, &kInfo, &kAlgorithms, &kCompare, &kBench};

constexpr std::array kProgramExamples = {
    Example{"sightline render bunny.obj -o bunny.png", "a picture with the whole model in view"},
    Example{"sightline draw bunny.obj -o bunny.svg", "an exact drawing of what can be seen"},
    Example{"sightline plot \"y = sin(x) * cos(z)\" -o waves.svg", "a function as curves"},
    Example{"sightline info bunny.obj", "what is in the file"},
    Example{"sightline render --help", "everything that a command can do"},
};

void append_examples(std::string& text, std::span<const Example> examples) {
    text += "\nExamples:\n";
    for (const Example& example : examples) {
        text += fmt::format("  {}\n      {}\n", example.command, example.what);
    }
}

std::string spelling(const Option& option) {
    std::string text = option.short_name.empty()
                           ? fmt::format("{}", option.name)
                           : fmt::format("{}, {}", option.short_name, option.name);
    if (!option.value.empty()) text += fmt::format(" {}", option.value);
    return text;
}

/// Breaks a text at blanks into lines of at most `width` letters, indented but for the first.
std::string wrap(std::string_view text, std::size_t width, std::size_t indent) {
    std::string wrapped;
    while (text.size() > width) {
        const std::size_t blank = text.rfind(' ', width);
        if (blank == std::string_view::npos) break;
        wrapped += fmt::format("{}\n{:{}}", text.substr(0, blank), "", indent);
        text.remove_prefix(blank + 1);
    }
    return wrapped.append(text);
}

void append_options(std::string& text, const OptionGroup& group) {
    constexpr std::size_t kColumn = 30, kWidth = 66;
    text += fmt::format("\n{}:\n", group.title);
    for (const Option& option : group.options) {
        const std::string left = spelling(option);
        const std::string help = wrap(option.help, kWidth, kColumn + 2);
        if (left.size() < kColumn) {
            text += fmt::format("  {:<{}}{}\n", left, kColumn, help);
        } else {
            text += fmt::format("  {}\n  {:<{}}{}\n", left, "", kColumn, help);
        }
    }
}

}  // namespace

std::span<const Command* const> commands() { return kCommands; }

const Command* find_command(std::string_view name) {
    const auto found = std::find_if(kCommands.begin(), kCommands.end(),
                                    [&](const Command* command) { return command->name == name; });
    return found == kCommands.end() ? nullptr : *found;
}

std::string program_help() {
    std::string text =
        "sightline: decides what can be seen of a 3D scene, exactly\n\n"
        "Usage: sightline COMMAND [ARGUMENTS] [OPTIONS]\n\nCommands:\n";
    for (const Command* command : kCommands) {
        text += fmt::format("  {:<12}{}\n", command->name, command->title);
    }
    text +=
        "\nOptions:\n"
        "  -h, --help  this text; after a command, all about the command\n"
        "  --version   the version of the program\n";
    append_examples(text, kProgramExamples);
    text +=
        "\nExit status: 0 done, 1 the job failed, 2 wrong use. Option values may begin with a\n"
        "minus sign (--direction -1,-1,-1); `-` is standard input or output.\n";
    return text;
}

std::string command_help(const Command& command) {
    const std::string arguments =
        command.arguments.empty() ? "" : fmt::format(" {}", command.arguments);
    std::string text = fmt::format("Usage: sightline {}{} [OPTIONS]\n\n{}\n", command.name,
                                   arguments, command.help);
    for (const OptionGroup& group : command.groups) append_options(text, group);
    append_examples(text, command.examples);
    return text;
}

}  // namespace sightline::cli
