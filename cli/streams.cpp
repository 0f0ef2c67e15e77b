#include "streams.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <ctime>

#include "image/write_all.hpp"
#include "scene/load/text.hpp"

namespace sightline::cli {
namespace {

/// While it lives, writing to a pipe that nobody reads is an error and no signal.
class NoPipeSignal {
public:
    NoPipeSignal() {
        sigemptyset(&pipe_);
        sigaddset(&pipe_, SIGPIPE);
        pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
    }
    ~NoPipeSignal() {
        constexpr timespec kNow{0, 0};
        while (sigtimedwait(&pipe_, nullptr, &kNow) < 0 && errno == EINTR) {
        }
        pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    }
    NoPipeSignal(const NoPipeSignal&) = delete;
    NoPipeSignal& operator=(const NoPipeSignal&) = delete;

private:
    sigset_t pipe_{}, before_{};
};

}  // namespace

void occupy_closed_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
        // The lowest number that is free, which is this one. Open the wrong way round, so that
        // what is to be read or written does not get lost in silence. Programs started from here
        // find it, too.
        const int flags = stream == STDOUT_FILENO ? O_RDONLY : O_WRONLY;
        if (open("/dev/null", flags) < 0) return;  // NOLINT: it stays open in children
    }
}

void tell(std::string_view text) {
    const NoPipeSignal none;
    const int ignored = write_all(STDERR_FILENO, text.data(), text.size());
    static_cast<void>(ignored);
}

void tell_line(std::string_view text) { tell("sightline: " + load::clean_text(text) + '\n'); }

}  // namespace sightline::cli
