// Pieces that are bounded by the planes of other triangles, where samples are concerned.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "visibility/depth_order.hpp"
#include "visibility/over.hpp"
#include "visibility/painting.hpp"

namespace sightline {

/// Decides at samples. Each cut is the ordinary comparison of depths, so the two sides of a cut
/// share out the samples exactly. For one thread.
class CutJudge {
public:
    CutJudge(const ScreenScene& screen, const SampleUnits& units)
        : judge_(screen, units), planes_(screen, units) {}

    /// What the cuts leave of a stretch of triangle `id`.
    [[nodiscard]] Stretch narrow(std::uint32_t id, std::span<const PlaneCut> cuts, std::int32_t row,
                                 Stretch stretch) {
        const SampledPlane own = planes_.plane(id);
        for (const PlaneCut& cut : cuts) {
            const SampledPlane& by = planes_.plane(cut.triangle);
            stretch = cut.behind ? judge_.part_before(by, own, stretch, row)
                                 : judge_.part_before(own, by, stretch, row);
            if (stretch.first >= stretch.end) break;
        }
        return stretch;
    }

private:
    DepthJudge judge_;
    PlaneCache planes_;
};

/// The Cuts of PieceLayers for depth sort.
class PlaneCuts {
public:
    PlaneCuts(const ScreenScene& screen, const SampleUnits& units, std::vector<PlaneCut> cuts)
        : screen_(screen),
          cuts_(std::move(cuts)),
          judges_([&screen, units] { return CutJudge(screen, units); }) {}

    [[nodiscard]] Stretch narrow(const Piece& piece, std::int32_t row, Stretch stretch) const {
        const std::span<const PlaneCut> cuts(cuts_.data() + piece.first_cut,
                                             piece.end_cut - piece.first_cut);
        return judges_.local().narrow(screen_.id(piece.triangle), cuts, row, stretch);
    }

    void report(const ResolveOptions& /*options*/) {}

private:
    const ScreenScene& screen_;
    std::vector<PlaneCut> cuts_;
    mutable tbb::enumerable_thread_specific<CutJudge> judges_;  // what they answer is the same
};

}  // namespace sightline
