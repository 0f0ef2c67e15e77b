// Pictures and maps as PNG files.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "image/png_rows.hpp"
#include "image/png_writer.hpp"
#include "sightline/image.hpp"

namespace sightline {
namespace {

/// Writes an image; convert(row of pixels, bytes of the row) makes the file's bytes.
template <class T, class Convert>
Status write_png(const std::string& path, const Image<T>& image, PngLayout layout,
                 PngContent content, const Convert& convert) {
    Result<PngWriter> writer = PngWriter::create(path, image.width, image.height, layout, content);
    if (!writer) return writer.error();
    const std::size_t row_bytes = writer->bytes_per_row();
    const auto source = [&](std::uint32_t first, std::uint32_t count, std::uint8_t* out) {
        for (std::uint32_t i = 0; i < count; ++i) {
            convert(image.row(first + i), out + i * row_bytes);
        }
    };
    if (Status written = writer->write_rows(source, image.height, 0); !written) return written;
    return writer->finish();
}

}  // namespace

std::array<std::uint8_t, 4> color_to_rgba8(glm::vec4 color) {
    const float alpha = std::clamp(color.a, 0.0f, 1.0f);
    const float factor = alpha > 0 ? 1.0f / alpha : 0.0f;
    return {to_srgb8(color.r * factor), to_srgb8(color.g * factor), to_srgb8(color.b * factor),
            static_cast<std::uint8_t>(alpha * 255.0f + 0.5f)};
}

void color_row_to_rgba8(std::span<const glm::vec4> row, std::uint8_t* out) {
    // Neighbours are often equal (the background, flat faces): convert such runs once.
    glm::vec4 last{0, 0, 0, 0};
    std::array<std::uint8_t, 4> bytes{0, 0, 0, 0};
    for (const glm::vec4& pixel : row) {
        if (pixel != last) {
            last = pixel;
            bytes = color_to_rgba8(pixel);
        }
        std::memcpy(out, bytes.data(), bytes.size());
        out += bytes.size();
    }
}

void depth_row_to_grey16(std::span<const float> row, double near, double far, std::uint8_t* out) {
    const double scale = 65535.0 / (far - near);
    for (const float depth : row) {
        // A comparison that NaN and infinity fail gives them the background's value.
        const double value = (double{depth} - near) * scale;
        const auto grey =
            value < 65535.0 ? static_cast<unsigned>(std::max(value, 0.0) + 0.5) : 65535u;
        *out++ = static_cast<std::uint8_t>(grey >> 8);
        *out++ = static_cast<std::uint8_t>(grey & 255);
    }
}

void normals_row_to_rgb8(std::span<const glm::vec3> row, std::uint8_t* out) {
    const auto byte = [](float component) {
        const float unit = std::clamp((component + 1.0f) * 0.5f, 0.0f, 1.0f);
        return static_cast<std::uint8_t>(unit * 255.0f + 0.5f);
    };
    for (const glm::vec3& normal : row) {
        const bool seen = normal != glm::vec3(0.0f);
        for (int k = 0; k < 3; ++k) *out++ = seen ? byte(normal[k]) : std::uint8_t{0};
    }
}

void ids_row_to_rgba8(std::span<const std::uint32_t> row, std::uint8_t* out) {
    static_assert(std::endian::native == std::endian::little);
    std::memcpy(out, row.data(), row.size_bytes());
}

void mask_row_to_grey8(std::span<const std::uint8_t> row, std::uint8_t* out) {
    for (const std::uint8_t seen : row) *out++ = seen != 0 ? std::uint8_t{255} : std::uint8_t{0};
}

Status write_color_png(const std::string& path, const ColorImage& image) {
    return write_png(path, image, PngLayout::rgba8, PngContent::color, color_row_to_rgba8);
}

Status write_depth_png(const std::string& path, const DepthImage& depth, double near, double far) {
    return write_png(path, depth, PngLayout::grey16, PngContent::data,
                     [near, far](std::span<const float> row, std::uint8_t* out) {
                         depth_row_to_grey16(row, near, far, out);
                     });
}

Status write_normals_png(const std::string& path, const NormalImage& normals) {
    return write_png(path, normals, PngLayout::rgb8, PngContent::data, normals_row_to_rgb8);
}

Status write_ids_png(const std::string& path, const IdImage& ids) {
    return write_png(path, ids, PngLayout::rgba8, PngContent::data, ids_row_to_rgba8);
}

Status write_mask_png(const std::string& path, const MaskImage& mask) {
    return write_png(path, mask, PngLayout::grey8, PngContent::data, mask_row_to_grey8);
}

}  // namespace sightline
