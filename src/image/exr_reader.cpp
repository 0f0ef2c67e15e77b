// Which EXR files can be read, and the flat ones.
#include "image/exr_reader.hpp"

#include <ImathBox.h>
#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>
#include <ImfPartType.h>
#include <ImfTestFile.h>
#include <ImfThreading.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <new>
#include <string_view>

#include "image/exr_stream.hpp"

namespace sightline {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMaxSide = 65'536, kMaxPixels = std::int64_t{1} << 28;

Error unreadable(ErrorKind kind, const std::string& path, std::string cause,
                 std::string_view way_out) {
    // One line, whatever OpenEXR says.
    std::replace(cause.begin(), cause.end(), '\n', ' ');
    return {kind, fmt::format("{}: cannot read it: {}; {}", path, cause, way_out)};
}

Error unusable(const std::string& path, std::string cause, std::string_view way_out) {
    return unreadable(ErrorKind::bad_input, path, std::move(cause), way_out);
}

/// Before OpenEXR looks at it, whose messages do not tell these from damage.
std::optional<Error> check_file(const std::string& path) {
    std::error_code ignored;
    const fs::file_status status = fs::status(path, ignored);
    if (fs::exists(status) && !fs::is_regular_file(status)) {
        return unreadable(ErrorKind::io, path, "it is no ordinary file", "name an EXR file");
    }
    errno = 0;
    if (!std::ifstream(path, std::ios::binary)) {
        return unreadable(ErrorKind::io, path, std::strerror(errno),
                          "check the name and its permissions");
    }
    if (!Imf::isOpenExrFile(path.c_str())) {
        return unusable(path, "it is no EXR file", "write one, as in 'sightline render -o a.exr'");
    }
    return std::nullopt;
}

std::optional<Error> check_channels(const std::string& path, const Imf::ChannelList& channels) {
    for (const char* name : {"R", "G", "B", "Z"}) {
        const Imf::Channel* channel = channels.findChannel(name);
        if (channel == nullptr) {
            return unusable(path, fmt::format("it has no channel '{}'", name),
                            "write colour and depth (R G B Z) into one file, as 'sightline render "
                            "-o' does");
        }
    }
    return std::nullopt;
}

bool is_deep(const Imf::Header& header) {
    return header.hasType() && header.type() == Imf::DEEPSCANLINE;
}

glm::ivec2 vector_of(const Imath::V2i& v) { return {v.x, v.y}; }

Result<ExrPicture> read_part(const std::string& path, Imf::MultiPartInputFile& file) {
    const Imf::Header& header = file.header(0);
    const Imath::Box2i data = header.dataWindow(), frame = header.displayWindow();
    const std::int64_t width = std::int64_t{data.max.x} - data.min.x + 1,
                       height = std::int64_t{data.max.y} - data.min.y + 1;
    if (width > kMaxSide || height > kMaxSide || width * height > kMaxPixels) {
        return unusable(path, fmt::format("it has {}x{} pixels", width, height),
                        "at most 65536 a side and 2^28 in all can be joined: cut it into parts");
    }
    if (header.hasType() && header.type() == Imf::DEEPTILE) {
        return unusable(path, "it has deep tiles", "write deep scan lines");
    }
    if (auto error = check_channels(path, header.channels())) return std::move(*error);
    const ExrPart part{
        file,
        static_cast<std::uint32_t>(width),
        static_cast<std::uint32_t>(height),
        {vector_of(data.min), Placement::Frame{vector_of(frame.min), vector_of(frame.max)}}};
    if (is_deep(header)) return ExrPicture(read_deep_part(part));
    return ExrPicture(read_flat_part(part));
}

// -- flat pictures -----------------------------------------------------------------------------

/// Reads a flat picture some rows at a time. Images grow with the rows.
class FlatReader {
public:
    explicit FlatReader(const ExrPart& part) : part_(part), input_(part.file, 0) {
        prepare(picture_.color);
        prepare(picture_.depth);
        if (part.has("N.X") && part.has("N.Y") && part.has("N.Z")) {
            prepare(picture_.normals.emplace());
        }
        if (part.has_uint("object")) prepare(picture_.objects.emplace());
        if (part.has_uint("triangle")) prepare(picture_.triangles.emplace());
        picture_.placement = part.placement;
    }

    FlatPicture read() {
        constexpr std::uint32_t kBlockRows = 256;  // the most that any compression has in a block
        for (std::uint32_t row = 0; row < part_.height; row += kBlockRows) {
            read_rows(row, std::min(kBlockRows, part_.height - row));
        }
        if (!part_.has("A")) clear_background();
        return std::move(picture_);
    }

private:
    template <class T>
    void prepare(Image<T>& image) {
        image.width = part_.width;
        image.height = part_.height;
        image.pixels.reserve(std::size_t{part_.width} * part_.height);  // takes no memory yet
    }

    void read_rows(std::uint32_t row, std::uint32_t count) {
        Imf::FrameBuffer frame;
        insert<float>(frame, {"R", "G", "B", "A"}, Imf::FLOAT, picture_.color, row, count);
        insert<float>(frame, {"Z"}, Imf::FLOAT, picture_.depth, row, count);
        if (picture_.normals) {
            insert<float>(frame, {"N.X", "N.Y", "N.Z"}, Imf::FLOAT, *picture_.normals, row, count);
        }
        if (picture_.objects) {
            insert<std::uint32_t>(frame, {"object"}, Imf::UINT, *picture_.objects, row, count);
        }
        if (picture_.triangles) {
            insert<std::uint32_t>(frame, {"triangle"}, Imf::UINT, *picture_.triangles, row, count);
        }
        input_.setFrameBuffer(frame);
        const int first = part_.at_row(row).y;
        input_.readPixels(first, first + static_cast<int>(count) - 1);
    }

    /// The channels that make one pixel of type T. Missing ones become 1.
    template <class Component, class T>
    void insert(Imf::FrameBuffer& frame, std::initializer_list<const char*> names,
                Imf::PixelType type, Image<T>& image, std::uint32_t row, std::uint32_t count) {
        const std::size_t before = std::size_t{row} * part_.width;
        image.pixels.resize(before + std::size_t{count} * part_.width);
        const auto* component = reinterpret_cast<const Component*>(image.pixels.data() + before);
        const std::size_t stride = sizeof(T) * part_.width;
        for (const char* name : names) {
            char* base = exr_base(component++, part_.at_row(row), sizeof(T), stride);
            frame.insert(name, Imf::Slice(type, base, sizeof(T), stride, 1, 1, 1.0));
        }
    }

    /// Without alpha, nothing seen is nothing there.
    void clear_background() {
        for (std::size_t i = 0; i < picture_.depth.pixels.size(); ++i) {
            if (!std::isfinite(picture_.depth.pixels[i])) picture_.color.pixels[i].a = 0;
        }
    }

    const ExrPart& part_;
    Imf::InputPart input_;
    FlatPicture picture_;
};

}  // namespace

FlatPicture read_flat_part(const ExrPart& part) { return FlatReader(part).read(); }

Result<ExrPicture> read_exr(const std::string& path) {
    if (auto error = check_file(path)) return std::move(*error);
    try {
        Imf::MultiPartInputFile file(path.c_str(), Imf::globalThreadCount());
        return read_part(path, file);
    } catch (const std::bad_alloc&) {
        return unreadable(ErrorKind::io, path, "not enough memory", "give fewer or smaller files");
    } catch (const std::exception& e) {
        return unusable(path, e.what(), "it may be damaged: write it anew");
    }
}

}  // namespace sightline
