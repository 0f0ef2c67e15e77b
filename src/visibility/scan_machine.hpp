// What the scan-line algorithms keep of the row that they are at.
#pragma once

#include <cstdint>

#include "visibility/sampled_plane.hpp"

namespace sightline {

/// Base of the Machines of a RowScanner: the row, who judges depths on it, and its output.
class ScanMachine {
public:
    ScanMachine(const ScreenScene& screen, const SampleUnits& units, Observer* observer)
        : screen_(screen), units_(units), observer_(observer), judge_(screen, units, observer) {}

    /// ids and depth point to the row's first sample.
    void open_row(std::int32_t row, std::uint32_t* ids, float* depth) {
        row_ = row;
        ids_ = ids;
        depth_ = depth;
    }

protected:
    /// Samples first .. end-1 belong to a surface, or to none.
    void fill_run(const SampledPlane& surface, std::int32_t first, std::int32_t end) {
        sightline::fill_run(screen_, units_, surface, row_, first, end, ids_, depth_);
    }
    void fill_background(std::int32_t first, std::int32_t end) {
        sightline::fill_background(first, end, ids_, depth_);
    }

    /// Tells the observer, if there is one, of a step on columns first .. end-1 of the row.
    void tell(StepKind kind, const SampledPlane& surface, std::uint32_t other, std::int32_t first,
              std::int32_t end) const {
        if (observer_ == nullptr) return;
        const auto y = static_cast<std::uint32_t>(row_);
        observer_->step({kind, surface.id, other, static_cast<std::uint32_t>(first), y,
                         static_cast<std::uint32_t>(end), y + 1});
    }

    // Protected, for this is a part of each Machine rather than something to hide from it.
    const ScreenScene& screen_;
    SampleUnits units_;
    Observer* observer_;
    DepthJudge judge_;
    std::int32_t row_ = 0;

private:
    std::uint32_t* ids_ = nullptr;
    float* depth_ = nullptr;
};

}  // namespace sightline
