// The readers of height maps that are our own, chosen by the first bytes as for a file.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "plot/height_table.hpp"
#include "scene_check.hpp"

namespace {

using sightline::Result;
using namespace sightline::heights;

Result<HeightTable> read(std::span<const std::byte> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with("\x89PNG")) return read_png_heights(bytes, "fuzz");
    if (text.starts_with("\x93NUMPY")) return read_npy_heights(bytes, "fuzz");
    return read_csv_heights(bytes, "fuzz");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using sightline::fuzz::require;
    const Result<HeightTable> table = read(std::as_bytes(std::span(data, size)));
    if (table) {
        require(table->values.size() == table->columns * table->rows);
    } else {
        const std::string& message = table.error().message;
        require(message.find('\n') == std::string::npos && message.starts_with("fuzz:"));
    }
    return 0;
}
