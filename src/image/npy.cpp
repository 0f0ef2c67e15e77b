// NumPy .npy files: R. Kern, "NEP 1: A simple file format for NumPy arrays", 2007.
#include <fmt/core.h>

#include <bit>
#include <utility>

#include "image/npy_writer.hpp"
#include "sightline/image.hpp"

namespace sightline {
namespace {

static_assert(std::endian::native == std::endian::little, "pixels are written as they stand");

template <class T>
Status write_array(const std::string& path, const Image<T>& image, std::uint32_t channels,
                   std::string_view type) {
    Result<NpyWriter> writer = NpyWriter::create(path, image.width, image.height, channels, type);
    if (!writer) return writer.error();
    if (Status written = writer->write(std::as_bytes(std::span(image.pixels))); !written) {
        return written;
    }
    return writer->finish();
}

}  // namespace

Result<NpyWriter> NpyWriter::create(const std::string& path, std::uint32_t width,
                                    std::uint32_t height, std::uint32_t channels,
                                    std::string_view type) {
    Result<AtomicFile> file = AtomicFile::create(path, AtomicFile::Access::sequential);
    if (!file) return file.error();
    const std::string shape = channels == 0 ? fmt::format("({}, {})", height, width)
                                            : fmt::format("({}, {}, {})", height, width, channels);
    std::string header =
        fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", type, shape);
    // Magic, version and length take 10 bytes; the data begin at a multiple of 64.
    constexpr std::size_t kPrefix = 10, kAlignment = 64;
    const std::size_t end = kPrefix + header.size() + 1;
    header.append((kAlignment - end % kAlignment) % kAlignment, ' ');
    header += '\n';
    std::string prefix("\x93NUMPY\x01\x00", 8);
    prefix += static_cast<char>(header.size() & 255);
    prefix += static_cast<char>(header.size() >> 8);
    const std::string all = prefix + header;
    if (Status written = file->write(all.data(), all.size()); !written) return written.error();
    return NpyWriter(std::move(*file));
}

Status NpyWriter::write(std::span<const std::byte> bytes) {
    return file_.write(bytes.data(), bytes.size());
}

Status NpyWriter::finish() { return file_.commit(); }

Status write_npy(const std::string& path, const DepthImage& depth) {
    return write_array(path, depth, 0, "<f4");
}
Status write_npy(const std::string& path, const IdImage& ids) {
    return write_array(path, ids, 0, "<u4");
}
Status write_npy(const std::string& path, const NormalImage& normals) {
    static_assert(sizeof(glm::vec3) == 12);
    return write_array(path, normals, 3, "<f4");
}
Status write_npy(const std::string& path, const MaskImage& mask) {
    return write_array(path, mask, 0, "|u1");
}
Status write_npy(const std::string& path, const ColorImage& color) {
    static_assert(sizeof(glm::vec4) == 16);
    return write_array(path, color, 4, "<f4");
}

}  // namespace sightline
