// PNG files are made band by band, on all cores; what NPY and EXR files hold is made in strips of
// rows first, so that little of it stands in memory.
#include "shading/picture_sink.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "image/exr_writer.hpp"
#include "image/npy_writer.hpp"
#include "image/png_rows.hpp"
#include "image/png_writer.hpp"

namespace sightline {
namespace {

using SinkResult = Result<std::unique_ptr<PictureSink>>;

/// Makes one row: (row that the source holds, out).
template <class T>
using RowMaker = std::function<void(std::uint32_t, T*)>;

/// Rows of a strip: about 2^20 pixels, and a multiple of the 16 rows that EXR compresses together.
std::uint32_t rows_per_strip(std::uint32_t width) {
    constexpr std::uint32_t kPixels = 1u << 20, kBlock = 16;
    return std::max(1u, kPixels / width / kBlock) * kBlock;
}

// -- PNG -----------------------------------------------------------------------------------------

class PngSink final : public PictureSink {
public:
    PngSink(PngWriter writer, const SinkSource& source, RowMaker<std::uint8_t> make)
        : writer_(std::move(writer)), source_(source), make_(std::move(make)) {}

    Status append(std::uint32_t first, std::uint32_t count) override {
        source_.on_stage(DrawStage::write);
        const std::size_t row_bytes = writer_.bytes_per_row();
        const auto rows = [&](std::uint32_t from, std::uint32_t n, std::uint8_t* out) {
            for (std::uint32_t i = 0; i < n; ++i) make_(from - first + i, out + i * row_bytes);
        };
        return writer_.write_rows(rows, count, source_.threads);
    }
    Status finish() override { return writer_.finish(); }

private:
    PngWriter writer_;
    const SinkSource& source_;
    RowMaker<std::uint8_t> make_;
};

SinkResult png_sink(const PictureFile& file, const SinkSource& source, PngLayout layout,
                    RowMaker<std::uint8_t> make) {
    const PngContent content =
        file.content == PictureContent::color ? PngContent::color : PngContent::data;
    Result<PngWriter> writer = PngWriter::create(file.path, source.resolution.width,
                                                 source.resolution.height, layout, content);
    if (!writer) return writer.error();
    return SinkResult(std::make_unique<PngSink>(std::move(*writer), source, std::move(make)));
}

/// Bytes of one row, from the values of a map of the row.
template <class T, class Convert>
RowMaker<std::uint8_t> converted(const SinkSource& source,
                                 void (RowMaps::*make)(std::uint32_t, T*) const, Convert convert) {
    return [&source, make, convert](std::uint32_t y, std::uint8_t* out) {
        thread_local std::vector<T> row;
        row.resize(source.resolution.width);
        (source.rows.maps().*make)(y, row.data());
        convert(row, out);
    };
}

SinkResult open_png(const PictureFile& file, const SinkSource& source) {
    switch (file.content) {
        case PictureContent::color:
            return png_sink(file, source, PngLayout::rgba8,
                            [&source](std::uint32_t y, std::uint8_t* out) {
                                using Rgba8 = std::array<std::uint8_t, 4>;
                                source.rows.rgba8(y, reinterpret_cast<Rgba8*>(out));
                            });
        case PictureContent::depth:
            return png_sink(file, source, PngLayout::grey16,
                            converted(source, &RowMaps::depth,
                                      [&source](std::span<const float> row, std::uint8_t* out) {
                                          depth_row_to_grey16(row, source.near, source.far, out);
                                      }));
        case PictureContent::ids:
            return png_sink(file, source, PngLayout::rgba8,
                            converted(source, &RowMaps::triangles, ids_row_to_rgba8));
        case PictureContent::normals:
            return png_sink(file, source, PngLayout::rgb8,
                            converted(source, &RowMaps::normals, normals_row_to_rgb8));
        case PictureContent::mask:
            return png_sink(file, source, PngLayout::grey8,
                            converted(source, &RowMaps::mask, mask_row_to_grey8));
        case PictureContent::matte:
            return png_sink(
                file, source, PngLayout::grey8, [&source](std::uint32_t y, std::uint8_t* out) {
                    thread_local std::vector<std::array<std::uint8_t, 4>> row;
                    row.resize(source.resolution.width);
                    source.rows.rgba8(y, row.data());
                    std::ranges::transform(row, out, [](const auto& rgba) { return rgba[3]; });
                });
    }
    return Error{};
}

// -- strips of rows ------------------------------------------------------------------------------

/// Some rows of one kind of value.
template <class T>
class Strip {
public:
    Strip(const SinkSource& source, RowMaker<T> make) : source_(source), make_(std::move(make)) {}

    const T* fill(std::uint32_t first, std::uint32_t count) {
        const std::size_t width = source_.resolution.width;
        values_.resize(width * count);
        for_rows(0, count, source_.threads,
                 [&](std::uint32_t y) { make_(first + y, values_.data() + y * width); });
        return values_.data();
    }
    [[nodiscard]] std::span<const T> values() const { return values_; }

private:
    const SinkSource& source_;
    RowMaker<T> make_;
    std::vector<T> values_;
};

/// body(first row, rows) for one strip after another, until one fails.
template <class Body>
Status for_strips(const SinkSource& source, std::uint32_t count, const Body& body) {
    const std::uint32_t rows = rows_per_strip(source.resolution.width);
    for (std::uint32_t y = 0; y < count; y += rows) {
        if (Status done = body(y, std::min(rows, count - y)); !done) return done;
    }
    return success();
}

// -- NPY -----------------------------------------------------------------------------------------

template <class T>
class NpySink final : public PictureSink {
public:
    NpySink(NpyWriter writer, const SinkSource& source, RowMaker<T> make)
        : writer_(std::move(writer)), source_(source), strip_(source, std::move(make)) {}

    Status append(std::uint32_t, std::uint32_t count) override {
        return for_strips(source_, count, [&](std::uint32_t first, std::uint32_t rows) {
            source_.on_stage(DrawStage::shade);
            strip_.fill(first, rows);
            source_.on_stage(DrawStage::write);
            return writer_.write(std::as_bytes(strip_.values()));
        });
    }
    Status finish() override { return writer_.finish(); }

private:
    NpyWriter writer_;
    const SinkSource& source_;
    Strip<T> strip_;
};

template <class T>
SinkResult npy_sink(const PictureFile& file, const SinkSource& source, std::uint32_t channels,
                    std::string_view type, RowMaker<T> make) {
    Result<NpyWriter> writer = NpyWriter::create(file.path, source.resolution.width,
                                                 source.resolution.height, channels, type);
    if (!writer) return writer.error();
    return SinkResult(std::make_unique<NpySink<T>>(std::move(*writer), source, std::move(make)));
}

template <class T>
RowMaker<T> map_row(const SinkSource& source, void (RowMaps::*make)(std::uint32_t, T*) const) {
    return [&source, make](std::uint32_t y, T* out) { (source.rows.maps().*make)(y, out); };
}

RowMaker<glm::vec4> color_row(const SinkSource& source) {
    return [&source](std::uint32_t y, glm::vec4* out) { source.rows.color(y, out); };
}

SinkResult open_npy(const PictureFile& file, const SinkSource& source) {
    switch (file.content) {
        case PictureContent::color:
            return npy_sink<glm::vec4>(file, source, 4, "<f4", color_row(source));
        case PictureContent::depth:
            return npy_sink<float>(file, source, 0, "<f4", map_row(source, &RowMaps::depth));
        case PictureContent::ids:
            return npy_sink<std::uint32_t>(file, source, 0, "<u4",
                                           map_row(source, &RowMaps::triangles));
        case PictureContent::normals:
            return npy_sink<glm::vec3>(file, source, 3, "<f4", map_row(source, &RowMaps::normals));
        case PictureContent::mask:
            return npy_sink<std::uint8_t>(file, source, 0, "|u1", map_row(source, &RowMaps::mask));
        case PictureContent::matte:
            return npy_sink<float>(file, source, 0, "<f4", [&source](std::uint32_t y, float* out) {
                thread_local std::vector<glm::vec4> row;
                row.resize(source.resolution.width);
                source.rows.color(y, row.data());
                std::ranges::transform(row, out, [](const glm::vec4& color) { return color.a; });
            });
    }
    return Error{};
}

// -- EXR -----------------------------------------------------------------------------------------

class ExrSink final : public PictureSink {
public:
    ExrSink(ExrWriter writer, const SinkSource& source, ExrChannels channels)
        : writer_(std::move(writer)), source_(source), channels_(channels) {}

    Status append(std::uint32_t, std::uint32_t count) override {
        return for_strips(source_, count, [&](std::uint32_t first, std::uint32_t rows) {
            source_.on_stage(DrawStage::shade);
            const auto fill = [&](bool wanted, auto& strip) {
                return wanted ? strip.fill(first, rows) : nullptr;
            };
            const ExrRows layers{fill(channels_.color, color_), fill(channels_.depth, depth_),
                                 fill(channels_.normals, normals_),
                                 fill(channels_.objects, objects_),
                                 fill(channels_.triangles, triangles_)};
            source_.on_stage(DrawStage::write);
            return writer_.write_rows(layers, rows);
        });
    }
    Status finish() override { return writer_.finish(); }

private:
    ExrWriter writer_;
    const SinkSource& source_;
    ExrChannels channels_;
    Strip<glm::vec4> color_{source_, color_row(source_)};
    Strip<float> depth_{source_, map_row(source_, &RowMaps::depth)};
    Strip<glm::vec3> normals_{source_, map_row(source_, &RowMaps::normals)};
    Strip<std::uint32_t> objects_{source_, map_row(source_, &RowMaps::objects)};
    Strip<std::uint32_t> triangles_{source_, map_row(source_, &RowMaps::triangles)};
};

/// All samples of the pixels.
class DeepSink final : public PictureSink {
public:
    DeepSink(DeepExrWriter writer, const SinkSource& source)
        : writer_(std::move(writer)), source_(source) {}

    Status append(std::uint32_t, std::uint32_t count) override {
        return for_strips(source_, count, [&](std::uint32_t first, std::uint32_t rows) {
            source_.on_stage(DrawStage::write);
            return writer_.write_rows(source_.deep->deep_rows(first, rows), rows);
        });
    }
    Status finish() override { return writer_.finish(); }

private:
    DeepExrWriter writer_;
    const SinkSource& source_;
};

SinkResult open_deep(const PictureFile& file, const SinkSource& source) {
    if (source.deep == nullptr || file.format != ImageFormat::exr)
        return Error{ErrorKind::bad_option,
                     fmt::format("cannot write '{}': only an EXR of colours weighed by area is "
                                 "deep; take the algorithm abuffer",
                                 file.path)};
    Result<DeepExrWriter> writer =
        DeepExrWriter::create(file.path, source.resolution.width, source.resolution.height);
    if (!writer) return writer.error();
    return SinkResult(std::make_unique<DeepSink>(std::move(*writer), source));
}

SinkResult open_exr(const PictureFile& file, const SinkSource& source) {
    ExrChannels channels;
    const bool color = file.content == PictureContent::color;
    const bool ids = file.content == PictureContent::ids || (color && file.add_ids);
    channels.color = color;
    channels.depth = color || file.content == PictureContent::depth;
    channels.normals = file.content == PictureContent::normals || (color && file.add_normals);
    channels.objects = channels.triangles = ids;
    if (file.content == PictureContent::mask || file.content == PictureContent::matte) {
        return Error{
            ErrorKind::bad_option,
            fmt::format("cannot write '{}': an EXR holds no mask; choose PNG or NPY", file.path)};
    }
    Result<ExrWriter> writer =
        ExrWriter::create(file.path, source.resolution.width, source.resolution.height, channels);
    if (!writer) return writer.error();
    return SinkResult(std::make_unique<ExrSink>(std::move(*writer), source, channels));
}

}  // namespace

Result<std::unique_ptr<PictureSink>> open_sink(const PictureFile& file, const SinkSource& source) {
    if (file.deep) return open_deep(file, source);
    switch (file.format) {
        case ImageFormat::png:
            return open_png(file, source);
        case ImageFormat::exr:
            return open_exr(file, source);
        case ImageFormat::npy:
            return open_npy(file, source);
    }
    return Error{};
}

}  // namespace sightline
