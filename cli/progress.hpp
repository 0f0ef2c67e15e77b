// What the program is doing, on a terminal and nowhere else.
#pragma once

#include <string>
#include <string_view>

namespace sightline::cli {

/// One line on standard error that is rewritten as the work goes on, and gone at the end. Silent
/// when standard error is no terminal or `quiet` is set.
class Progress {
public:
    explicit Progress(bool quiet);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void stage(std::string_view what);
    /// "what 3/15".
    void stage(std::string_view what, unsigned done, unsigned all);
    /// From now on every line begins with "frame 3 of 36".
    void frame(unsigned number, unsigned all);
    /// Takes the line away, so that something else can be printed.
    void clear();

private:
    bool shown_ = false;
    std::string frame_;
};

/// Async-signal-safe: gives a terminal its clean line back.
void clear_progress_from_signal_handler();

}  // namespace sightline::cli
