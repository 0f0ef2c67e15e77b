// The entry: which file, which reader; then heights and places from what the file holds.
#include "sightline/height_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <new>
#include <string_view>
#include <utility>

#include "math/thread_failure.hpp"
#include "plot/height_table.hpp"
#include "scene/load/input.hpp"
#include "scene/load/text.hpp"

namespace sightline {
namespace heights {

std::optional<Error> too_many_nodes(const std::string& name, std::uint64_t columns,
                                    std::uint64_t rows) {
    if (columns == 0 || rows <= kMostNodes / columns) return std::nullopt;
    return Error{ErrorKind::bad_input,
                 fmt::format("{}: {} x {} heights; at most {} can be taken; cut a part out or "
                             "reduce it",
                             name, columns, rows, kMostNodes)};
}

namespace {

constexpr std::size_t kMostBytes = std::size_t{4} << 30;
constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n", kNpyMagic = "\x93NUMPY";

Error bad_input(std::string message) { return {ErrorKind::bad_input, std::move(message)}; }

enum class Format { png, npy, csv, gdal };

/// By the first bytes, then by the name.
Result<Format> format_of(std::span<const std::byte> beginning, const std::string& path) {
    const std::string_view text = load::text_of(beginning);
    if (text.starts_with(kPngSignature)) return Format::png;
    if (text.starts_with(kNpyMagic)) return Format::npy;
    const std::string extension = load::extension_of(path);
    if (extension == "png" || extension == "npy") {
        return bad_input(
            fmt::format("{}: it does not begin like {} file; check it or export it "
                        "again",
                        path, extension == "png" ? "a PNG" : "an NPY"));
    }
    for (const char* const table : {"csv", "tsv", "txt", "dat"}) {
        if (extension == table) return Format::csv;
    }
    return Format::gdal;
}

Result<HeightTable> read_bytes(Format format, std::span<const std::byte> bytes,
                               const std::string& path) {
    switch (format) {
        case Format::png:
            return read_png_heights(bytes, path);
        case Format::npy:
            return read_npy_heights(bytes, path);
        case Format::csv:
            return read_csv_heights(bytes, path);
        case Format::gdal:
            break;
    }
    return bad_input(
        fmt::format("{}: GDAL does not read from a pipe; give it the name of a file", path));
}

/// Errors of what can be told without reading.
std::optional<Error> unusable(const std::string& path) {
    if (path == "-") {
        return Error{ErrorKind::bad_option,
                     "standard input: height maps are not read from there; give the name of a "
                     "file"};
    }
    std::error_code ignored;  // what can't be looked at can't be opened, which tells why
    const std::filesystem::file_status status = std::filesystem::status(path, ignored);
    if (std::filesystem::is_directory(status)) {
        return bad_input(fmt::format("{}: it is a folder; name a height map in it", path));
    }
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
        !std::filesystem::is_fifo(status)) {
        return bad_input(fmt::format("{}: it is a device; name a file", path));
    }
    return std::nullopt;
}

Result<HeightTable> read_table(const std::string& path) {
    if (std::optional<Error> error = unusable(path)) return std::move(*error);
    constexpr std::size_t kEnoughToTell = 16;
    Result<load::InputFile> file =
        load::InputFile::open(path, std::numeric_limits<std::size_t>::max());
    if (!file) return file.error();
    // A pipe can be read only once. Large rasters are left to GDAL, which need not hold them.
    const bool regular = file->is_regular();
    Result<std::vector<std::byte>> bytes =
        file->read_beginning(regular ? kEnoughToTell : kMostBytes);
    if (!bytes) return bytes.error();
    if (bytes->empty()) return bad_input(fmt::format("{}: it is empty; give it heights", path));
    const Result<Format> format = format_of(*bytes, path);
    if (!format) return format.error();
    if (regular) {
        if (*format == Format::gdal) return read_gdal_heights(path);
        std::error_code ignored;
        if (std::filesystem::file_size(path, ignored) > kMostBytes) {
            return bad_input(fmt::format("{}: more than {} MiB; cut a part out or reduce it", path,
                                         kMostBytes >> 20));
        }
        Result<load::InputFile> again = load::InputFile::open(path, kMostBytes);
        if (!again) return again.error();
        bytes = again->read_all();
        if (!bytes) return bytes.error();
    }
    return read_bytes(*format, *bytes, path);
}

/// What a file of 32-bit floats holds where this number is meant.
double as_stored(double value, bool single_precision) {
    if (!single_precision) return value;
    constexpr double kLargest = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(value, -kLargest, kLargest));
}

/// Turns values into heights: the map's y. False when there is none.
bool make_heights(HeightTable& table, const HeightMapOptions& options) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const double no_data =
        options.no_data ? as_stored(*options.no_data, table.single_precision) : kNone;
    bool any = false;
    for (double& value : table.values) {
        if (value == no_data || !std::isfinite(value)) {
            value = kNone;
            continue;
        }
        value = (value * table.scale + table.offset) * options.height_scale;
        if (std::isfinite(value)) {
            any = true;
        } else {
            value = kNone;
        }
    }
    return any;
}

/// `count` places from `first` on, or none when they are not apart in double precision.
std::vector<double> places(double first, double distance, std::size_t count) {
    std::vector<double> out(count);
    for (std::size_t i = 0; i < count; ++i) {
        out[i] = first + static_cast<double>(i) * distance;
        if (!std::isfinite(out[i]) || (i > 0 && !(out[i] > out[i - 1]))) return {};
    }
    return out;
}

void reverse_rows(HeightTable& table) {
    const auto begin = table.values.begin();
    const auto columns = static_cast<std::ptrdiff_t>(table.columns);
    auto upper = begin, lower = table.values.end() - columns;
    for (; upper < lower; upper += columns, lower -= columns) {
        std::swap_ranges(upper, upper + columns, lower);
    }
}

/// Places the nodes; the rows of files that begin in the south are reversed.
Result<HeightMap> place(HeightTable table, const HeightMapOptions& options,
                        const std::string& path) {
    HeightMap map;
    glm::dvec2 first{0, 0}, distance{1, 1};
    // Some drivers give this one when the file tells nothing.
    constexpr std::array<double, 6> kUnplaced = {0, 1, 0, 0, 0, 1};
    if (table.geotransform && *table.geotransform != kUnplaced) {
        const auto [west, east, skew, north, turn, up] = *table.geotransform;
        const bool straight = skew == 0 && turn == 0 && east > 0 && up != 0 && std::isfinite(up);
        if (straight && up > 0) reverse_rows(table);
        if (!straight && !options.cell) {
            return bad_input(
                fmt::format("{}: its rows do not run from west to east; rectify it (gdalwarp) or "
                            "give the size of its cells, such as --cell 30",
                            path));
        }
        const double top = up < 0 ? north : north + up * static_cast<double>(table.rows);
        first = {west + east / 2, std::fabs(up) / 2 - top};
        distance = {east, std::fabs(up)};
        map.placed = true;
    }
    if (options.cell) {
        first = {0, 0};
        distance = *options.cell;
        map.placed = false;
    }
    map.x = places(first.x, distance.x, table.columns);
    map.z = places(first.y, distance.y, table.rows);
    if (map.x.empty() || map.z.empty()) {
        return bad_input(
            fmt::format("{}: cells of {:g} x {:g} from ({:g}, {:g}) on are not apart "
                        "in double precision; give another size, such as --cell 30",
                        path, distance.x, distance.y, first.x, -first.y));
    }
    map.y = std::move(table.values);
    return map;
}

Status check(const HeightMapOptions& options) {
    const auto is_distance = [](double d) { return d > 0 && std::isfinite(d); };
    if (options.cell && !(is_distance(options.cell->x) && is_distance(options.cell->y))) {
        return Error{ErrorKind::bad_option,
                     fmt::format("cells of {:g} x {:g}: their sizes must be positive and finite, "
                                 "such as 30",
                                 options.cell->x, options.cell->y)};
    }
    if (!std::isfinite(options.height_scale)) {
        return Error{ErrorKind::bad_option, fmt::format("heights times {:g}: the factor must be "
                                                        "finite, such as 2",
                                                        options.height_scale)};
    }
    return success();
}

Result<HeightMap> make_map(const std::string& path, const HeightMapOptions& options) {
    if (Status checked = check(options); !checked) return checked.error();
    Result<HeightTable> table = read_table(path);
    if (!table) return table.error();
    for (const auto& [count, what] :
         {std::pair(table->rows, "row"), std::pair(table->columns, "column")}) {
        if (count >= 2) continue;
        return bad_input(
            fmt::format("{}: has {} {}: a height map needs two or more; give a larger "
                        "one",
                        path, count == 0 ? "no" : "one", what));
    }
    if (!make_heights(*table, options)) {
        return bad_input(
            fmt::format("{}: no height in it: there is no data anywhere; check which "
                        "value means that",
                        path));
    }
    return place(std::move(*table), options, path);
}

}  // namespace
}  // namespace heights

Result<HeightMap> load_height_map(const std::string& path, const HeightMapOptions& options) {
    try {
        return heights::make_map(path, options);
    } catch (const std::bad_alloc&) {
        return Error{ErrorKind::io,
                     fmt::format("{}: not enough memory; free some or use a smaller map", path)};
    } catch (const std::exception& exception) {
        if (const auto text = thread_failure(exception)) return Error{ErrorKind::io, *text};
        return Error{ErrorKind::io, fmt::format("{}: {}; try again or report it", path,
                                                load::one_line(exception.what()))};
    }
}

}  // namespace sightline
