// The channels of a deep picture, and where OpenEXR finds the samples of each pixel in them.
#pragma once

#include <ImfDeepFrameBuffer.h>
#include <ImfPixelType.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "image/exr_stream.hpp"
#include "sightline/image.hpp"

namespace sightline {

/// One channel: its type in a file and its place in a DeepSample.
struct DeepChannel {
    const char* name;
    Imf::PixelType type;
    std::size_t offset;
};

static_assert(sizeof(glm::vec4) == 4 * sizeof(float));
inline constexpr std::size_t kDeepColor = offsetof(DeepSample, color);
inline constexpr std::array<DeepChannel, 8> kDeepChannels = {{
    {"R", Imf::FLOAT, kDeepColor},
    {"G", Imf::FLOAT, kDeepColor + sizeof(float)},
    {"B", Imf::FLOAT, kDeepColor + 2 * sizeof(float)},
    {"A", Imf::FLOAT, kDeepColor + 3 * sizeof(float)},
    {"Z", Imf::FLOAT, offsetof(DeepSample, z)},
    {"ZBack", Imf::FLOAT, offsetof(DeepSample, z_back)},
    {"object", Imf::UINT, offsetof(DeepSample, object)},
    {"triangle", Imf::UINT, offsetof(DeepSample, triangle)},
}};

/// For OpenEXR, which wants an address for every pixel in every channel.
class DeepAddresses {
public:
    /// The samples of all pixels stand one after the other; null where there are none.
    void point_to(std::span<const std::uint32_t> counts, const DeepSample* samples) {
        static const DeepSample kNowhere;
        if (samples == nullptr) samples = &kNowhere;
        for (std::size_t k = 0; k < kDeepChannels.size(); ++k) {
            const char* at = reinterpret_cast<const char*>(samples) + kDeepChannels[k].offset;
            pointers_[k].resize(counts.size());
            for (std::size_t i = 0; i < counts.size(); ++i) {
                pointers_[k][i] = at;
                at += counts[i] * sizeof(DeepSample);
            }
        }
    }

    /// The first of the counts belongs to the pixel at `origin`. Channels that `wanted` does not
    /// ask for are left out. The addresses must stay until the pixels are read or written.
    template <class Wanted>
    void insert_into(Imf::DeepFrameBuffer& frame, std::span<const std::uint32_t> counts,
                     glm::ivec2 origin, std::size_t width, const Wanted& wanted) const {
        constexpr std::size_t kCount = sizeof(std::uint32_t), kAddress = sizeof(const char*);
        frame.insertSampleCountSlice({Imf::UINT,
                                      exr_base(counts.data(), origin, kCount, kCount * width),
                                      kCount, kCount * width});
        for (std::size_t k = 0; k < kDeepChannels.size(); ++k) {
            if (!wanted(kDeepChannels[k])) continue;
            char* base = exr_base(pointers_[k].data(), origin, kAddress, kAddress * width);
            frame.insert(kDeepChannels[k].name,
                         Imf::DeepSlice(kDeepChannels[k].type, base, kAddress, kAddress * width,
                                        sizeof(DeepSample)));
        }
    }

private:
    std::array<std::vector<const char*>, kDeepChannels.size()> pointers_;
};

}  // namespace sightline
