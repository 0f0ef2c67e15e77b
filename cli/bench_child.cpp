// A child process with two pipes (see the header). Between fork and exec only functions that POSIX
// lists as safe there are called: other threads may have held locks at the fork.
#include "bench_child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <system_error>

#include "errors.hpp"
#include "scene/load/descriptor.hpp"

namespace sightline::cli {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr std::size_t kMaxOut = std::size_t{1} << 20, kMaxErr = 4096, kMaxShown = 200;
constexpr int kNotStarted = 127;
constexpr milliseconds kPatience{2};  // between two looks at a child that has closed its streams

struct Pipe {
    Descriptor read, write;
};

/// Both ends close on exec.
bool open_pipe(Pipe& pipe) {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) return false;
    pipe.read = Descriptor(ends[0]);
    pipe.write = Descriptor(ends[1]);
    return pipe.read.get() >= 0 && pipe.write.get() >= 0;
}

/// The program's process group gets every signal, so that what it starts ends with it.
[[noreturn]] void become(char* const* argv, pid_t parent, int out, int err) {
    setpgid(0, 0);
    std::signal(SIGXFSZ, SIG_DFL);  // ignored signals stay ignored across an exec
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(kNotStarted);  // it died before the line above
    const int null = open("/dev/null", O_RDONLY | O_CLOEXEC);
    dup2(null, STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    execv(argv[0], argv);
    _exit(kNotStarted);
}

/// Appends what can be read, up to `limit` bytes in all; false at the end of the file.
bool take(int fd, std::string& text, std::size_t limit) {
    std::array<char, 8192> buffer;
    const ssize_t got = read(fd, buffer.data(), buffer.size());
    if (got < 0) return errno == EINTR || errno == EAGAIN;
    text.append(buffer.data(), std::min(static_cast<std::size_t>(got), limit - text.size()));
    return got > 0;
}

/// Reads both streams to their ends; false when the time is over first.
bool read_streams(Pipe& out, Pipe& err, Clock::time_point deadline, ChildOutcome& outcome) {
    while (out.read.get() >= 0 || err.read.get() >= 0) {
        const auto left = std::chrono::ceil<milliseconds>(deadline - Clock::now()).count();
        if (left <= 0) return false;
        // Negative descriptors are passed over.
        std::array<pollfd, 2> watched{pollfd{out.read.get(), POLLIN, 0},
                                      pollfd{err.read.get(), POLLIN, 0}};
        poll(watched.data(), watched.size(), static_cast<int>(std::min<long long>(left, 60000)));
        if (watched[0].revents != 0 && !take(out.read.get(), outcome.out, kMaxOut)) {
            out.read.reset();
        }
        if (watched[1].revents != 0 && !take(err.read.get(), outcome.err, kMaxErr)) {
            err.read.reset();
        }
    }
    return true;
}

/// Waits for the end of a child; false when the time is over first.
bool wait_until(pid_t child, Clock::time_point deadline, int& status) {
    while (true) {
        const pid_t ended = waitpid(child, &status, WNOHANG);
        if (ended == child || (ended < 0 && errno != EINTR)) return true;
        if (Clock::now() >= deadline) return false;
        poll(nullptr, 0, static_cast<int>(kPatience.count()));
    }
}

}  // namespace

Result<ChildOutcome> run_child(const std::vector<std::string>& words, double seconds) {
    const auto cannot_start = [&] {
        return failure("'{}' cannot be started: {}; make it executable or build it again",
                       words.front(), std::system_category().message(errno));
    };
    std::vector<std::string> copies = words;  // execv wants them writable
    std::vector<char*> argv;
    argv.reserve(copies.size() + 1);
    for (std::string& word : copies) argv.push_back(word.data());
    argv.push_back(nullptr);
    Pipe out, err;
    if (access(words.front().c_str(), X_OK) != 0 || !open_pipe(out) || !open_pipe(err)) {
        return cannot_start();
    }
    const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                             std::chrono::duration<double>(seconds));
    const pid_t parent = getpid(), child = fork();
    if (child < 0) return cannot_start();
    if (child == 0) become(argv.data(), parent, out.write.get(), err.write.get());
    setpgid(child, child);  // whoever comes first, it has happened before the kill below
    out.write.reset();
    err.write.reset();
    ChildOutcome outcome;
    int status = 0;
    outcome.late =
        !read_streams(out, err, deadline, outcome) || !wait_until(child, deadline, status);
    if (outcome.late) {
        kill(-child, SIGKILL);
        while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
        }
    }
    if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
    if (WIFEXITED(status)) outcome.status = WEXITSTATUS(status);
    return outcome;
}

std::string first_line(const std::string& text) {
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    if (begin == std::string::npos) return "";
    std::string line = text.substr(begin, text.find_first_of("\r\n", begin) - begin);
    const bool is_long = line.size() > kMaxShown;
    if (is_long) line.resize(kMaxShown);
    for (char& c : line) {
        // Control characters could move the cursor of a terminal; other bytes may be half a letter.
        if (c < ' ' || c > '~') c = '?';
    }
    return is_long ? line + "..." : line;
}

}  // namespace sightline::cli
