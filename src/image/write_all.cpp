#include "image/write_all.hpp"

#include <poll.h>
#include <unistd.h>

#include <cerrno>

namespace sightline {

bool worth_another_try(int descriptor, short events, int error_number) {
    if (error_number == EINTR) return true;
    if (error_number != EAGAIN && error_number != EWOULDBLOCK) return false;
    pollfd watched{descriptor, events, 0};
    return poll(&watched, 1, -1) >= 0 || errno == EINTR;
}

int write_all(int descriptor, const void* data, std::size_t size) {
    const char* bytes = static_cast<const char*>(data);
    while (size > 0) {
        const ssize_t written = ::write(descriptor, bytes, size);
        if (written < 0) {
            if (worth_another_try(descriptor, POLLOUT, errno)) continue;
            return errno;
        }
        bytes += written;
        size -= static_cast<std::size_t>(written);
    }
    return 0;
}

}  // namespace sightline
