// Heights from grey PNG files, through libpng.
//
// libpng reports errors by longjmp(), which must not skip a destructor: it is only called from
// steps that own nothing, under attempt().
#include <fmt/format.h>
#include <png.h>

#include <array>
#include <csetjmp>
#include <cstring>
#include <limits>
#include <new>
#include <utility>

#include "plot/height_table.hpp"
#include "scene/load/text.hpp"

namespace sightline::heights {
namespace {

// No byte of a deflate stream (RFC 1951) makes more than 258 bytes of every two bits.
constexpr std::uint64_t kBestCompression = 1032;

struct Input {
    std::span<const std::byte> left;
    std::array<char, 120> message{};  ///< of the error that ended a step
};

extern "C" void take_bytes(png_structp png, png_bytep out, std::size_t size) {
    auto* const input = static_cast<Input*>(png_get_io_ptr(png));
    if (size > input->left.size()) png_error(png, "it ends too early");
    std::memcpy(out, input->left.data(), size);
    input->left = input->left.subspan(size);
}

extern "C" [[noreturn]] void note_error(png_structp png, png_const_charp message) {
    auto* const input = static_cast<Input*>(png_get_error_ptr(png));
    std::strncpy(input->message.data(), message, input->message.size() - 1);
    png_longjmp(png, 1);
}

extern "C" void ignore_warning(png_structp /*png*/, png_const_charp /*message*/) {}

struct Header {
    std::uint32_t width = 0, height = 0;
    int bit_depth = 0, color_type = 0;
};

/// libpng's structures, freed at the end.
class Decoder {
public:
    explicit Decoder(std::span<const std::byte> bytes) : input_{bytes} {
        png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &input_, note_error, ignore_warning);
        if (png_ != nullptr) info_ = png_create_info_struct(png_);
    }
    Decoder(const Decoder&) = delete;
    Decoder& operator=(const Decoder&) = delete;
    ~Decoder() { png_destroy_read_struct(&png_, &info_, nullptr); }

    [[nodiscard]] bool created() const { return info_ != nullptr; }
    [[nodiscard]] const char* message() const { return input_.message.data(); }

    [[nodiscard]] bool read_header(Header& header) {
        return attempt([&] {
            constexpr png_uint_32 kLargest = 0x7fffffff;  // too many nodes are ours to refuse
            png_set_user_limits(png_, kLargest, kLargest);
            png_set_read_fn(png_, &input_, take_bytes);
            png_read_info(png_, info_);
            png_get_IHDR(png_, info_, &header.width, &header.height, &header.bit_depth,
                         &header.color_type, nullptr, nullptr, nullptr);
        });
    }

    /// Makes rows come in 8 or 16 bits a channel, with an alpha channel if anything is transparent.
    [[nodiscard]] bool prepare(int& passes, std::size_t& row_bytes) {
        return attempt([&] {
            png_set_expand_gray_1_2_4_to_8(png_);
            if (png_get_valid(png_, info_, PNG_INFO_tRNS) != 0) png_set_tRNS_to_alpha(png_);
            passes = png_set_interlace_handling(png_);
            png_read_update_info(png_, info_);
            row_bytes = png_get_rowbytes(png_, info_);
        });
    }

    [[nodiscard]] bool read_row(std::uint8_t* row) {
        return attempt([&] { png_read_row(png_, row, nullptr); });
    }
    [[nodiscard]] bool read_end() {
        return attempt([&] { png_read_end(png_, nullptr); });
    }

private:
    template <class Step>
    [[nodiscard]] bool attempt(const Step& step) {
        if (setjmp(png_jmpbuf(png_)) != 0) return false;
        step();
        return true;
    }

    Input input_;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
};

Error damaged(const std::string& name, std::string_view cause) {
    return {ErrorKind::bad_input,
            fmt::format("{}: not a readable PNG file ({}); check or export it again", name,
                        load::one_line(cause))};
}

std::optional<Error> refused(const Header& header, std::size_t file_bytes,
                             const std::string& name) {
    if ((header.color_type & (PNG_COLOR_MASK_COLOR | PNG_COLOR_MASK_PALETTE)) != 0) {
        return Error{ErrorKind::bad_input,
                     fmt::format("{}: its pixels are colours, which tell no heights; convert it to "
                                 "16-bit grey",
                                 name)};
    }
    if (std::optional<Error> error = too_many_nodes(name, header.width, header.height)) {
        return error;
    }
    const std::uint64_t channels = (header.color_type & PNG_COLOR_MASK_ALPHA) != 0 ? 2 : 1;
    const std::uint64_t bits =
        header.width * channels * static_cast<std::uint64_t>(header.bit_depth);
    if (bits * header.height / 8 > kBestCompression * file_bytes) {
        return damaged(name, fmt::format("{} bytes can't hold {} x {} pixels", file_bytes,
                                         header.width, header.height));
    }
    return std::nullopt;
}

/// Appends the heights of a row of `Bytes` bytes a channel, the most significant one first.
template <std::size_t Bytes>
void append_row(const std::uint8_t* row, std::size_t columns, bool has_alpha,
                std::vector<double>& values) {
    const auto number = [](const std::uint8_t* p) {
        return Bytes == 1 ? unsigned{*p} : static_cast<unsigned>(p[0] << 8 | p[Bytes - 1]);
    };
    const std::size_t step = has_alpha ? 2 * Bytes : Bytes;
    for (std::size_t i = 0; i < columns; ++i, row += step) {
        const bool is_height = !has_alpha || number(row + Bytes) != 0;
        values.push_back(is_height ? number(row) : std::numeric_limits<double>::quiet_NaN());
    }
}

/// False when the decoder has an error to tell.
bool read_rows(Decoder& decoder, const Header& header, HeightTable& table) {
    int passes = 0;
    std::size_t row_bytes = 0;
    if (!decoder.prepare(passes, row_bytes)) return false;
    // The passes of an interlaced picture fill the same rows, so all of them are held.
    std::vector<std::uint8_t> held(row_bytes * (passes > 1 ? header.height : 1));
    for (int pass = 1; pass < passes; ++pass) {
        for (std::size_t y = 0; y < header.height; ++y) {
            if (!decoder.read_row(&held[y * row_bytes])) return false;
        }
    }
    const bool wide = header.bit_depth == 16;
    const bool has_alpha = row_bytes > header.width * (wide ? 2ull : 1ull);
    for (std::size_t y = 0; y < header.height; ++y) {
        std::uint8_t* const row = &held[passes > 1 ? y * row_bytes : 0];
        if (!decoder.read_row(row)) return false;
        if (wide) {
            append_row<2>(row, header.width, has_alpha, table.values);
        } else {
            append_row<1>(row, header.width, has_alpha, table.values);
        }
    }
    return decoder.read_end();
}

}  // namespace

Result<HeightTable> read_png_heights(std::span<const std::byte> bytes, const std::string& name) {
    Decoder decoder(bytes);
    if (!decoder.created()) throw std::bad_alloc();
    Header header;
    if (!decoder.read_header(header)) return damaged(name, decoder.message());
    if (std::optional<Error> error = refused(header, bytes.size(), name)) return std::move(*error);
    HeightTable table;
    table.columns = header.width;
    table.rows = header.height;
    table.values.reserve(table.columns * table.rows);
    if (!read_rows(decoder, header, table)) return damaged(name, decoder.message());
    return table;
}

}  // namespace sightline::heights
