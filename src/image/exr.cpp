// OpenEXR files: F. Kainz, R. Bogart, D. Hess, "The OpenEXR image file format", 2004.
//
// One scan-line part. Colour is half, whatever is measured (Z, N) float, ids are uint. The header
// holds what the format demands and nothing that differs from run to run.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfThreading.h>
#include <half.h>

#include <algorithm>
#include <array>
#include <exception>
#include <utility>
#include <vector>

#include "image/atomic_file.hpp"
#include "image/exr_stream.hpp"
#include "image/exr_writer.hpp"
#include "sightline/image.hpp"

namespace sightline {
namespace {

Imf::Header header_of(std::uint32_t width, std::uint32_t height, const ExrChannels& channels,
                      const Placement& placement) {
    Imf::Header header = exr_header(width, height, placement, Imf::ZIP_COMPRESSION);
    const auto insert = [&header](const char* name, Imf::PixelType type) {
        header.channels().insert(name, Imf::Channel(type));
    };
    if (channels.color) {
        for (const char* name : {"R", "G", "B", "A"}) insert(name, Imf::HALF);
    }
    if (channels.depth) insert("Z", Imf::FLOAT);
    if (channels.normals) {
        for (const char* name : {"N.X", "N.Y", "N.Z"}) insert(name, Imf::FLOAT);
    }
    if (channels.objects) insert("object", Imf::UINT);
    if (channels.triangles) insert("triangle", Imf::UINT);
    return header;
}

/// As many threads as the application has given to OpenEXR's pool (none unless it asks), and no
/// more than kBufferBytes allow: for each it keeps two blocks of 16 rows, each of them about three
/// times, plain and compressed.
int threads_for(std::uint32_t width, const ExrChannels& channels) {
    constexpr std::uint64_t kBufferBytes = std::uint64_t{96} << 20, kPerThread = 2 * 3 * 16;
    const std::uint64_t pixel = (channels.color ? 8u : 0u) + (channels.depth ? 4u : 0u) +
                                (channels.normals ? 12u : 0u) + (channels.objects ? 4u : 0u) +
                                (channels.triangles ? 4u : 0u);
    const std::uint64_t most =
        kBufferBytes / std::max<std::uint64_t>(1, kPerThread * pixel * width);
    return static_cast<int>(std::min(most, static_cast<std::uint64_t>(Imf::globalThreadCount())));
}

}  // namespace

struct ExrWriter::State {
    State(AtomicFile target, std::uint32_t w, std::uint32_t h, const ExrChannels& channels,
          const Placement& placement)
        : stream(std::move(target)), width(w), next_row(placement.origin) {
        output.emplace(stream, header_of(w, h, channels, placement), threads_for(w, channels));
    }

    /// A slice of `components` interleaved numbers of type T, the first one at `rows`, which is
    /// the start of row next_row.
    template <class T>
    Imf::Slice slice(Imf::PixelType type, const T* rows, std::size_t components) const {
        const std::size_t step = sizeof(T) * components, stride = step * width;
        return {type, exr_base(rows, next_row, step, stride), step, stride};
    }

    void write(const ExrRows& rows, std::uint32_t count) {
        Imf::FrameBuffer frame;
        if (rows.color != nullptr) insert_color(frame, rows.color, count);
        if (rows.depth != nullptr) frame.insert("Z", slice(Imf::FLOAT, rows.depth, 1));
        if (rows.normals != nullptr) {
            const float* first = &rows.normals->x;
            constexpr std::array<const char*, 3> kNames = {"N.X", "N.Y", "N.Z"};
            for (std::size_t k = 0; k < 3; ++k) {
                frame.insert(kNames[k], slice(Imf::FLOAT, first + k, 3));
            }
        }
        if (rows.objects != nullptr) frame.insert("object", slice(Imf::UINT, rows.objects, 1));
        if (rows.triangles != nullptr) {
            frame.insert("triangle", slice(Imf::UINT, rows.triangles, 1));
        }
        output->setFrameBuffer(frame);
        output->writePixels(static_cast<int>(count));
        next_row.y += static_cast<int>(count);
    }

    void insert_color(Imf::FrameBuffer& frame, const glm::vec4* color, std::uint32_t count) {
        halves.resize(std::size_t{count} * width * 4);
        const float* from = &color->x;
        std::transform(from, from + halves.size(), halves.begin(), [](float v) { return half(v); });
        constexpr std::array<const char*, 4> kNames = {"R", "G", "B", "A"};
        for (std::size_t k = 0; k < 4; ++k) {
            frame.insert(kNames[k], slice(Imf::HALF, halves.data() + k, 4));
        }
    }

    ExrStream stream;  // before output, which writes its last bytes when it goes
    std::optional<Imf::OutputFile> output;
    std::uint32_t width = 0;
    glm::ivec2 next_row;  // coordinates of its first pixel in the file
    std::vector<half> halves;
};

ExrWriter::ExrWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
ExrWriter::ExrWriter(ExrWriter&&) noexcept = default;
ExrWriter& ExrWriter::operator=(ExrWriter&&) noexcept = default;
ExrWriter::~ExrWriter() = default;

Result<ExrWriter> ExrWriter::create(const std::string& path, std::uint32_t width,
                                    std::uint32_t height, ExrChannels channels,
                                    const Placement& placement) {
    Result<AtomicFile> file = AtomicFile::create(path, AtomicFile::Access::seekable);
    if (!file) return file.error();
    if (width == 0 || height == 0) return exr_error(path, "the picture has no pixels");
    try {
        return ExrWriter(
            std::make_unique<State>(std::move(*file), width, height, channels, placement));
    } catch (const std::exception& e) {
        return exr_error(path, e.what());
    }
}

Status ExrWriter::write_rows(const ExrRows& rows, std::uint32_t count) {
    try {
        state_->write(rows, count);
        return success();
    } catch (const std::exception& e) {
        return state_->stream.error(e.what());
    }
}

Status ExrWriter::finish() {
    state_->output.reset();  // writes the table of rows; a failure sticks to the file
    return state_->stream.file().commit();
}

namespace {

/// Sizes of the layers that are there; nothing when they differ or there is none.
std::optional<std::pair<std::uint32_t, std::uint32_t>> common_size(const ExrLayers& layers) {
    std::optional<std::pair<std::uint32_t, std::uint32_t>> size;
    bool equal = true;
    const auto look = [&](const auto* image) {
        if (image == nullptr) return;
        const std::pair own(image->width, image->height);
        equal = equal && (!size || *size == own);
        size = own;
    };
    look(layers.color);
    look(layers.depth);
    look(layers.normals);
    look(layers.objects);
    look(layers.triangles);
    if (!equal) return std::nullopt;
    return size;
}

template <class T>
const T* row_of(const Image<T>* image, std::uint32_t y) {
    return image == nullptr ? nullptr : image->row(y).data();
}

}  // namespace

Status write_exr(const std::string& path, const ExrLayers& layers) {
    const auto size = common_size(layers);
    if (!size) return exr_error(path, "its layers are missing or differ in size");
    const auto [width, height] = *size;
    Result<ExrWriter> writer = ExrWriter::create(
        path, width, height,
        {layers.color != nullptr, layers.depth != nullptr, layers.normals != nullptr,
         layers.objects != nullptr, layers.triangles != nullptr},
        layers.placement);
    if (!writer) return writer.error();
    constexpr std::uint32_t kBlockRows = 64;  // a multiple of the 16 rows of a compressed block
    for (std::uint32_t y = 0; y < height; y += kBlockRows) {
        const ExrRows rows{row_of(layers.color, y), row_of(layers.depth, y),
                           row_of(layers.normals, y), row_of(layers.objects, y),
                           row_of(layers.triangles, y)};
        const Status written = writer->write_rows(rows, std::min(kBlockRows, height - y));
        if (!written) return written;
    }
    return writer->finish();
}

}  // namespace sightline
