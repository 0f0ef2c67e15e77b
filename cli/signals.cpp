// Signal handlers. They call only functions that POSIX lists as safe in a handler (write, unlink,
// getpid, _exit) and read only lock-free atomics and fixed arrays.
#include "signals.hpp"

#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "image/atomic_file.hpp"
#include "progress.hpp"

namespace sightline::cli {
namespace {

constexpr int kInterruptedStatus = 130, kFailedStatus = 1;
constexpr std::size_t kMaxFiles = 16, kMaxPath = 4096;

struct RememberedFile {
    std::atomic<bool> used{false};   // belongs to a ticket
    std::atomic<bool> valid{false};  // the path is complete
    std::array<char, kMaxPath> path{};
};

std::array<RememberedFile, kMaxFiles> remembered_files;
std::atomic<pid_t> main_process{0};
std::array<char, 160> time_limit_message{};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<pid_t>::is_always_lock_free);

void remove_files() {
    remove_temporary_files_from_signal_handler();
    for (RememberedFile& file : remembered_files) {
        if (file.valid.load()) unlink(file.path.data());
    }
}

/// A child process (one that parses a model) inherits the handlers, but owns no file.
bool is_child() { return getpid() != main_process.load(); }

extern "C" void stop_on_signal(int) {
    if (!is_child()) {
        remove_files();
        clear_progress_from_signal_handler();
    }
    _exit(kInterruptedStatus);
}

extern "C" void stop_on_time_limit(int) {
    if (!is_child()) {
        remove_files();
        clear_progress_from_signal_handler();
        const auto written =
            write(STDERR_FILENO, time_limit_message.data(), std::strlen(time_limit_message.data()));
        static_cast<void>(written);  // nothing more can be done
    }
    _exit(kFailedStatus);
}

void catch_signal(int signal, void (*handler)(int)) {
    struct sigaction action = {};
    action.sa_handler = handler;
    sigfillset(&action.sa_mask);
    sigaction(signal, &action, nullptr);
}

}  // namespace

void install_signal_handlers() {
    main_process = getpid();
    catch_signal(SIGINT, stop_on_signal);
    catch_signal(SIGTERM, stop_on_signal);
    catch_signal(SIGHUP, stop_on_signal);
    catch_signal(SIGPIPE, SIG_IGN);
}

void start_time_limit(double seconds) {
    std::snprintf(time_limit_message.data(), time_limit_message.size(),
                  "sightline: --time-limit: the work took longer than %g seconds; allow more time "
                  "or ask for less\n",
                  seconds);
    catch_signal(SIGALRM, stop_on_time_limit);
    itimerval timer = {};
    timer.it_value.tv_sec = static_cast<time_t>(seconds);
    timer.it_value.tv_usec = static_cast<suseconds_t>((seconds - std::floor(seconds)) * 1e6);
    if (timer.it_value.tv_sec == 0 && timer.it_value.tv_usec == 0) timer.it_value.tv_usec = 1;
    setitimer(ITIMER_REAL, &timer, nullptr);
}

int remember_file(const std::string& path) {
    if (path.size() >= kMaxPath) return -1;
    for (std::size_t i = 0; i < kMaxFiles; ++i) {
        RememberedFile& file = remembered_files[i];
        if (file.used.exchange(true)) continue;
        std::memcpy(file.path.data(), path.c_str(), path.size() + 1);
        file.valid = true;
        return static_cast<int>(i);
    }
    return -1;
}

void forget_file(int ticket) {
    if (ticket < 0) return;
    RememberedFile& file = remembered_files[static_cast<std::size_t>(ticket)];
    file.valid = false;
    file.used = false;
}

}  // namespace sightline::cli
