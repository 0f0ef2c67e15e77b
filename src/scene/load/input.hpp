// Reading files whole or in part, with a limit on their size.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scene/load/descriptor.hpp"
#include "sightline/error.hpp"

namespace sightline::load {

/// Everything up to the end of an open file; bad_input when there is more than `limit` bytes, io
/// when the system refuses. Quickest when there are as many as `expected`.
[[nodiscard]] Result<std::vector<std::byte>> read_descriptor(int fd, const std::string& name,
                                                             std::size_t limit,
                                                             std::size_t expected = 0);

/// Whether the kernel makes up what this file holds, as in /proc and /sys.
[[nodiscard]] bool is_kernel_file(const std::string& path);

/// A file open for reading. Movable.
class InputFile {
public:
    /// Errors: io when it is missing or may not be read; bad_input when it is a folder, a device, a
    /// file of the kernel, a pipe that nobody writes to, or a regular file of more than `limit`
    /// bytes.
    [[nodiscard]] static Result<InputFile> open(const std::string& path, std::size_t limit);

    [[nodiscard]] bool is_regular() const { return regular_; }
    [[nodiscard]] Result<std::vector<std::byte>> read_all() const;
    /// The first `size` bytes, or as many as there are. Precondition: nothing read yet.
    [[nodiscard]] Result<std::vector<std::byte>> read_beginning(std::size_t size) const;

private:
    InputFile(Descriptor descriptor, std::string path, std::size_t limit)
        : descriptor_(std::move(descriptor)), path_(std::move(path)), limit_(limit) {}

    Descriptor descriptor_;
    std::string path_;
    std::size_t limit_;
    bool regular_ = false;
    std::size_t size_ = 0;  ///< when it was opened, of a regular file
};

}  // namespace sightline::load
