// The samples of a deep pixel in order and without overlaps.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/image.hpp"

namespace sightline {

/// Makes lists of samples tidy, pixel by pixel. It keeps its memory from one to the next; for one
/// thread.
class Tidier {
public:
    /// Begins a pixel.
    void clear() { samples_.clear(); }
    /// More samples of the pixel, in any order. Those without a depth are dropped.
    void add(std::span<const DeepSample> samples);
    /// Appends the tidy list of all samples that were added. It has at most twice as many.
    void append_to(std::vector<DeepSample>& out);

private:
    void sort();
    [[nodiscard]] bool is_tidy() const;
    void sweep(std::vector<DeepSample>& out);

    std::vector<DeepSample> samples_;    // as they were added, so that ties go to the first
    std::vector<std::uint32_t> order_;   // of samples_, by z, z_back and number
    std::vector<std::uint32_t> active_;  // volumes about a place, by number
    std::vector<float> ends_;            // all z and z_back, ascending, each once
};

}  // namespace sightline
