// Deep scan-line EXR files, read into memory.
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineInputPart.h>

#include <algorithm>
#include <stdexcept>

#include "image/deep_channels.hpp"
#include "image/exr_reader.hpp"

namespace sightline {
namespace {

constexpr std::uint64_t kMaxSamples = std::uint64_t{1} << 28;

/// Reads a deep picture some rows at a time, which all of its samples grow with.
class DeepReader {
public:
    explicit DeepReader(const ExrPart& part) : part_(part), input_(part.file, 0) {
        image_.width = part.width;
        image_.height = part.height;
        image_.placement = part.placement;
        image_.first.push_back(0);
    }

    DeepImage read() {
        constexpr std::uint32_t kPixels = 1u << 16;  // for each there is one address a channel
        const std::uint32_t most = std::max(1u, kPixels / part_.width);
        for (std::uint32_t row = 0; row < part_.height; row += most) {
            read_rows(row, std::min(most, part_.height - row));
        }
        fill_missing();
        return std::move(image_);
    }

private:
    void read_rows(std::uint32_t row, std::uint32_t count) {
        counts_.assign(std::size_t{count} * part_.width, 0);
        const std::size_t before = image_.samples.size();
        const int first = part_.at_row(row).y, last = first + static_cast<int>(count) - 1;
        addresses_.point_to(counts_, nullptr);
        set_frame_buffer(row);
        input_.readPixelSampleCounts(first, last);
        add_counts();
        image_.samples.resize(image_.first.back());
        // In the same place as before: OpenEXR would forget the counts with another frame buffer.
        addresses_.point_to(counts_, image_.samples.data() + before);
        input_.readPixels(first, last);
    }

    void set_frame_buffer(std::uint32_t row) {
        Imf::DeepFrameBuffer frame;
        addresses_.insert_into(frame, counts_, part_.at_row(row), part_.width,
                               [this](const DeepChannel& channel) {
                                   return channel.type == Imf::UINT ? part_.has_uint(channel.name)
                                                                    : part_.has(channel.name);
                               });
        input_.setFrameBuffer(frame);
    }

    void add_counts() {
        std::uint64_t all = image_.first.back();
        for (const std::uint32_t count : counts_) image_.first.push_back(all += count);
        if (all > kMaxSamples) throw std::runtime_error("it has more than 2^28 samples");
    }

    void fill_missing() {
        const bool opaque = !part_.has("A"), thin = !part_.has("ZBack");
        for (DeepSample& sample : image_.samples) {
            if (opaque) sample.color.a = 1;
            if (thin) sample.z_back = sample.z;
        }
    }

    const ExrPart& part_;
    Imf::DeepScanLineInputPart input_;
    DeepImage image_;
    std::vector<std::uint32_t> counts_;
    DeepAddresses addresses_;
};

}  // namespace

DeepImage read_deep_part(const ExrPart& part) { return DeepReader(part).read(); }

}  // namespace sightline
