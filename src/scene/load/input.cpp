#include "scene/load/input.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/magic.h>
#include <poll.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

#include "image/write_all.hpp"

namespace sightline::load {
namespace {

constexpr std::size_t kChunk = std::size_t{1} << 20;

Error refused(const std::string& name, int error) {
    const char* const way_out = error == ENOENT ? "check the path" : "check its permissions";
    return {ErrorKind::io,
            fmt::format("{}: cannot read it: {}; {}", name, std::strerror(error), way_out)};
}

Error too_large(const std::string& name, std::size_t limit) {
    return {ErrorKind::bad_input,
            fmt::format("{}: more than {} MiB; use a smaller model", name, limit >> 20)};
}

/// Whether what statfs() tells is a file system whose files the kernel makes up.
bool is_of_kernel(const struct statfs& info) {
    constexpr std::array<unsigned long, 8> kMagics = {
        PROC_SUPER_MAGIC, SYSFS_MAGIC,        DEBUGFS_MAGIC, TRACEFS_MAGIC,
        SECURITYFS_MAGIC, CGROUP_SUPER_MAGIC, BPF_FS_MAGIC,  CGROUP2_SUPER_MAGIC};
    return std::ranges::count(kMagics, static_cast<unsigned long>(info.f_type)) > 0;
}

/// Whether somebody has a pipe open for writing, or has left something in it.
bool has_writer(int pipe) {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) return true;
    const Descriptor out(ends[0]), in(ends[1]);
    // This takes nothing out of the pipe; at its end there is nothing to copy.
    return tee(pipe, in.get(), 1, SPLICE_F_NONBLOCK) != 0;
}

/// Waits a moment for somebody to write to a pipe, which was opened without blocking; false when
/// nobody does. From then on reading blocks.
bool await_writer(int pipe) {
    constexpr int kTries = 50;
    constexpr std::chrono::milliseconds kPause(20);
    for (int i = 0; !has_writer(pipe); ++i) {
        if (i == kTries) return false;
        std::this_thread::sleep_for(kPause);
    }
    return fcntl(pipe, F_SETFL, O_RDONLY) == 0;
}

/// Why a file that is open and is no folder can't be a model; "" when it can.
std::string_view unfit(int fd, const struct stat& info) {
    struct statfs system {};
    if (S_ISREG(info.st_mode)) {
        const bool of_kernel = fstatfs(fd, &system) == 0 && is_of_kernel(system);
        return of_kernel ? "it is a file of the kernel; name a file on a disk" : "";
    }
    if (!S_ISFIFO(info.st_mode)) return "it is a device; name a file";
    return await_writer(fd) ? "" : "it is a pipe that nobody writes to; start what writes to it";
}

/// Reads up to `size` bytes of what is left of a file; there are probably `expected` ones.
Result<std::vector<std::byte>> read_up_to(int fd, const std::string& name, std::size_t size,
                                          std::size_t expected = 0) {
    std::vector<std::byte> bytes;
    bytes.reserve(std::min(size, expected + 1));  // one more, to see the end
    while (bytes.size() < size) {
        const std::size_t before = bytes.size();
        const std::size_t room = bytes.capacity() - before;
        bytes.resize(before + std::min({kChunk, size - before, room > 0 ? room : kChunk}));
        ssize_t got = 0;
        do got = read(fd, bytes.data() + before, bytes.size() - before);
        while (got < 0 && worth_another_try(fd, POLLIN, errno));
        if (got < 0) return refused(name, errno);
        bytes.resize(before + static_cast<std::size_t>(got));
        if (got == 0) break;
    }
    return bytes;
}

}  // namespace

bool is_kernel_file(const std::string& path) {
    struct statfs info {};
    return statfs(path.c_str(), &info) == 0 && is_of_kernel(info);
}

Result<std::vector<std::byte>> read_descriptor(int fd, const std::string& name, std::size_t limit,
                                               std::size_t expected) {
    Result<std::vector<std::byte>> bytes = read_up_to(fd, name, limit + 1, expected);
    if (bytes && bytes->size() > limit) return too_large(name, limit);
    return bytes;
}

Result<InputFile> InputFile::open(const std::string& path, std::size_t limit) {
    // Opening a pipe that nobody writes to would block.
    Descriptor descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
    if (descriptor.get() < 0) return refused(path, errno);
    InputFile file(std::move(descriptor), path, limit);
    struct stat info {};
    if (fstat(file.descriptor_.get(), &info) != 0) return refused(path, errno);
    if (S_ISDIR(info.st_mode)) {
        return Error{ErrorKind::bad_input,
                     fmt::format("{}: it is a folder; name a model file in it", path)};
    }
    if (const std::string_view fault = unfit(file.descriptor_.get(), info); !fault.empty()) {
        return Error{ErrorKind::bad_input, fmt::format("{}: {}", path, fault)};
    }
    file.regular_ = S_ISREG(info.st_mode);
    if (file.regular_) file.size_ = static_cast<std::size_t>(info.st_size);
    if (file.size_ > limit) return too_large(path, limit);
    return file;
}

Result<std::vector<std::byte>> InputFile::read_all() const {
    return read_descriptor(descriptor_.get(), path_, limit_, size_);
}

Result<std::vector<std::byte>> InputFile::read_beginning(std::size_t size) const {
    return read_up_to(descriptor_.get(), path_, size);
}

}  // namespace sightline::load
