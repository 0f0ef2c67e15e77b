// What the writers of EXR files share: where their bytes go, and how their errors read.
#pragma once

#include <ImfHeader.h>
#include <ImfIO.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "image/atomic_file.hpp"
#include "sightline/error.hpp"
#include "sightline/image.hpp"

namespace sightline {

/// OpenEXR's view of an AtomicFile, whose first error sticks.
class ExrStream final : public Imf::OStream {
public:
    explicit ExrStream(AtomicFile file) : OStream(file.path().c_str()), file_(std::move(file)) {}
    void write(const char c[], int n) override {
        demand(file_.write(c, static_cast<std::size_t>(n)));
    }
    std::uint64_t tellp() override { return file_.position(); }
    void seekp(std::uint64_t position) override { demand(file_.seek(position)); }
    [[nodiscard]] AtomicFile& file() { return file_; }

    /// The file's error when it has one, else OpenEXR's.
    [[nodiscard]] Error error(std::string_view cause) const;

private:
    /// OpenEXR wants an exception; it is caught where OpenEXR is called.
    static void demand(const Status& status) {
        if (!status) throw std::runtime_error(status.error().message);
    }
    AtomicFile file_;
};

/// Why a picture can't be written at all (bad_option).
[[nodiscard]] Error exr_error(const std::string& path, std::string_view cause);

/// A header without channels. Precondition: the picture has pixels.
[[nodiscard]] Imf::Header exr_header(std::uint32_t width, std::uint32_t height,
                                     const Placement& placement, Imf::Compression compression);

/// The address that the pixel (0, 0) of a file would have when `first` belongs to the pixel at
/// `origin`, as OpenEXR wants it; it never reads or writes there.
template <class T>
[[nodiscard]] char* exr_base(const T* first, glm::ivec2 origin, std::size_t step,
                             std::size_t stride) {
    // Unsigned: negative coordinates wrap, and so does the product with them.
    const auto x = static_cast<std::uintptr_t>(static_cast<std::intptr_t>(origin.x));
    const auto y = static_cast<std::uintptr_t>(static_cast<std::intptr_t>(origin.y));
    const std::uintptr_t address = reinterpret_cast<std::uintptr_t>(first) - x * step - y * stride;
    // NOLINTNEXTLINE(performance-no-int-to-ptr): there is no object at that address
    return reinterpret_cast<char*>(address);
}

}  // namespace sightline
