#include "scene/load/reader.hpp"

#include <fmt/format.h>

#include "scene/load/obj_reader.hpp"
#include "scene/load/ply_reader.hpp"
#include "scene/load/scan.hpp"
#include "scene/load/stl_reader.hpp"

namespace sightline::load {

ReadContext::ReadContext(std::string name, std::string path, double seconds,
                         std::size_t memory_bytes, const std::vector<std::string>& allowed_paths)
    : name_(std::move(name)),
      path_(std::move(path)),
      named_files_(path_, allowed_paths),
      seconds_(seconds),
      memory_bytes_(memory_bytes),
      start_(std::chrono::steady_clock::now()) {}

Status ReadContext::check(std::uint64_t bytes_of_memory) const {
    if (bytes_of_memory > memory_bytes_) {
        return Error{ErrorKind::bad_input,
                     fmt::format("{}: reading it takes more than {} MiB of memory; use a "
                                 "smaller or repaired file",
                                 name_, memory_bytes_ >> 20)};
    }
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start_;
    if (taken.count() > seconds_) {
        return Error{ErrorKind::bad_input,
                     fmt::format("{}: reading it took longer than {:g} s; use a smaller or "
                                 "repaired file",
                                 name_, seconds_)};
    }
    return success();
}

Error ReadContext::unreadable(std::string_view format, std::string_view what) const {
    return {ErrorKind::bad_input,
            fmt::format("{}: not a readable {} file ({}); check or export it again", name_, format,
                        what)};
}

Error ReadContext::at_line(std::string_view text, std::size_t offset, std::string_view what) const {
    return {ErrorKind::bad_input, fmt::format("{}:{}: {}; repair the line or export the file again",
                                              name_, line_number(text, offset), what)};
}

bool has_own_reader(std::string_view format) {
    return format == "obj" || format == "ply" || format == "stl";
}

Result<Soup> read_own_format(std::string_view format, std::string_view bytes,
                             const ReadContext& context) {
    if (format == "obj") return read_obj(bytes, context);
    if (format == "ply") return read_ply(bytes, context);
    return read_stl(bytes, context);
}

}  // namespace sightline::load
