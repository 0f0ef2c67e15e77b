// A file that appears complete or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "image/temporary_file.hpp"
#include "sightline/error.hpp"

namespace sightline {

/// Writes to a temporary file in the folder of the target and renames it when all is written, so
/// that a failure leaves neither a partial file nor harm to one that stood there. A target that
/// exists and is no ordinary file (a device, a pipe) is written to directly, and "-" is standard
/// output.
///
/// The first failure sticks: later writes do nothing and commit() returns it. Not thread-safe;
/// different files may be written by different threads.
class AtomicFile {
public:
    enum class Access {
        sequential,  ///< seek() is not called; a stream gets bytes as they come
        seekable,    ///< seek() may be called; bytes for a stream are kept until commit()
    };

    /// Errors (io): missing folder, no permission, target is a folder...
    [[nodiscard]] static Result<AtomicFile> create(const std::string& path, Access access);

    AtomicFile(AtomicFile&& other) noexcept;
    AtomicFile& operator=(AtomicFile&& other) noexcept;
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;
    /// Removes the temporary file unless committed.
    ~AtomicFile();

    /// Appends at the current position.
    Status write(const void* data, std::size_t size);
    Status seek(std::uint64_t position);
    [[nodiscard]] std::uint64_t position() const { return position_; }
    /// The first failure, if there was one.
    [[nodiscard]] Status status() const;
    /// Completes the file under its own name. Call once, last.
    Status commit();

    [[nodiscard]] const std::string& path() const { return path_; }

private:
    AtomicFile() = default;
    Status open_temporary(const std::string& target);
    Status fail(int error_number);
    Status flush();
    Status write_through(const char* data, std::size_t size);
    void abandon() noexcept;
    void swap(AtomicFile& other) noexcept;

    std::string path_;         // as the caller wrote it
    std::string target_;       // what the temporary file is renamed to; empty for a stream
    TemporaryFile temporary_;  // without a name for a stream
    int descriptor_ = -1;
    bool keep_all_ = false;  // a stream that may be sought in: all bytes stay in buffer_
    std::uint64_t position_ = 0;
    std::vector<char> buffer_;
    std::optional<Error> error_;
};

}  // namespace sightline
