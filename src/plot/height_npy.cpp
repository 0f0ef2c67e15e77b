// Heights from NumPy's .npy files: R. Kern, "NEP 1: A simple file format for NumPy arrays", 2007,
// with versions 2 and 3 of the header.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>
#include <type_traits>
#include <utility>

#include "plot/height_table.hpp"
#include "scene/load/text.hpp"

namespace sightline::heights {
namespace {

struct Header {
    std::string_view type;  ///< such as "<f4"
    bool is_structure = false;
    bool column_major = false;
    std::vector<std::uint64_t> shape;
};

/// Reads the dictionary of a header, as Python writes it:
/// {'descr': '<f4', 'fortran_order': False, 'shape': (3, 4), }
class HeaderParser {
public:
    explicit HeaderParser(std::string_view text) : left_(text) {}

    /// Nothing when the text is no such dictionary or lacks one of the three.
    [[nodiscard]] std::optional<Header> parse() {
        bool has_type = false, has_order = false, has_shape = false;
        if (!take("{")) return std::nullopt;
        while (!take("}")) {
            const std::optional<std::string_view> key = take_string();
            if (!key || !take(":")) return std::nullopt;
            if (*key == "descr" && !has_type) {
                header_.is_structure = at("[");
                if (header_.is_structure) return header_;  // what follows is not read
                has_type = take_type();
            } else if (*key == "fortran_order" && !has_order) {
                header_.column_major = take("True");
                has_order = header_.column_major || take("False");
            } else if (*key == "shape" && !has_shape) {
                has_shape = take_shape();
            } else {
                return std::nullopt;
            }
            if (!take(",") && !at("}")) return std::nullopt;
        }
        skip_blanks();
        if (!left_.empty() || !has_type || !has_order || !has_shape) return std::nullopt;
        return header_;
    }

private:
    void skip_blanks() {
        left_.remove_prefix(std::min(left_.find_first_not_of(" \t\n"), left_.size()));
    }
    [[nodiscard]] bool at(std::string_view token) {
        skip_blanks();
        return left_.starts_with(token);
    }
    [[nodiscard]] bool take(std::string_view token) {
        if (!at(token)) return false;
        left_.remove_prefix(token.size());
        return true;
    }
    [[nodiscard]] std::optional<std::string_view> take_string() {
        if (!at("'") && !at("\"")) return std::nullopt;
        const std::size_t end = left_.find(left_.front(), 1);
        if (end == std::string_view::npos) return std::nullopt;
        const std::string_view text = left_.substr(1, end - 1);
        left_.remove_prefix(end + 1);
        return text;
    }
    [[nodiscard]] bool take_type() {
        const std::optional<std::string_view> type = take_string();
        if (type) header_.type = *type;
        return type.has_value();
    }
    [[nodiscard]] bool take_shape() {
        if (!take("(")) return false;
        while (!take(")")) {
            skip_blanks();
            std::uint64_t length = 0;
            const auto [stop, problem] =
                std::from_chars(left_.data(), left_.data() + left_.size(), length);
            if (problem != std::errc()) return false;
            left_.remove_prefix(static_cast<std::size_t>(stop - left_.data()));
            if (left_.starts_with('L')) left_.remove_prefix(1);  // Python 2
            header_.shape.push_back(length);
            if (!take(",") && !at(")")) return false;
        }
        return true;
    }

    std::string_view left_;
    Header header_;
};

Error wrong(const std::string& name, const std::string& what) {
    return {ErrorKind::bad_input, name + ": " + what};
}

Error damaged(const std::string& name, const std::string& what) {
    return wrong(name, fmt::format("not a readable NPY file ({}); check or save it again", what));
}

/// Splits a file into the text of its header and the data.
struct Parts {
    std::string_view header;
    std::span<const std::byte> data;
};

Result<Parts> split(std::span<const std::byte> bytes, const std::string& name) {
    constexpr std::size_t kMagic = 6, kMostHeader = std::size_t{1} << 20;
    const auto byte = [&](std::size_t i) { return std::to_integer<std::size_t>(bytes[i]); };
    if (bytes.size() < kMagic + 4) return damaged(name, "it ends in its header");
    const std::size_t version = byte(kMagic);
    if (version < 1 || version > 3) {
        return damaged(name, fmt::format("version {}; known are 1 to 3", version));
    }
    const std::size_t begin = kMagic + (version == 1 ? 4 : 6);
    if (bytes.size() < begin) return damaged(name, "it ends in its header");
    std::size_t length = byte(kMagic + 2) | byte(kMagic + 3) << 8;
    if (version > 1) length |= byte(kMagic + 4) << 16 | byte(kMagic + 5) << 24;
    if (length > kMostHeader) return damaged(name, "a header of more than 1 MiB");
    if (length > bytes.size() - begin) return damaged(name, "it ends in its header");
    const auto* const text = reinterpret_cast<const char*>(bytes.data() + begin);
    return Parts{{text, length}, bytes.subspan(begin + length)};
}

/// IEEE 754 binary16, 5 bits of exponent and 10 of fraction; every value is a double.
struct Half {
    std::uint16_t bits;

    explicit operator double() const {
        constexpr int kBias = 15, kFraction = 10;
        const int exponent = bits >> kFraction & 31;
        const int fraction = bits & 1023;
        double size = 0;
        if (exponent == 31) {
            size = fraction == 0 ? std::numeric_limits<double>::infinity()
                                 : std::numeric_limits<double>::quiet_NaN();
        } else if (exponent == 0) {
            size = std::ldexp(fraction, 1 - kBias - kFraction);
        } else {
            size = std::ldexp(fraction + 1024, exponent - kBias - kFraction);
        }
        return bits >> 15 != 0 ? -size : size;
    }
};

static_assert(std::endian::native == std::endian::little, "bytes are turned round for '>'");

template <class T>
double number_at(const std::byte* p, bool big_endian) {
    std::array<std::byte, sizeof(T)> bytes;
    std::memcpy(bytes.data(), p, sizeof(T));
    if (big_endian) std::reverse(bytes.begin(), bytes.end());
    return static_cast<double>(std::bit_cast<T>(bytes));
}

template <class T>
void convert(std::span<const std::byte> data, bool big_endian, bool column_major,
             HeightTable& table) {
    const std::size_t next_column = (column_major ? table.rows : 1) * sizeof(T);
    const std::size_t next_row = (column_major ? 1 : table.columns) * sizeof(T);
    for (std::size_t row = 0; row < table.rows; ++row) {
        const std::byte* p = data.data() + row * next_row;
        for (std::size_t column = 0; column < table.columns; ++column, p += next_column) {
            table.values.push_back(number_at<T>(p, big_endian));
        }
    }
}

using Convert = void (*)(std::span<const std::byte>, bool, bool, HeightTable&);

struct NumberType {
    std::string_view name;
    std::size_t size;
    Convert convert;
};

constexpr std::array<NumberType, 11> kTypes = {{{"f4", 4, convert<float>},
                                                {"f8", 8, convert<double>},
                                                {"f2", 2, convert<Half>},
                                                {"i1", 1, convert<std::int8_t>},
                                                {"u1", 1, convert<std::uint8_t>},
                                                {"i2", 2, convert<std::int16_t>},
                                                {"u2", 2, convert<std::uint16_t>},
                                                {"i4", 4, convert<std::int32_t>},
                                                {"u4", 4, convert<std::uint32_t>},
                                                {"i8", 8, convert<std::int64_t>},
                                                {"u8", 8, convert<std::uint64_t>}}};

const NumberType* find_type(std::string_view name) {
    if (name.empty() || std::string_view("<>=|").find(name.front()) == std::string_view::npos) {
        return nullptr;
    }
    for (const NumberType& type : kTypes) {
        // '|' says that the order of bytes does not matter.
        if (type.name == name.substr(1) && (name.front() != '|' || type.size == 1)) return &type;
    }
    return nullptr;
}

Error wrong_type(const std::string& name, const Header& header) {
    const std::string what = header.is_structure
                                 ? "structures"
                                 : fmt::format("of type '{}'", load::one_line(header.type));
    return wrong(name, fmt::format("its values are {}; save them as floats or integers of at most "
                                   "64 bits",
                                   what));
}

}  // namespace

Result<HeightTable> read_npy_heights(std::span<const std::byte> bytes, const std::string& name) {
    const Result<Parts> parts = split(bytes, name);
    if (!parts) return parts.error();
    const std::optional<Header> header = HeaderParser(parts->header).parse();
    if (!header) return damaged(name, "its header makes no sense");
    const NumberType* const type = find_type(header->type);
    if (type == nullptr) return wrong_type(name, *header);
    if (header->shape.size() != 2) {
        return wrong(name, fmt::format("an array of {} dimensions; save one of two, rows and "
                                       "columns",
                                       header->shape.size()));
    }
    const std::uint64_t rows = header->shape[0], columns = header->shape[1];
    if (std::optional<Error> error = too_many_nodes(name, columns, rows)) return std::move(*error);
    const std::size_t stated = columns * rows * type->size;
    if (parts->data.size() != stated) {
        return damaged(name, fmt::format("{} bytes of data, but {} x {} values take {}",
                                         parts->data.size(), rows, columns, stated));
    }
    HeightTable table;
    table.columns = columns;
    table.rows = rows;
    table.single_precision = type->name == "f4";
    table.values.reserve(columns * rows);
    type->convert(parts->data, header->type.front() == '>', header->column_major, table);
    return table;
}

}  // namespace sightline::heights
