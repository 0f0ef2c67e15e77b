// PNG files (PNG specification, second edition, 2003): the container around the bands.
//
// Written here and not by libpng, which compresses on one thread, byte by byte, and then takes
// longer than all the rest of a rendering; docs/dependencies.md has the measurements. libpng reads
// the files back in the tests.
#include "image/png_writer.hpp"

#include <fmt/core.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_pipeline.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <utility>
#include <vector>

#include "image/atomic_file.hpp"
#include "image/png_band.hpp"
#include "math/arena.hpp"

namespace sightline {
namespace {

constexpr std::array<std::uint8_t, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr std::array<std::uint8_t, 2> kZlibHeader = {0x78, 0x01};  // a window of 32 KiB, fastest
constexpr std::array<std::uint8_t, 1> kPerceptual = {0};           // the intent of sRGB
/// PNG's own limit of a side, and ours of a row, which also bounds the chunk of a band.
constexpr std::uint32_t kLongestSide = 0x7FFFFFFF;
constexpr std::uint64_t kLongestRow = std::uint64_t{1} << 30;

struct Format {
    std::uint8_t color_type, bit_depth;
    std::size_t bytes_per_pixel;
};

Format format_of(PngLayout layout) {
    switch (layout) {
        case PngLayout::grey8:
            return {0, 8, 1};
        case PngLayout::grey16:
            return {0, 16, 2};
        case PngLayout::rgb8:
            return {2, 8, 3};
        case PngLayout::rgba8:
            return {6, 8, 4};
    }
    return {};
}

std::array<std::uint8_t, 4> big_endian(std::uint32_t n) {
    return {static_cast<std::uint8_t>(n >> 24), static_cast<std::uint8_t>(n >> 16),
            static_cast<std::uint8_t>(n >> 8), static_cast<std::uint8_t>(n)};
}

}  // namespace

struct PngWriter::State {
    explicit State(AtomicFile target) : file(std::move(target)) {}

    /// The first failure sticks to the file, which is asked for it in the end.
    void put(std::span<const std::uint8_t> bytes) {
        static_cast<void>(file.write(bytes.data(), bytes.size()));
    }

    void write_chunk(std::string_view type, std::span<const std::uint8_t> data) {
        const std::span name(reinterpret_cast<const std::uint8_t*>(type.data()), type.size());
        uLong crc = crc32_z(0, name.data(), name.size());
        if (!data.empty()) crc = crc32_z(crc, data.data(), data.size());  // 0 for a null pointer
        put(big_endian(static_cast<std::uint32_t>(data.size())));
        put(name);
        put(data);
        put(big_endian(static_cast<std::uint32_t>(crc)));
    }

    void write_head(const Format& format, PngContent content) {
        put(kSignature);
        std::array<std::uint8_t, 13> head{};
        std::ranges::copy(big_endian(shape.width), head.begin());
        std::ranges::copy(big_endian(shape.height), head.begin() + 4);
        head[8] = format.bit_depth;
        head[9] = format.color_type;
        write_chunk("IHDR", head);
        if (content == PngContent::color) write_chunk("sRGB", kPerceptual);
        write_chunk("IDAT", kZlibHeader);
    }

    void append(const PngBand& band) {
        write_chunk("IDAT", band.data);
        adler = static_cast<std::uint32_t>(
            adler32_combine(adler, band.adler, static_cast<z_off_t>(band.decoded_size)));
        ++bands_written;
    }

    void write_bands(const PngRowSource& source, std::uint32_t end, int threads);

    AtomicFile file;
    PngShape shape;
    std::uint32_t adler = 1, bands_written = 0, rows_taken = 0;
    std::vector<std::uint8_t> waiting;  // rows of a band that is not complete
};

/// Writes the bands before `end` that are not written yet; the first of them may have rows waiting.
void PngWriter::State::write_bands(const PngRowSource& source, std::uint32_t end, int threads) {
    struct Scratch {
        std::vector<std::uint8_t> rows;
        PngBandEncoder encoder;
    };
    tbb::enumerable_thread_specific<Scratch> scratches;
    std::atomic<bool> failed = false;
    std::uint32_t next = bands_written;
    const auto number = [&](tbb::flow_control& control) {
        if (next == end || failed) control.stop();
        return next++;
    };
    const auto encode = [&](std::uint32_t band) {
        Scratch& scratch = scratches.local();
        const std::uint32_t first = band * shape.rows_per_band();
        const std::uint32_t held = first < rows_taken ? rows_taken - first : 0;
        scratch.rows.resize(shape.rows_of_band(band) * shape.bytes_per_row());
        if (held > 0) std::ranges::copy(waiting, scratch.rows.begin());
        source(first + held, shape.rows_of_band(band) - held,
               scratch.rows.data() + held * shape.bytes_per_row());
        return std::make_shared<PngBand>(scratch.encoder.encode(scratch.rows, shape));
    };
    const auto write = [&](const std::shared_ptr<PngBand>& band) {
        append(*band);
        failed = !file.status();
    };
    in_arena(threads, [&] {
        const auto in_flight =
            2 * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
        using tbb::filter_mode;
        tbb::parallel_pipeline(
            in_flight, tbb::make_filter<void, std::uint32_t>(filter_mode::serial_in_order, number) &
                           tbb::make_filter<std::uint32_t, std::shared_ptr<PngBand>>(
                               filter_mode::parallel, encode) &
                           tbb::make_filter<std::shared_ptr<PngBand>, void>(
                               filter_mode::serial_in_order, write));
    });
}

PngWriter::PngWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
PngWriter::PngWriter(PngWriter&&) noexcept = default;
PngWriter& PngWriter::operator=(PngWriter&&) noexcept = default;
PngWriter::~PngWriter() = default;

std::size_t PngWriter::bytes_per_row() const { return state_->shape.bytes_per_row(); }

Result<PngWriter> PngWriter::create(const std::string& path, std::uint32_t width,
                                    std::uint32_t height, PngLayout layout, PngContent content) {
    Result<AtomicFile> file = AtomicFile::create(path, AtomicFile::Access::sequential);
    if (!file) return file.error();
    const Format format = format_of(layout);
    if (width == 0 || height == 0 || width > kLongestSide || height > kLongestSide ||
        std::uint64_t{width} * format.bytes_per_pixel > kLongestRow) {
        return Error{ErrorKind::bad_option,
                     fmt::format("cannot write '{}': a PNG has no room for {} x {} pixels; choose "
                                 "another size or format",
                                 path, width, height)};
    }
    auto state = std::make_unique<State>(std::move(*file));
    state->shape = {width, height, format.bytes_per_pixel};
    state->write_head(format, content);
    if (const Status status = state->file.status(); !status) return status.error();
    return PngWriter(std::move(state));
}

Status PngWriter::write_rows(std::span<const std::uint8_t> rows) {
    const std::size_t row_bytes = bytes_per_row();
    assert(rows.size() % row_bytes == 0);
    const std::uint32_t begin = state_->rows_taken;
    const auto source = [&](std::uint32_t first, std::uint32_t count, std::uint8_t* out) {
        std::copy_n(rows.data() + (first - begin) * row_bytes, count * row_bytes, out);
    };
    return write_rows(source, static_cast<std::uint32_t>(rows.size() / row_bytes), 1);
}

Status PngWriter::write_rows(const PngRowSource& source, std::uint32_t count, int threads) {
    State& s = *state_;
    const std::uint32_t end = s.rows_taken + count, per_band = s.shape.rows_per_band();
    assert(end <= s.shape.height);
    const std::uint32_t complete = end == s.shape.height ? s.shape.bands() : end / per_band;
    if (s.bands_written < complete) {
        s.write_bands(source, complete, threads);
        s.waiting.clear();
    }
    const std::uint32_t rest = std::max(s.rows_taken, std::min(end, complete * per_band));
    if (rest < end) {
        const std::size_t held = s.waiting.size();
        s.waiting.resize(held + (end - rest) * s.shape.bytes_per_row());
        source(rest, end - rest, s.waiting.data() + held);
    }
    s.rows_taken = end;
    return s.file.status();
}

Status PngWriter::finish() {
    State& s = *state_;
    assert(s.bands_written == s.shape.bands());
    std::array<std::uint8_t, kLastBlock.size() + 4> end{};
    std::ranges::copy(kLastBlock, end.begin());
    std::ranges::copy(big_endian(s.adler), end.begin() + kLastBlock.size());
    s.write_chunk("IDAT", end);
    s.write_chunk("IEND", {});
    return s.file.commit();
}

}  // namespace sightline
