// Heights from the first band of whatever raster GDAL reads.
//
// GDAL is not linked: its library brings some hundred others, which would be loaded whenever the
// program starts. It is loaded by name where a file needs it, in a child process: it parses
// untrusted input by a hundred drivers, some of which would go to the network or crash.
#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <string_view>
#include <type_traits>
#include <utility>

#include "plot/height_table.hpp"
#include "scene/load/contained.hpp"
#include "scene/load/text.hpp"

namespace sightline::heights {
namespace {

using Handle = void*;  // GDALDatasetH, GDALRasterBandH

// From gdal.h; they are part of its binary interface.
constexpr unsigned kRaster = 0x02, kVerboseError = 0x40;                // GDAL_OF_*
constexpr int kByte = 1, kFloat32 = 6, kFloat64 = 7;                    // GDALDataType
constexpr int kRead = 0, kNoError = 0, kUndefinedColor = 0, kGrey = 1;  // GF_*, CE_*, GCI_*
constexpr int kAllValid = 0x01;                                         // GMF_*

/// The functions of GDAL's C interface that are needed, named as there.
struct Gdal {
    using List = const char* const*;

    void (*register_all)() = nullptr;
    int (*driver_count)() = nullptr;
    Handle (*driver)(int) = nullptr;
    const char* (*short_name)(Handle) = nullptr;
    void (*deregister)(Handle) = nullptr;
    void (*set_option)(const char*, const char*) = nullptr;
    void (*reset_error)() = nullptr;
    const char* (*last_error)() = nullptr;
    Handle (*open)(const char*, unsigned, List, List, List) = nullptr;
    void (*close)(Handle) = nullptr;
    int (*raster_count)(Handle) = nullptr;
    int (*x_size)(Handle) = nullptr;
    int (*y_size)(Handle) = nullptr;
    int (*geotransform)(Handle, double*) = nullptr;
    Handle (*band)(Handle, int) = nullptr;
    int (*type)(Handle) = nullptr;
    int (*color)(Handle) = nullptr;
    double (*scale)(Handle, int*) = nullptr;
    double (*offset)(Handle, int*) = nullptr;
    int (*mask_flags)(Handle) = nullptr;
    Handle (*mask)(Handle) = nullptr;
    int (*transfer)(Handle, int, int, int, int, int, void*, int, int, int, int, int) = nullptr;
};

template <class Function>
bool find(Handle library, const char* name, Function& function) {
    void* const symbol = dlsym(library, name);
    static_assert(sizeof function == sizeof symbol);
    std::memcpy(&function, &symbol, sizeof symbol);
    return symbol != nullptr;
}

bool find_all(Handle library, Gdal& gdal) {
    return find(library, "GDALAllRegister", gdal.register_all) &&
           find(library, "GDALGetDriverCount", gdal.driver_count) &&
           find(library, "GDALGetDriver", gdal.driver) &&
           find(library, "GDALGetDriverShortName", gdal.short_name) &&
           find(library, "GDALDeregisterDriver", gdal.deregister) &&
           find(library, "CPLSetConfigOption", gdal.set_option) &&
           find(library, "CPLErrorReset", gdal.reset_error) &&
           find(library, "CPLGetLastErrorMsg", gdal.last_error) &&
           find(library, "GDALOpenEx", gdal.open) && find(library, "GDALClose", gdal.close) &&
           find(library, "GDALGetRasterCount", gdal.raster_count) &&
           find(library, "GDALGetRasterXSize", gdal.x_size) &&
           find(library, "GDALGetRasterYSize", gdal.y_size) &&
           find(library, "GDALGetGeoTransform", gdal.geotransform) &&
           find(library, "GDALGetRasterBand", gdal.band) &&
           find(library, "GDALGetRasterDataType", gdal.type) &&
           find(library, "GDALGetRasterColorInterpretation", gdal.color) &&
           find(library, "GDALGetRasterScale", gdal.scale) &&
           find(library, "GDALGetRasterOffset", gdal.offset) &&
           find(library, "GDALGetMaskFlags", gdal.mask_flags) &&
           find(library, "GDALGetMaskBand", gdal.mask) &&
           find(library, "GDALRasterIO", gdal.transfer);
}

/// Formats of heights that keep to their own file and those of the same name beside it. Others name
/// further files, databases or addresses (VRT, PostGISRaster, WMS), or run code (VRT, with Python).
constexpr std::array<std::string_view, 31> kDrivers = {
    "AAIGrid", "ACE2",        "BT",      "DTED",     "EHdr",    "ENVI",     "GRIB",  "GS7BG",
    "GSAG",    "GSBG",        "GTiff",   "GTX",      "GXF",     "HF2",      "HFA",   "ISG",
    "JPEG",    "JP2OpenJPEG", "LCP",     "Leveller", "NWT_GRD", "PCRaster", "PNM",   "RST",
    "SAGA",    "SIGDEM",      "SRTMHGT", "Terragen", "USGSDEM", "XYZ",      "netCDF"};

/// Leaves only these, so that no file and no file beside it is opened by another.
void keep_drivers(const Gdal& gdal) {
    for (int i = gdal.driver_count(); i-- > 0;) {
        const Handle driver = gdal.driver(i);
        if (std::ranges::find(kDrivers, gdal.short_name(driver)) == kDrivers.end()) {
            gdal.deregister(driver);
        }
    }
}

/// Nothing when no library has any of these names.
std::optional<Gdal> load_gdal(const std::vector<std::string>& libraries) {
    Gdal gdal;
    bool found = false;
    for (const std::string& name : libraries) {
        Handle library = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
        found = library != nullptr && find_all(library, gdal);
        if (found) break;
    }
    if (!found) return std::nullopt;
    // Nothing is fetched from an address, which a file could name as one beside it.
    gdal.set_option("CPL_VSIL_CURL_ALLOWED_FILENAME", "none");
    gdal.set_option("CPL_VSIL_CURL_ALLOWED_EXTENSIONS", ".none");
    // No code is loaded or run but GDAL's own.
    gdal.set_option("GDAL_VRT_ENABLE_PYTHON", "NO");
    gdal.set_option("GDAL_PYTHON_DRIVER_PATH", "");
    gdal.set_option("GDAL_DRIVER_PATH", "disable");
    gdal.register_all();
    keep_drivers(gdal);
    return gdal;
}

// --- In the child. What it sends ends with one of these bytes; before it stands a table (its
// values, then a Description) or the message of an error.
constexpr std::byte kTable{0}, kBadInput{1}, kSystemRefused{2};

struct Description {
    std::uint64_t columns = 0, rows = 0;
    std::array<double, 6> geotransform{};
    double scale = 1, offset = 0;
    std::uint32_t has_geotransform = 0, single_precision = 0;
};
static_assert(std::is_trivially_copyable_v<Description>);

std::vector<std::byte> message_of(const Error& error) {
    const auto text = std::as_bytes(std::span(error.message));
    std::vector<std::byte> bytes(text.begin(), text.end());
    bytes.push_back(error.kind == ErrorKind::io ? kSystemRefused : kBadInput);
    return bytes;
}

Error no_gdal(const std::string& path) {
    return {ErrorKind::io,
            fmt::format("{}: not a PNG, NPY or CSV file, and GDAL, which may know it, is not "
                        "installed; install it (Debian: apt install libgdal32) or convert the file "
                        "to one of these",
                        path)};
}

Error no_raster(const std::string& path, std::string_view cause) {
    const bool unknown = cause.empty() || cause.find("not recognized as") != std::string_view::npos;
    return {ErrorKind::bad_input,
            fmt::format("{}: not a height map ({}); give a grey PNG, a table as CSV or NPY, or a "
                        "raster that GDAL reads",
                        path, unknown ? "GDAL does not know its format" : load::one_line(cause))};
}

/// A raster that is open; what reads it returns nothing when it went well.
class Raster {
public:
    Raster(const Gdal& gdal, const std::string& path) : gdal_(gdal), path_(path) {}
    Raster(const Raster&) = delete;
    Raster& operator=(const Raster&) = delete;
    ~Raster() {
        if (dataset_ != nullptr) gdal_.close(dataset_);
    }

    [[nodiscard]] std::optional<Error> open() {
        gdal_.reset_error();
        // Its driver must not take the name for an address or a connection.
        const std::string name = path_.starts_with('/') ? path_ : "./" + path_;
        dataset_ = gdal_.open(name.c_str(), kRaster | kVerboseError, nullptr, nullptr, nullptr);
        if (dataset_ == nullptr) return no_raster(path_, gdal_.last_error());
        if (gdal_.raster_count(dataset_) < 1) return no_raster(path_, "it has no band of values");
        band_ = gdal_.band(dataset_, 1);
        if (band_ == nullptr) return no_raster(path_, gdal_.last_error());
        const int color = gdal_.color(band_);
        if (color != kUndefinedColor && color != kGrey) {
            return no_raster(path_, "its first band holds colours");
        }
        width_ = gdal_.x_size(dataset_);
        height_ = gdal_.y_size(dataset_);
        if (width_ < 1 || height_ < 1) return no_raster(path_, "it has no size");
        return too_many_nodes(path_, static_cast<std::uint64_t>(width_),
                              static_cast<std::uint64_t>(height_));
    }

    [[nodiscard]] Description describe() const {
        Description out;
        out.columns = static_cast<std::uint64_t>(width_);
        out.rows = static_cast<std::uint64_t>(height_);
        out.has_geotransform =
            gdal_.geotransform(dataset_, out.geotransform.data()) == kNoError ? 1 : 0;
        out.scale = gdal_.scale(band_, nullptr);
        out.offset = gdal_.offset(band_, nullptr);
        out.single_precision = gdal_.type(band_) == kFloat32 ? 1 : 0;
        return out;
    }

    /// Fills in the values of all nodes, NaN where the file has no data.
    [[nodiscard]] std::optional<Error> read(double* values) const {
        if (!transfer(band_, 0, height_, values, kFloat64)) return unreadable();
        if ((gdal_.mask_flags(band_) & kAllValid) != 0) return std::nullopt;
        const Handle mask = gdal_.mask(band_);
        std::vector<unsigned char> valid(static_cast<std::size_t>(width_));
        for (int row = 0; row < height_; ++row) {
            if (!transfer(mask, row, 1, valid.data(), kByte)) return unreadable();
            for (const unsigned char is_valid : valid) {
                if (is_valid == 0) *values = std::numeric_limits<double>::quiet_NaN();
                ++values;
            }
        }
        return std::nullopt;
    }

private:
    [[nodiscard]] bool transfer(Handle band, int row, int rows, void* out, int type) const {
        return gdal_.transfer(band, kRead, 0, row, width_, rows, out, width_, rows, type, 0, 0) ==
               kNoError;
    }
    [[nodiscard]] Error unreadable() const {
        return {ErrorKind::bad_input, fmt::format("{}: not readable to its end ({}); check or "
                                                  "export it again",
                                                  path_, load::one_line(gdal_.last_error()))};
    }

    const Gdal& gdal_;
    const std::string& path_;
    Handle dataset_ = nullptr, band_ = nullptr;
    int width_ = 0, height_ = 0;
};

std::vector<std::byte> read_in_child(const std::string& path,
                                     const std::vector<std::string>& libraries) {
    const std::optional<Gdal> gdal = load_gdal(libraries);
    if (!gdal) return message_of(no_gdal(path));
    Raster raster(*gdal, path);
    if (const std::optional<Error> error = raster.open()) return message_of(*error);
    const Description description = raster.describe();
    const std::size_t values = description.columns * description.rows * sizeof(double);
    std::vector<std::byte> bytes(values + sizeof description + 1);
    if (const std::optional<Error> error = raster.read(reinterpret_cast<double*>(bytes.data()))) {
        return message_of(*error);
    }
    std::memcpy(bytes.data() + values, &description, sizeof description);
    bytes.back() = kTable;
    return bytes;
}

// --- In the parent.

Error damaged(const std::string& path, std::string_view cause) {
    return {ErrorKind::bad_input,
            fmt::format("{}; convert it to 16-bit grey PNG, CSV or NPY",
                        cause.empty() ? path + ": GDAL read nonsense" : std::string(cause))};
}

/// Nothing when a child that a file has taken over made it up.
std::optional<HeightTable> table_of(std::span<const std::byte> bytes) {
    Description description;
    if (bytes.size() < sizeof description) return std::nullopt;
    const std::span<const std::byte> values = bytes.first(bytes.size() - sizeof description);
    std::memcpy(&description, bytes.data() + values.size(), sizeof description);
    const std::uint64_t columns = description.columns, rows = description.rows;
    if (columns < 1 || rows < 1 || columns > kMostNodes / rows ||
        values.size() != columns * rows * sizeof(double)) {
        return std::nullopt;
    }
    HeightTable table;
    table.columns = columns;
    table.rows = rows;
    table.values.resize(columns * rows);
    std::memcpy(table.values.data(), values.data(), values.size());
    table.single_precision = description.single_precision != 0;
    table.scale = description.scale;
    table.offset = description.offset;
    if (description.has_geotransform != 0) table.geotransform = description.geotransform;
    return table;
}

}  // namespace

std::vector<std::string> gdal_libraries() {
    // The version of its binary interface; the functions used here are the same in all of these.
    // First the one of Debian 12 and its successors.
    constexpr int kPreferred = 32, kNewest = 40, kOldest = 28;
    std::vector<std::string> names = {"libgdal.so"};
    for (int version = kPreferred; version <= kNewest; ++version) {
        names.push_back(fmt::format("libgdal.so.{}", version));
    }
    for (int version = kPreferred - 1; version >= kOldest; --version) {
        names.push_back(fmt::format("libgdal.so.{}", version));
    }
    return names;
}

Result<HeightTable> read_gdal_heights(const std::string& path,
                                      const std::vector<std::string>& libraries) {
    const Result<load::MappedBytes> mapped =
        load::run_contained([&] { return read_in_child(path, libraries); }, {}, path);
    if (!mapped) {
        const Error& error = mapped.error();
        if (error.kind != ErrorKind::bad_input) return error;
        // It crashed or went beyond a limit; the way out is another one here than for a model.
        return damaged(path, std::string_view(error.message).substr(0, error.message.rfind(';')));
    }
    std::span<const std::byte> bytes = mapped->bytes();
    if (bytes.empty()) return damaged(path, {});
    const std::byte kind = bytes.back();
    bytes = bytes.first(bytes.size() - 1);
    if (kind != kTable) {
        return Error{kind == kSystemRefused ? ErrorKind::io : ErrorKind::bad_input,
                     std::string(load::text_of(bytes))};
    }
    std::optional<HeightTable> table = table_of(bytes);
    if (!table) return damaged(path, {});
    return std::move(*table);
}

}  // namespace sightline::heights
