// A program that is run for its output: without a shell, for a limited time, and not trusted.
#pragma once

#include <string>
#include <vector>

#include "sightline/error.hpp"

namespace sightline::cli {

/// How a program ended and what it printed.
struct ChildOutcome {
    bool late = false;  ///< it was killed because its time was over
    int signal = 0;     ///< what stopped it, or 0
    int status = 0;     ///< exit status, where no signal stopped it
    std::string out;    ///< standard output, at most 1 MiB of it
    std::string err;    ///< the beginning of standard error
};

/// Runs words[0] (a path) with the arguments that follow, standard input empty, and waits for it.
/// The program dies with this one, whatever ends it. After `seconds` it is killed with all that it
/// started. Error (io): it cannot be started.
[[nodiscard]] Result<ChildOutcome> run_child(const std::vector<std::string>& words, double seconds);

/// Untrusted text for an error of one line: the first line that is not blank, at most 200 bytes of
/// it, without control characters.
[[nodiscard]] std::string first_line(const std::string& text);

}  // namespace sightline::cli
