// Runs of the program under the conditions that a shell can make.
#pragma once

#include <cstdlib>
#include <string>
#include <vector>

#include "cli/run_program.hpp"

namespace sightline::testing {

/// In scripts $S is the program, and the working folder is the test's.
class ShellTest : public ProgramTest {
protected:
    [[nodiscard]] Outcome shell(const std::string& script) const {
        const fs::path out = streams_ / "shell-out", err = streams_ / "shell-err";
        write_file(streams_ / "script", script + "\n");
        const std::string line = "cd '" + folder_.string() + "' && S='" + SIGHTLINE_PROGRAM +
                                 "' sh '" + (streams_ / "script").string() + "' >'" + out.string() +
                                 "' 2>'" + err.string() + "'";
        const int state = std::system(line.c_str());
        return {WIFEXITED(state) ? WEXITSTATUS(state) : -1, read_file(out), read_file(err)};
    }
    [[nodiscard]] std::vector<std::string> temporary_files() const {
        std::vector<std::string> names = files();
        std::erase_if(names,
                      [](const std::string& name) { return !name.starts_with(".sightline-"); });
        return names;
    }
};

}  // namespace sightline::testing
