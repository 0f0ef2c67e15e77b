// A file descriptor that closes itself.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <utility>

namespace sightline {

/// Holds a file descriptor, or none: a negative number.
class Descriptor {
public:
    Descriptor() = default;
    /// Takes `fd` over, moved away from the standard streams, which a child process replaces.
    explicit Descriptor(int fd) : fd_(fd) {
        if (fd_ < 0 || fd_ > STDERR_FILENO) return;
        fd_ = fcntl(fd, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
        close(fd);
    }
    Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(fd_, other.fd_);
        return *this;
    }
    ~Descriptor() { reset(); }
    void reset() {
        if (fd_ >= 0) close(fd_);
        fd_ = -1;
    }
    [[nodiscard]] int get() const { return fd_; }

private:
    int fd_ = -1;
};

}  // namespace sightline
