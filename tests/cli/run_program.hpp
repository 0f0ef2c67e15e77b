// Runs the built program in a folder of its own and looks at what comes of it.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <thread>
#include <vector>

#include "support/files.hpp"

namespace sightline::testing {

namespace fs = std::filesystem;

struct Outcome {
    int status = -1;
    std::string out, err;

    [[nodiscard]] long error_lines() const { return std::count(err.begin(), err.end(), '\n'); }
};

/// A unit cube of six quads with outward normals, closed.
inline const std::string kCube =
    "o cube\n"
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// The program's name and these words, as a new process wants them. They stay in `words`.
inline std::vector<char*> argv_of(std::vector<std::string>& words) {
    words.insert(words.begin(), SIGHTLINE_PROGRAM);
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    return argv;
}

/// The exit status of a program when it has ended, or 128 and the signal that ended it.
inline int status_of(pid_t program) {
    int state = 0;
    waitpid(program, &state, 0);
    return WIFEXITED(state) ? WEXITSTATUS(state) : 128 + WTERMSIG(state);
}

/// A program that runs.
class Running {
public:
    Running(const fs::path& folder, std::vector<std::string> words, const std::string& input,
            const fs::path& private_folder)
        : private_(private_folder) {
        write_file(private_ / "in", input);
        const std::vector<char*> argv = argv_of(words);
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        const auto redirect = [&](int descriptor, const char* name, int flags) {
            posix_spawn_file_actions_addopen(&actions, descriptor, (private_ / name).c_str(), flags,
                                             0600);
        };
        redirect(0, "in", O_RDONLY);
        redirect(1, "out", O_WRONLY | O_CREAT | O_TRUNC);
        redirect(2, "err", O_WRONLY | O_CREAT | O_TRUNC);
        posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
        EXPECT_EQ(posix_spawn(&pid_, SIGHTLINE_PROGRAM, &actions, nullptr, argv.data(), environ),
                  0);
        posix_spawn_file_actions_destroy(&actions);
    }

    void send(int signal) const { kill(pid_, signal); }

    Outcome wait() {
        const int status = status_of(pid_);
        return {status, read_file(private_ / "out"), read_file(private_ / "err")};
    }

private:
    fs::path private_;
    pid_t pid_ = -1;
};

/// A fresh folder with `cube.obj` in it; everything is removed at the end.
class ProgramTest : public ::testing::Test {
protected:
    void SetUp() override {
        fs::create_directories(folder_);
        fs::create_directories(streams_);
        write("cube.obj", kCube);
    }

    void write(const std::string& name, const std::string& text) const {
        write_file(folder_ / name, text);
    }
    [[nodiscard]] std::string read(const std::string& name) const {
        return read_file(folder_ / name);
    }
    [[nodiscard]] bool exists(const std::string& name) const { return fs::exists(folder_ / name); }
    [[nodiscard]] std::vector<std::string> files() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder_)) {
            names.push_back(entry.path().filename().string());
        }
        std::sort(names.begin(), names.end());
        return names;
    }

    [[nodiscard]] Running start(std::vector<std::string> words,
                                const std::string& input = "") const {
        return {folder_, std::move(words), input, streams_};
    }
    [[nodiscard]] Outcome run(std::vector<std::string> words, const std::string& input = "") const {
        return start(std::move(words), input).wait();
    }

    /// The run ends with this status and one line that has all of the words; no file appears.
    void expect_failure(int status, std::vector<std::string> words,
                        std::initializer_list<std::string> needles,
                        const std::string& input = "") const {
        std::string shown;
        for (const std::string& word : words) shown += " " + word;
        SCOPED_TRACE("sightline" + shown);
        const auto before = files();
        const Outcome outcome = run(std::move(words), input);
        EXPECT_EQ(outcome.status, status) << outcome.err;
        EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
        EXPECT_TRUE(outcome.err.starts_with("sightline: ")) << outcome.err;
        EXPECT_EQ(outcome.out, "");
        for (const std::string& needle : needles) {
            EXPECT_NE(outcome.err.find(needle), std::string::npos)
                << "no '" << needle << "' in: " << outcome.err;
        }
        EXPECT_EQ(files(), before);
    }

    const TemporaryFolder root_;
    const fs::path folder_ = root_.file("work"), streams_ = root_.file("streams");
};

/// Width and height of a PNG, or zeros when the bytes are none.
inline std::array<unsigned, 2> png_size(const std::string& bytes) {
    if (bytes.size() < 24 || !bytes.starts_with("\x89PNG\r\n\x1a\n")) return {0, 0};
    const auto number = [&](std::size_t at) {
        unsigned value = 0;
        for (std::size_t i = at; i < at + 4; ++i) {
            value = value << 8 | static_cast<unsigned char>(bytes[i]);
        }
        return value;
    };
    return {number(16), number(20)};
}

}  // namespace sightline::testing
