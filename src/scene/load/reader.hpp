// What the readers of our own (OBJ, STL, PLY) have in common. They run in the calling process:
// every index and count is checked, no loop or allocation grows beyond a small multiple of the
// file's size, and the result is a soup like any other.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "scene/load/named_files.hpp"
#include "scene/load/soup.hpp"
#include "sightline/error.hpp"

namespace sightline::load {

/// The file at hand and the limits on reading it.
class ReadContext {
public:
    /// `path` is "" for a model in memory. `allowed_paths`: see LoadOptions.
    ReadContext(std::string name, std::string path, double seconds, std::size_t memory_bytes,
                const std::vector<std::string>& allowed_paths = {});

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] const std::string& path() const { return path_; }
    [[nodiscard]] const NamedFiles& named_files() const { return named_files_; }

    /// An error when reading would take more memory than the limit, or has taken too long already.
    [[nodiscard]] Status check(std::uint64_t bytes_of_memory) const;

    /// "FILE: not a readable FORMAT file (WHAT); check or export it again".
    [[nodiscard]] Error unreadable(std::string_view format, std::string_view what) const;
    /// "FILE:LINE: WHAT; repair the line or export the file again".
    [[nodiscard]] Error at_line(std::string_view text, std::size_t offset,
                                std::string_view what) const;

private:
    std::string name_, path_;
    NamedFiles named_files_;
    double seconds_;
    std::size_t memory_bytes_;
    std::chrono::steady_clock::time_point start_;
};

/// Whether one of the readers below is for this format (an extension in lower case).
[[nodiscard]] bool has_own_reader(std::string_view format);

/// Reads a model of such a format. Errors: bad_input. Uses all cores; the result depends on the
/// bytes alone. O(bytes).
[[nodiscard]] Result<Soup> read_own_format(std::string_view format, std::string_view bytes,
                                           const ReadContext& context);

}  // namespace sightline::load
