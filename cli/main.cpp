// The program `sightline`: finds the command in the table, runs it, and turns errors into one line
// on standard error and an exit status (0 done, 1 the job failed, 2 wrong use).
#include <fmt/format.h>

#include <cstdlib>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "commands.hpp"
#include "errors.hpp"
#include "image/temporary_file.hpp"
#include "math/thread_failure.hpp"
#include "report.hpp"
#include "signals.hpp"
#include "streams.hpp"
#include "suggest.hpp"

namespace sightline::cli {
namespace {

using Words = std::vector<std::string>;

std::vector<std::string_view> command_names() {
    std::vector<std::string_view> names;
    for (const Command* command : commands()) names.push_back(command->name);
    return names;
}

Result<int> show(const std::string& text) {
    if (Status printed = print(text); !printed) return printed.error();
    return 0;
}

bool wants_help(const Words& words) {
    for (const std::string& word : words) {
        if (word == "--") return false;
        if (word == "--help" || word == "-h") return true;
    }
    return false;
}

Result<int> run_command(const std::string& name, const Words& words) {
    const Command* command = find_command(name);
    if (command == nullptr) {
        return wrong_use("unknown command '{}'; {}", name,
                         did_you_mean(name, command_names(), "'sightline --help' lists them"));
    }
    if (wants_help(words)) return show(command_help(*command));
    const Result<Arguments> arguments = parse_arguments(*command, words);
    if (!arguments) return arguments.error();
    return command->run(*arguments);
}

Result<int> run_program(const Words& words) {
    if (words.empty()) return wrong_use("no command given; 'sightline --help' lists them");
    const std::string& first = words.front();
    if (first == "--help" || first == "-h") return show(program_help());
    if (first == "help") {  // what many type first
        return words.size() == 1 ? show(program_help()) : run_command(words[1], {"--help"});
    }
    if (first == "--version") return show("sightline " SIGHTLINE_VERSION "\n");
    if (first.starts_with('-')) {
        return wrong_use("the command comes first, but '{}' stands there; one of {}", first,
                         join(command_names()));
    }
    return run_command(first, {words.begin() + 1, words.end()});
}

int report(const Error& error) {
    tell_line(error.message);
    return exit_status(error.kind);
}

/// Runs what the words ask for. Everything that is thrown below becomes an error.
Result<int> run_guarded(const Words& words) {
    try {
        return run_program(words);
    } catch (const std::bad_alloc&) {
        return failure(
            "not enough memory; choose a smaller --resolution or --samples, a smaller model, or, "
            "where surfaces cross one another, --algorithm zbuffer");
    } catch (const std::exception& error) {
        if (const auto text = thread_failure(error)) return failure("{}", *text);
        return failure("unexpected failure: {}; try again or report it", error.what());
    }
}

}  // namespace
}  // namespace sightline::cli

int main(int argc, char** argv) {
    using namespace sightline;
    cli::occupy_closed_streams();
    cli::install_signal_handlers();
    const Result<int> result = cli::run_guarded({argv + 1, argv + argc});
    // From here on a signal comes too late: a run that has its files does not end as one that was
    // stopped, nor with two messages. The step is never left.
    const UninterruptedStep last;
    std::exit(result ? *result : cli::report(result.error()));
}
