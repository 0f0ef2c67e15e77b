#include "image/exr_stream.hpp"

#include <ImathBox.h>
#include <fmt/core.h>

namespace sightline {
namespace {

/// zlib's: measured on 1080p pictures, higher levels take longer for little.
constexpr int kCompressionLevel = 1;

Imath::V2i vector_of(glm::ivec2 v) { return {v.x, v.y}; }

}  // namespace

Error ExrStream::error(std::string_view cause) const {
    if (const Status status = file_.status(); !status) return status.error();
    return exr_error(file_.path(), cause);
}

Error exr_error(const std::string& path, std::string_view cause) {
    return {ErrorKind::bad_option,
            fmt::format("cannot write '{}': {}; choose another size or format", path, cause)};
}

Imf::Header exr_header(std::uint32_t width, std::uint32_t height, const Placement& placement,
                       Imf::Compression compression) {
    const glm::ivec2 first = placement.origin,
                     last = first +
                            glm::ivec2(static_cast<int>(width) - 1, static_cast<int>(height) - 1);
    const Imath::Box2i data(vector_of(first), vector_of(last));
    Imath::Box2i display = data;
    if (placement.frame) {
        display = {vector_of(placement.frame->first), vector_of(placement.frame->last)};
    }
    Imf::Header header(display, data);
    header.compression() = compression;
    header.zipCompressionLevel() = kCompressionLevel;
    return header;
}

}  // namespace sightline
