// Signal handlers. They call only functions that POSIX lists as safe in a handler (write, unlink,
// poll, getpid, _exit) and read only lock-free atomics and fixed arrays.
#include "signals.hpp"

#include <poll.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>

#include "image/temporary_file.hpp"
#include "progress.hpp"

namespace sightline::cli {
namespace {

constexpr int kInterruptedStatus = 130, kFailedStatus = 1, kNobodyReadsStatus = 128 + SIGPIPE;

std::atomic<pid_t> main_process{0};
std::atomic<pid_t> stopping_thread{0};
std::array<char, 160> time_limit_message{};
constexpr char kProcessorTimeMessage[] =
    "sightline: the limit on processor time (ulimit -t) is reached; raise it or ask for less\n";
static_assert(std::atomic<pid_t>::is_always_lock_free);

/// A child process (one that parses a model) inherits the handlers, but owns no file.
bool is_child() { return getpid() != main_process.load(); }

/// Ends the program with a message, which may be empty. Signals can come to several threads at a
/// time: the first one ends the program, the others wait for it. It returns where a signal comes
/// within the handler, which only a sanitizer lets happen.
void stop(int status, const char* message) {
    if (!is_child()) {
        pid_t first = 0;
        if (!stopping_thread.compare_exchange_strong(first, gettid())) {
            if (first == gettid()) return;
            for (;;) pause();
        }
        remove_temporary_files_from_signal_handler();
        clear_progress_from_signal_handler();
        const auto written = write(STDERR_FILENO, message, std::strlen(message));
        static_cast<void>(written);  // nothing more can be done
    }
    _exit(status);
}

extern "C" void stop_on_signal(int) { stop(kInterruptedStatus, ""); }
extern "C" void stop_on_time_limit(int) { stop(kFailedStatus, time_limit_message.data()); }
extern "C" void stop_on_processor_time(int) { stop(kFailedStatus, kProcessorTimeMessage); }

/// Another pipe than standard output is left to the error that the write returns.
extern "C" void stop_on_closed_pipe(int) {
    pollfd out{STDOUT_FILENO, 0, 0};
    if (poll(&out, 1, 0) == 1 && (out.revents & POLLERR) != 0) stop(kNobodyReadsStatus, "");
}

/// The signal comes even if the program that started this one had it blocked.
void catch_signal(int signal, void (*handler)(int)) {
    struct sigaction action = {};
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART;
    sigfillset(&action.sa_mask);
    sigaction(signal, &action, nullptr);
    sigset_t caught;
    sigemptyset(&caught);
    sigaddset(&caught, signal);
    sigprocmask(SIG_UNBLOCK, &caught, nullptr);
}

bool is_ignored(int signal) {
    struct sigaction action = {};
    return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

/// At the hard limit the system kills without SIGXCPU; `ulimit -t` sets both. So the signal is
/// asked for a little earlier.
void expect_end_of_processor_time() {
    rlimit limit{};
    if (getrlimit(RLIMIT_CPU, &limit) != 0 || limit.rlim_max == RLIM_INFINITY ||
        limit.rlim_cur < limit.rlim_max) {
        return;
    }
    sigevent event = {};
    event.sigev_notify = SIGEV_SIGNAL;
    event.sigev_signo = SIGXCPU;
    timer_t timer{};
    if (timer_create(CLOCK_PROCESS_CPUTIME_ID, &event, &timer) != 0) return;
    constexpr double kLongestLimit = 1e9, kEarlier = 0.25;  // seconds
    const double end = std::min(static_cast<double>(limit.rlim_max), kLongestLimit) - kEarlier;
    itimerspec when = {};
    when.it_value.tv_sec = static_cast<time_t>(std::max(end, 0.0));
    when.it_value.tv_nsec = static_cast<long>(1e9 * std::max(end - std::floor(end), 0.001));
    timer_settime(timer, TIMER_ABSTIME, &when, nullptr);
}

}  // namespace

void install_signal_handlers() {
    main_process = getpid();
    for (const int signal : {SIGINT, SIGTERM, SIGQUIT, SIGALRM, SIGUSR1, SIGUSR2, SIGVTALRM}) {
        catch_signal(signal, stop_on_signal);
    }
    if (!is_ignored(SIGHUP)) catch_signal(SIGHUP, stop_on_signal);  // it is by nohup
    catch_signal(SIGPIPE, stop_on_closed_pipe);
    catch_signal(SIGXCPU, stop_on_processor_time);
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGCHLD, SIG_DFL);  // where it is ignored, the end of a child tells nothing
    expect_end_of_processor_time();
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

}  // namespace sightline::cli
