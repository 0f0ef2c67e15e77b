// The first part of an EXR file that is being read.
#pragma once

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfMultiPartInputFile.h>

#include <cstdint>

#include "sightline/composite.hpp"
#include "sightline/error.hpp"
#include "sightline/image.hpp"

namespace sightline {

/// What the readers of flat and deep pictures get: the limits of read_exr() hold, and the channels
/// that it needs are there.
struct ExrPart {
    Imf::MultiPartInputFile& file;
    std::uint32_t width, height;
    Placement placement;

    [[nodiscard]] const Imf::Header& header() const { return file.header(0); }
    [[nodiscard]] bool has(const char* channel) const {
        return header().channels().findChannel(channel) != nullptr;
    }
    /// Ids would not survive the way through another type.
    [[nodiscard]] bool has_uint(const char* channel) const {
        const Imf::Channel* found = header().channels().findChannel(channel);
        return found != nullptr && found->type == Imf::UINT;
    }
    /// Coordinates of the first pixel of a row.
    [[nodiscard]] glm::ivec2 at_row(std::uint32_t row) const {
        return placement.origin + glm::ivec2(0, static_cast<int>(row));
    }
};

/// These throw what OpenEXR throws, std::runtime_error and std::bad_alloc. They take memory for
/// rows that could be read only, whatever a damaged header promises.
[[nodiscard]] FlatPicture read_flat_part(const ExrPart& part);
[[nodiscard]] DeepImage read_deep_part(const ExrPart& part);

}  // namespace sightline
