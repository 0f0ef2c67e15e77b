// PNG files row by row, through libpng.
//
// libpng reports an error by a long jump, which runs no destructors: it is called only inside
// guarded(), with nothing on the stack that has one.
#include "image/png_writer.hpp"

#include <fmt/core.h>
#include <png.h>

#include <cassert>
#include <csetjmp>
#include <utility>

#include "image/atomic_file.hpp"

namespace sightline {
namespace {

struct Format {
    int color_type, bit_depth;
    std::size_t bytes_per_pixel;
};

Format format_of(PngLayout layout) {
    switch (layout) {
        case PngLayout::grey8:
            return {PNG_COLOR_TYPE_GRAY, 8, 1};
        case PngLayout::grey16:
            return {PNG_COLOR_TYPE_GRAY, 16, 2};
        case PngLayout::rgb8:
            return {PNG_COLOR_TYPE_RGB, 8, 3};
        case PngLayout::rgba8:
            return {PNG_COLOR_TYPE_RGBA, 8, 4};
    }
    return {};
}

/// Runs a function that calls libpng; false when libpng jumped out of it.
template <class Function>
bool guarded(png_structp png, const Function& function) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    function();
    return true;
}

}  // namespace

struct PngWriter::State {
    explicit State(AtomicFile target) : file(std::move(target)) {}
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() { png_destroy_write_struct(&png, &info); }

    static void on_error(png_structp png, png_const_charp text) {
        static_cast<State*>(png_get_error_ptr(png))->message = text;
        png_longjmp(png, 1);
    }
    static void on_warning(png_structp, png_const_charp) {}
    static void on_write(png_structp png, png_bytep data, std::size_t size) {
        const bool written = static_cast<State*>(png_get_io_ptr(png))->file.write(data, size).ok();
        if (!written) png_error(png, "write failed");
    }
    static void on_flush(png_structp) {}

    /// The file's error when it has one, else libpng's.
    [[nodiscard]] Error error() const {
        if (const Status status = file.status(); !status) return status.error();
        return {ErrorKind::bad_option,
                fmt::format("cannot write '{}': libpng says '{}'; choose another size or format",
                            file.path(), message)};
    }

    AtomicFile file;
    png_structp png = nullptr;
    png_infop info = nullptr;
    const char* message = "out of memory";
    std::size_t bytes_per_row = 0;
};

PngWriter::PngWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
PngWriter::PngWriter(PngWriter&&) noexcept = default;
PngWriter& PngWriter::operator=(PngWriter&&) noexcept = default;
PngWriter::~PngWriter() = default;

std::size_t PngWriter::bytes_per_row() const { return state_->bytes_per_row; }

Result<PngWriter> PngWriter::create(const std::string& path, std::uint32_t width,
                                    std::uint32_t height, PngLayout layout, PngContent content) {
    Result<AtomicFile> file = AtomicFile::create(path, AtomicFile::Access::sequential);
    if (!file) return file.error();
    auto state = std::make_unique<State>(std::move(*file));
    State& s = *state;
    s.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &s, State::on_error, State::on_warning);
    if (s.png == nullptr) return s.error();
    const Format format = format_of(layout);
    const bool ok = guarded(s.png, [&] {
        s.info = png_create_info_struct(s.png);
        png_set_write_fn(s.png, &s, State::on_write, State::on_flush);
        png_set_IHDR(s.png, s.info, width, height, format.bit_depth, format.color_type,
                     PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
        if (content == PngContent::color) png_set_sRGB(s.png, s.info, PNG_sRGB_INTENT_PERCEPTUAL);
        // Rendered pictures change little from row to row: of all filters at levels 1 to 3, this
        // pair gave the shortest time and very nearly the smallest files.
        png_set_compression_level(s.png, 1);
        png_set_filter(s.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
        png_set_compression_buffer_size(s.png, std::size_t{1} << 16);
        png_write_info(s.png, s.info);
    });
    if (!ok) return s.error();
    s.bytes_per_row = std::size_t{width} * format.bytes_per_pixel;
    return PngWriter(std::move(state));
}

Status PngWriter::write_rows(std::span<const std::uint8_t> rows) {
    State& s = *state_;
    assert(rows.size() % s.bytes_per_row == 0);
    const bool ok = guarded(s.png, [&] {
        for (std::size_t at = 0; at < rows.size(); at += s.bytes_per_row) {
            png_write_row(s.png, rows.data() + at);
        }
    });
    if (!ok) return s.error();
    return success();
}

Status PngWriter::finish() {
    State& s = *state_;
    if (!guarded(s.png, [&] { png_write_end(s.png, s.info); })) return s.error();
    return s.file.commit();
}

}  // namespace sightline
