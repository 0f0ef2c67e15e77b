// Stopping in the middle of the work: Ctrl-C, SIGTERM and --time-limit remove whatever is half
// written and leave at once.
#pragma once

#include <string>

namespace sightline::cli {

/// Catches SIGINT and SIGTERM (exit status 130); writing to a closed pipe becomes an ordinary
/// error.
void install_signal_handlers();

/// Ends the program with one line and exit status 1 once this much (wall-clock) time has passed.
void start_time_limit(double seconds);

/// A file that is removed when the program is stopped. Returns a ticket for forget_file(), or -1
/// when there are too many.
[[nodiscard]] int remember_file(const std::string& path);
void forget_file(int ticket);

}  // namespace sightline::cli
