#include "composite/deep.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "composite/tidy.hpp"
#include "math/arena.hpp"
#include "sightline/composite.hpp"

namespace sightline {
namespace {

constexpr std::uint32_t kBlockRows = 16;

/// body(first row, end row) for blocks of rows, in any order.
template <class Body>
void for_row_blocks(std::uint32_t height, int threads, const Body& body) {
    in_arena(threads, [&] {
        tbb::parallel_for(0u, (height + kBlockRows - 1) / kBlockRows, [&](std::uint32_t block) {
            const std::uint32_t first = block * kBlockRows;
            body(first, std::min(first + kBlockRows, height));
        });
    });
}

/// The samples of some pixels.
struct Block {
    std::vector<std::uint64_t> ends;  ///< where those of each pixel end in `samples`
    std::vector<DeepSample> samples;
};

Block tidy_block(std::span<const DeepImage* const> pictures, std::size_t first, std::size_t end) {
    Block block;
    Tidier tidier;
    for (std::size_t i = first; i < end; ++i) {
        tidier.clear();
        for (const DeepImage* picture : pictures) tidier.add(picture->pixel(i));
        tidier.append_to(block.samples);
        block.ends.push_back(block.samples.size());
    }
    return block;
}

/// Gives the memory of each block back as soon as it is copied.
void append_blocks(std::vector<Block> blocks, DeepImage& image) {
    std::size_t all = 0;
    for (const Block& block : blocks) all += block.samples.size();
    image.samples.reserve(all);
    image.first.reserve(std::size_t{image.width} * image.height + 1);
    image.first.push_back(0);
    for (Block& block : blocks) {
        const std::uint64_t before = image.samples.size();
        for (const std::uint64_t end : block.ends) image.first.push_back(before + end);
        image.samples.insert(image.samples.end(), block.samples.begin(), block.samples.end());
        block = {};
    }
}

/// Lays the samples of a tidy pixel over one another, from front to back.
void flatten_pixel(std::span<const DeepSample> samples, glm::vec4& color, float& depth) {
    glm::dvec4 sum(0);
    for (const DeepSample& sample : samples) {
        if (sample.color == glm::vec4(0)) continue;
        depth = std::min(depth, sample.z);
        if (sum.a >= 1) break;
        sum += (1 - sum.a) * glm::dvec4(sample.color);
    }
    color = sum;
}

}  // namespace

DeepImage join_deep(std::span<const DeepImage* const> pictures, int threads) {
    DeepImage image{pictures[0]->width, pictures[0]->height, {}, {}, pictures[0]->placement};
    const std::size_t width = image.width;
    std::vector<Block> blocks((image.height + kBlockRows - 1) / kBlockRows);
    for_row_blocks(image.height, threads, [&](std::uint32_t first, std::uint32_t end) {
        blocks[first / kBlockRows] = tidy_block(pictures, first * width, end * width);
    });
    append_blocks(std::move(blocks), image);
    return image;
}

FlatPicture flatten(const DeepImage& image, int threads) {
    FlatPicture flat;
    flat.color = ColorImage(image.width, image.height, glm::vec4(0));
    flat.depth = DepthImage(image.width, image.height, std::numeric_limits<float>::infinity());
    flat.placement = image.placement;
    for_row_blocks(image.height, threads, [&](std::uint32_t first, std::uint32_t end) {
        Tidier tidier;
        std::vector<DeepSample> samples;
        for (std::size_t i = std::size_t{first} * image.width; i < std::size_t{end} * image.width;
             ++i) {
            tidier.clear();
            tidier.add(image.pixel(i));
            samples.clear();
            tidier.append_to(samples);
            flatten_pixel(samples, flat.color.pixels[i], flat.depth.pixels[i]);
        }
    });
    return flat;
}

}  // namespace sightline
