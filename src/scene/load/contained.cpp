// A fork with limits. The child hands its result over through an anonymous file (memfd), which the
// parent maps once the child is gone, and holds the write end of a pipe, whose end of file tells
// the parent at once that it is gone, however it went. Its last act is to write its status there.
#include "scene/load/contained.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>
#include <utility>

#include "image/write_all.hpp"
#include "scene/load/descriptor.hpp"

namespace sightline::load {
namespace {

// Exit statuses of the child.
constexpr int kDone = 0, kOutOfMemory = 3, kThrew = 4, kNotHandedOver = 5;

Error system_error(const std::string& name, const char* what) {
    return {ErrorKind::io, fmt::format("{}: cannot start a process to read it ({}: {}); free some "
                                       "memory or raise the limit on processes",
                                       name, what, std::strerror(errno))};
}

// --- In the child.

/// Bytes of address space in use.
std::size_t mapped_now() {
    unsigned long pages = 0;
    if (std::FILE* file = std::fopen("/proc/self/statm", "re")) {
        if (std::fscanf(file, "%lu", &pages) != 1) pages = 0;
        std::fclose(file);
    }
    return static_cast<std::size_t>(pages) * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

void set_limit(decltype(RLIMIT_CPU) resource, std::size_t value) {
    rlimit limit{};
    getrlimit(resource, &limit);
    limit.rlim_cur = std::min<rlim_t>(value, limit.rlim_max);
    setrlimit(resource, &limit);
}

void limit_resources(const ChildLimits& limits) {
    set_limit(RLIMIT_CORE, 0);
    set_limit(RLIMIT_CPU,
              static_cast<std::size_t>(std::ceil(std::clamp(limits.seconds, 0.0, 1e9))) + 1);
    set_limit(RLIMIT_FSIZE, limits.memory_bytes);  // the anonymous file counts as one
    // Sanitizers map terabytes of shadow memory, so there they must do without.
    if (!kIsSanitized) set_limit(RLIMIT_AS, mapped_now() + limits.memory_bytes);
}

void become_quiet_and_mortal(pid_t parent) {
    // Handlers of the caller (a program's Ctrl-C, a fuzzer's crash report) are not for the child.
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGSEGV, SIGBUS, SIGFPE, SIGILL,
                             SIGABRT, SIGALRM, SIGXCPU, SIGXFSZ, SIGPIPE, SIGTRAP, SIGUSR1}) {
        std::signal(signal, SIG_DFL);
    }
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(kNotHandedOver);  // it died before the line above
    const int null = open("/dev/null", O_RDWR | O_CLOEXEC);
    for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (null >= 0) dup2(null, fd);
    }
}

int pipe_to_parent = -1;

/// Ends the child. Its status goes through the pipe as well: a parent that ignores SIGCHLD can't
/// ask the system for it.
[[noreturn]] void leave(int status) {
    const auto code = static_cast<unsigned char>(status);
    const int ignored = write_all(pipe_to_parent, &code, 1);
    static_cast<void>(ignored);
    _exit(status);  // no destructors: they belong to the caller
}

[[noreturn]] void child_main(const std::function<std::vector<std::byte>()>& work,
                             const ChildLimits& limits, pid_t parent, int result, int pipe) {
    pipe_to_parent = pipe;
    become_quiet_and_mortal(parent);
    limit_resources(limits);
    std::set_new_handler([] { leave(kOutOfMemory); });
    int status = kThrew;
    try {
        const std::vector<std::byte> bytes = work();
        status = write_all(result, bytes.data(), bytes.size()) == 0 ? kDone : kNotHandedOver;
    } catch (const std::bad_alloc&) {
        status = kOutOfMemory;
    } catch (...) {
        status = kThrew;
    }
    leave(status);
}

// --- In the parent.

/// Waits for a byte or the end of file on `pipe`; false when the time is over first.
bool wait_for_end(int pipe, double seconds) {
    using Clock = std::chrono::steady_clock;
    const auto deadline =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(
                           std::chrono::duration<double>(std::clamp(seconds, 0.0, 1e8)));
    while (true) {
        const auto left =
            std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
        if (left <= 0) return false;
        pollfd watched{pipe, POLLIN, 0};
        const int ready = poll(&watched, 1, static_cast<int>(std::min<long long>(left, 1 << 30)));
        if (ready > 0) return true;
    }
}

/// The status of a child that ends. Where the caller ignores SIGCHLD, or somebody else waited for
/// the child, it is what the child itself wrote into the pipe; a child that crashed wrote nothing.
int wait_for_status(pid_t child, int pipe) {
    int status = 0;
    while (waitpid(child, &status, 0) < 0) {
        if (errno == EINTR) continue;
        unsigned char code = kThrew;
        const bool told = read(pipe, &code, 1) == 1;
        return W_EXITCODE(told ? code : kThrew, 0);
    }
    return status;
}

Error out_of_time(const ChildLimits& limits, const std::string& name) {
    return {
        ErrorKind::bad_input,
        fmt::format("{}: reading it took longer than {:g} s; use a smaller or repaired file, or "
                    "convert it to another format",
                    name, limits.seconds)};
}

Error out_of_memory(const ChildLimits& limits, const std::string& name) {
    return {
        ErrorKind::bad_input,
        fmt::format("{}: reading it takes more than {} MiB of memory; use a smaller or repaired "
                    "file, or convert it to another format",
                    name, limits.memory_bytes >> 20)};
}

/// Whether the system allows files that large; what a child hands over counts as one.
bool may_hand_over(std::size_t bytes) {
    rlimit limit{};
    return getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_max >= bytes;
}

/// The error behind a status of waitpid() other than success.
Error failure(int status, const ChildLimits& limits, const std::string& name) {
    const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    if (signal == SIGXCPU) return out_of_time(limits, name);
    if (signal == SIGXFSZ && !may_hand_over(limits.memory_bytes)) {
        return {ErrorKind::io, fmt::format("{}: what was read is larger than the limit on the size "
                                           "of files (ulimit -f); raise it",
                                           name)};
    }
    if (signal == SIGXFSZ || code == kOutOfMemory) return out_of_memory(limits, name);
    if (signal == SIGINT || signal == SIGTERM || signal == SIGHUP) {
        return {ErrorKind::cancelled, fmt::format("{}: reading it was interrupted", name)};
    }
    if (signal == SIGKILL) {
        return {ErrorKind::io, fmt::format("{}: the process that read it was killed, probably for "
                                           "want of memory; free some or use a smaller model",
                                           name)};
    }
    if (code == kNotHandedOver) {
        return {ErrorKind::io, fmt::format("{}: what was read could not be handed over; free some "
                                           "memory or use a smaller model",
                                           name)};
    }
    return {
        ErrorKind::bad_input,
        fmt::format("{}: the file is damaged: its reader crashed ({}); export it again or convert "
                    "it to another format",
                    name, signal != 0 ? strsignal(signal) : "internal error")};
}

Result<MappedBytes> map_result(int fd, const std::string& name) {
    struct stat info {};
    if (fstat(fd, &info) != 0) return system_error(name, "fstat");
    const auto size = static_cast<std::size_t>(info.st_size);
    if (size == 0) return MappedBytes{};
    void* const data = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd, 0);
    if (data == MAP_FAILED) return system_error(name, "mmap");
    return MappedBytes(data, size);
}

}  // namespace

MappedBytes::MappedBytes(MappedBytes&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

MappedBytes& MappedBytes::operator=(MappedBytes&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
}

MappedBytes::~MappedBytes() {
    if (data_ != nullptr) munmap(data_, size_);
}

Result<MappedBytes> run_contained(const std::function<std::vector<std::byte>()>& work,
                                  const ChildLimits& limits, const std::string& name) {
    Descriptor result(memfd_create("sightline", MFD_CLOEXEC));
    if (result.get() < 0) return system_error(name, "memfd_create");
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) return system_error(name, "pipe");
    const Descriptor end_of_child(ends[0]);
    Descriptor held_by_child(ends[1]);
    const pid_t parent = getpid();
    const pid_t child = fork();
    if (child < 0) return system_error(name, "fork");
    if (child == 0) child_main(work, limits, parent, result.get(), held_by_child.get());
    held_by_child.reset();
    const bool in_time = wait_for_end(end_of_child.get(), limits.seconds);
    if (!in_time) kill(child, SIGKILL);
    const int status = wait_for_status(child, end_of_child.get());
    if (!in_time) return out_of_time(limits, name);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != kDone) return failure(status, limits, name);
    return map_result(result.get(), name);
}

}  // namespace sightline::load
