// Files that are renamed or removed in the end, whatever happens: their names and their list.
#pragma once

#include <csignal>
#include <string>

namespace sightline {

/// While it lives this thread takes no signal, and a signal handler in another thread waits for its
/// end before it removes files: what is done in it to names of files happens whole or not at all.
/// Keep it short.
class UninterruptedStep {
public:
    UninterruptedStep() noexcept;
    ~UninterruptedStep();
    UninterruptedStep(const UninterruptedStep&) = delete;
    UninterruptedStep& operator=(const UninterruptedStep&) = delete;

private:
    sigset_t before_{};
};

/// A name for a file that must not stay: whatever bears it is removed by the destructor, and by
/// remove_temporary_files_from_signal_handler(). The name has 128 random bits, so that nobody can
/// have put a link there beforehand. Movable.
class TemporaryFile {
public:
    /// No name.
    TemporaryFile() = default;
    /// A name in the folder, under which there is no file yet: whoever makes it does so after this.
    explicit TemporaryFile(const std::string& folder);
    TemporaryFile(TemporaryFile&& other) noexcept { swap(other); }
    TemporaryFile& operator=(TemporaryFile&& other) noexcept;
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile();

    /// Empty when there is no name.
    [[nodiscard]] const std::string& path() const { return path_; }
    /// Gives up the name without removing anything, since the file has another name now.
    void release() noexcept;

private:
    void swap(TemporaryFile& other) noexcept;

    std::string path_;
    int slot_ = -1;  // in the list for signal handlers
};

/// Removes all temporary files. For a signal handler that ends the program right after it: threads
/// that are about to make or rename a file stand still from now on. Files beyond the first 64 at a
/// time are not known to it.
void remove_temporary_files_from_signal_handler() noexcept;

}  // namespace sightline
