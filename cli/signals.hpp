// Stopping in the middle of the work: Ctrl-C, SIGTERM and their like, limits of the system and
// --time-limit remove whatever is half written and leave at once.
#pragma once

namespace sightline::cli {

/// Catches what would end the program (exit status 130), the end of its processor time (one line,
/// status 1) and that nobody reads standard output any more (status 141, as of a program that
/// SIGPIPE ends). A file that gets too large for `ulimit -f` is an ordinary error. Call before
/// anything is written.
void install_signal_handlers();

/// Ends the program with one line and exit status 1 once this much (wall-clock) time has passed.
void start_time_limit(double seconds);

}  // namespace sightline::cli
