// Lines on standard error that tell a user what to know of a run that did its job.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "arguments.hpp"
#include "progress.hpp"
#include "sightline/scene.hpp"

namespace sightline::cli {

/// An option of the command and whether it changes nothing in this run.
struct IdleOption {
    std::string_view name;
    bool idle = false;
    std::string_view why;  ///< ends the sentence "--fov has no effect: ..."
};

/// Prints one line each, or nothing when `quiet`. `progress` must outlive it.
class Notes {
public:
    Notes(bool quiet, Progress& progress) : quiet_(quiet), progress_(progress) {}

    /// Warns that what comes out may not be what was wanted.
    void warn(std::string_view text) const { print("warning", text); }
    /// Says in what the run did not do quite what was asked for.
    void note(std::string_view text) const { print("note", text); }
    /// Warns of all that the scene's files hold without effect.
    void warn_of_files(const Scene& scene) const;
    /// Warns of the options that were given and change nothing.
    void warn_of_options(const Arguments& arguments, std::span<const IdleOption> options) const;

private:
    void print(std::string_view kind, std::string_view text) const;

    bool quiet_;
    Progress& progress_;
};

}  // namespace sightline::cli
