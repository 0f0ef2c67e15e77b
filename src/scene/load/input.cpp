#include "scene/load/input.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

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
            fmt::format("{}: more than {} MiB; use a smaller model or raise the "
                        "limit on file size",
                        name, limit >> 20)};
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
        while (got < 0 && errno == EINTR);
        if (got < 0) return refused(name, errno);
        bytes.resize(before + static_cast<std::size_t>(got));
        if (got == 0) break;
    }
    return bytes;
}

}  // namespace

Result<std::vector<std::byte>> read_descriptor(int fd, const std::string& name, std::size_t limit,
                                               std::size_t expected) {
    Result<std::vector<std::byte>> bytes = read_up_to(fd, name, limit + 1, expected);
    if (bytes && bytes->size() > limit) return too_large(name, limit);
    return bytes;
}

Result<InputFile> InputFile::open(const std::string& path, std::size_t limit) {
    Descriptor descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (descriptor.get() < 0) return refused(path, errno);
    InputFile file(std::move(descriptor), path, limit);
    struct stat info {};
    if (fstat(file.descriptor_.get(), &info) != 0) return refused(path, errno);
    if (S_ISDIR(info.st_mode)) {
        return Error{ErrorKind::bad_input,
                     fmt::format("{}: it is a folder; name a model file in it", path)};
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
