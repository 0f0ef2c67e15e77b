// Deep EXR files: P. Hillman, "The Theory of OpenEXR Deep Samples", 2013.
//
// One part of scan lines, each of them compressed by itself. Everything that is measured is float:
// halves would spoil the products that composition makes of many samples.
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfHeader.h>
#include <ImfPartType.h>
#include <ImfThreading.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <exception>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "image/deep_channels.hpp"
#include "image/deep_exr_writer.hpp"
#include "image/exr_stream.hpp"

namespace sightline {
namespace {

Imf::Header header_of(std::uint32_t width, std::uint32_t height, const Placement& placement) {
    Imf::Header header = exr_header(width, height, placement, Imf::ZIPS_COMPRESSION);
    header.setType(Imf::DEEPSCANLINE);
    for (const DeepChannel& channel : kDeepChannels) {
        header.channels().insert(channel.name, Imf::Channel(channel.type));
    }
    return header;
}

}  // namespace

struct DeepExrWriter::State {
    State(AtomicFile target, std::uint32_t w, std::uint32_t h, const Placement& placement)
        : stream(std::move(target)), width(w), next_row(placement.origin) {
        output.emplace(stream, header_of(w, h, placement), Imf::globalThreadCount());
    }

    /// Appends whole rows, a few at a time: for each pixel there is one address a channel.
    void write(const DeepRows& rows, std::uint32_t count) {
        constexpr std::size_t kPixels = std::size_t{1} << 16;
        const std::size_t most = std::max<std::size_t>(1, kPixels / width);
        const DeepSample* samples = rows.samples.data();
        for (std::size_t y = 0; y < count; y += most) {
            const std::size_t some = std::min(most, count - y);
            samples = write_block(rows.counts.subspan(y * width, some * width), samples);
        }
    }

    /// Returns the first sample that does not belong to the block.
    const DeepSample* write_block(std::span<const std::uint32_t> counts,
                                  const DeepSample* samples) {
        addresses.point_to(counts, samples);
        Imf::DeepFrameBuffer frame;
        addresses.insert_into(frame, counts, next_row, width,
                              [](const DeepChannel&) { return true; });
        output->setFrameBuffer(frame);
        const auto rows = static_cast<int>(counts.size() / width);
        output->writePixels(rows);
        next_row.y += rows;
        return samples + std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
    }

    ExrStream stream;  // before output, which writes its last bytes when it goes
    std::optional<Imf::DeepScanLineOutputFile> output;
    std::uint32_t width = 0;
    glm::ivec2 next_row;  // coordinates of its first pixel in the file
    DeepAddresses addresses;
};

DeepExrWriter::DeepExrWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
DeepExrWriter::DeepExrWriter(DeepExrWriter&&) noexcept = default;
DeepExrWriter& DeepExrWriter::operator=(DeepExrWriter&&) noexcept = default;
DeepExrWriter::~DeepExrWriter() = default;

Result<DeepExrWriter> DeepExrWriter::create(const std::string& path, std::uint32_t width,
                                            std::uint32_t height, const Placement& placement) {
    Result<AtomicFile> file = AtomicFile::create(path, AtomicFile::Access::seekable);
    if (!file) return file.error();
    if (width == 0 || height == 0) return exr_error(path, "the picture has no pixels");
    try {
        return DeepExrWriter(std::make_unique<State>(std::move(*file), width, height, placement));
    } catch (const std::exception& e) {
        return exr_error(path, e.what());
    }
}

Status DeepExrWriter::write_rows(const DeepRows& rows, std::uint32_t count) {
    assert(rows.counts.size() == std::size_t{state_->width} * count);
    assert(std::accumulate(rows.counts.begin(), rows.counts.end(), std::uint64_t{0}) ==
           rows.samples.size());
    try {
        state_->write(rows, count);
        return success();
    } catch (const std::exception& e) {
        return state_->stream.error(e.what());
    }
}

Status DeepExrWriter::finish() {
    state_->output.reset();  // writes the table of rows; a failure sticks to the file
    return state_->stream.file().commit();
}

Status write_deep_exr(const std::string& path, const DeepImage& image) {
    Result<DeepExrWriter> writer =
        DeepExrWriter::create(path, image.width, image.height, image.placement);
    if (!writer) return writer.error();
    constexpr std::uint32_t kBlockRows = 64;
    std::vector<std::uint32_t> counts;
    for (std::uint32_t y = 0; y < image.height; y += kBlockRows) {
        const std::uint32_t rows = std::min(kBlockRows, image.height - y);
        const std::uint64_t* first = image.first.data() + std::size_t{y} * image.width;
        counts.resize(std::size_t{rows} * image.width);
        for (std::size_t i = 0; i < counts.size(); ++i) {
            counts[i] = static_cast<std::uint32_t>(first[i + 1] - first[i]);
        }
        const DeepSample* all = image.samples.data();
        const DeepRows block{counts, {all + first[0], all + first[counts.size()]}};
        if (Status written = writer->write_rows(block, rows); !written) return written;
    }
    return writer->finish();
}

}  // namespace sightline
