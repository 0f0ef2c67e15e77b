// Files that appear complete or not at all: write beside the target, then rename.
#include "image/atomic_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <thread>
#include <utility>

#include "image/write_all.hpp"

namespace sightline {
namespace {

constexpr std::size_t kBufferSize = std::size_t{1} << 18;

constexpr std::size_t kLongestPath = 4096;  // PATH_MAX of Linux, the closing zero included

std::string folder_of(const std::string& path) {
    const std::size_t slash = path.find_last_of('/');
    if (slash == std::string::npos) return ".";
    return slash == 0 ? "/" : path.substr(0, slash);
}

std::string way_out(int error_number, const std::string& path) {
    switch (error_number) {
        case ENOTDIR:
            return fmt::format("'{}' is no folder", folder_of(path));
        case ENOENT:
            return folder_of(path) == "."
                       ? "the working folder is gone, change to another"
                       : fmt::format("create the folder '{}' first", folder_of(path));
        case EACCES:
        case EPERM:
        case EROFS:
            return "check the permissions of the file and its folder, or write elsewhere";
        case ENOSPC:
        case EDQUOT:
        case EFBIG:
            return "free some space or write to another disk";
        case EISDIR:
            return "give the name of a file in that folder";
        case ENXIO:
            return "nobody reads that pipe, or there is no such device: start what reads it";
        case EPIPE:
            return "the program that reads the output has gone";
        case ENAMETOOLONG:
            return "choose a shorter name";
        default:
            return "write elsewhere";
    }
}

Error write_error(const std::string& path, int error_number) {
    const std::string name = path == "-" ? "standard output" : fmt::format("'{}'", path);
    return {ErrorKind::io,
            fmt::format("cannot write {}: {}; {}", name,
                        std::system_category().message(error_number), way_out(error_number, path))};
}

/// Follows a link, so that the file it names is replaced and not the link.
std::string resolved(const std::string& path) {
    std::array<char, kLongestPath> real{};
    return ::realpath(path.c_str(), real.data()) != nullptr ? real.data() : path;
}

/// Opens a device or a pipe. A pipe is given a second for somebody to open it for reading, who is
/// waited for without an end otherwise.
int open_stream(const std::string& path) {
    constexpr int kTries = 50;
    constexpr std::chrono::milliseconds kPause(20);
    int descriptor = -1;
    for (int i = 0; i < kTries; ++i) {
        descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK);
        if (descriptor >= 0 || errno != ENXIO) break;
        std::this_thread::sleep_for(kPause);
    }
    if (descriptor >= 0) ::fcntl(descriptor, F_SETFL, O_WRONLY);
    return descriptor;
}

}  // namespace

Result<AtomicFile> AtomicFile::create(const std::string& path, Access access) {
    AtomicFile file;
    file.path_ = path;
    struct stat info {};
    const bool exists = path != "-" && ::stat(path.c_str(), &info) == 0;
    const bool is_stream = path == "-" || (exists && !S_ISREG(info.st_mode));
    if (exists && S_ISDIR(info.st_mode)) return write_error(path, EISDIR);
    file.keep_all_ = is_stream && access == Access::seekable;
    if (!file.keep_all_) file.buffer_.reserve(kBufferSize);
    if (is_stream) {
        file.descriptor_ =
            path == "-" ? ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0) : open_stream(path);
        if (file.descriptor_ < 0) return write_error(path, errno);
        return file;
    }
    // A file that its owner has protected stays, though renaming over it would be allowed.
    if (exists && ::access(path.c_str(), W_OK) != 0) return write_error(path, errno);
    if (Status opened = file.open_temporary(exists ? resolved(path) : path); !opened) {
        return opened.error();
    }
    if (exists && ::fchmod(file.descriptor_, info.st_mode & 07777) != 0) {
        return write_error(path, errno);
    }
    return file;
}

Status AtomicFile::open_temporary(const std::string& target) {
    if (target.empty() || target.back() == '/') return write_error(path_, ENOENT);
    temporary_ = TemporaryFile(folder_of(target));
    // In one step, so that a signal finds the file or prevents it. Whatever bears the name already
    // is not ours, and not followed if it is a link.
    const UninterruptedStep step;
    descriptor_ = ::open(temporary_.path().c_str(),
                         O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor_ < 0) {
        const int error_number = errno;
        temporary_.release();
        return write_error(path_, error_number);
    }
    target_ = target;
    return success();
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept { swap(other); }

AtomicFile& AtomicFile::operator=(AtomicFile&& other) noexcept {
    AtomicFile taken(std::move(other));
    swap(taken);
    return *this;
}

AtomicFile::~AtomicFile() { abandon(); }

void AtomicFile::swap(AtomicFile& other) noexcept {
    path_.swap(other.path_);
    target_.swap(other.target_);
    std::swap(temporary_, other.temporary_);
    std::swap(descriptor_, other.descriptor_);
    std::swap(keep_all_, other.keep_all_);
    std::swap(position_, other.position_);
    buffer_.swap(other.buffer_);
    error_.swap(other.error_);
}

void AtomicFile::abandon() noexcept {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
    temporary_ = {};
}

Status AtomicFile::status() const {
    if (error_) return *error_;
    return success();
}

Status AtomicFile::fail(int error_number) {
    if (!error_) error_ = write_error(path_, error_number);
    return *error_;
}

Status AtomicFile::write_through(const char* data, std::size_t size) {
    const int error_number = write_all(descriptor_, data, size);
    return error_number == 0 ? success() : fail(error_number);
}

Status AtomicFile::flush() {
    if (error_) return *error_;
    Status done = write_through(buffer_.data(), buffer_.size());
    buffer_.clear();
    return done;
}

Status AtomicFile::write(const void* data, std::size_t size) {
    if (error_) return *error_;
    if (size == 0) return success();
    const char* bytes = static_cast<const char*>(data);
    if (keep_all_) {
        if (buffer_.size() < position_ + size) buffer_.resize(position_ + size);
        std::memcpy(buffer_.data() + position_, bytes, size);
        position_ += size;
        return success();
    }
    position_ += size;
    if (buffer_.size() + size > kBufferSize) {
        if (Status flushed = flush(); !flushed) return flushed;
        if (size >= kBufferSize) return write_through(bytes, size);
    }
    buffer_.insert(buffer_.end(), bytes, bytes + size);
    return success();
}

Status AtomicFile::seek(std::uint64_t position) {
    if (error_) return *error_;
    if (!keep_all_) {
        if (Status flushed = flush(); !flushed) return flushed;
        if (::lseek(descriptor_, static_cast<off_t>(position), SEEK_SET) < 0) return fail(errno);
    }
    position_ = position;
    return success();
}

Status AtomicFile::commit() {
    if (Status flushed = flush(); !flushed) return flushed;
    const int descriptor = std::exchange(descriptor_, -1);
    // Some file systems report a full disk only now. The number is closed even after EINTR.
    if (::close(descriptor) != 0 && errno != EINTR) return fail(errno);
    if (temporary_.path().empty()) return success();
    const UninterruptedStep step;
    if (::rename(temporary_.path().c_str(), target_.c_str()) != 0) return fail(errno);
    temporary_.release();
    return success();
}

}  // namespace sightline
