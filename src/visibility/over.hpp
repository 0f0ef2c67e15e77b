// Who owns a sample when one surface is painted over another.
//
// A list-priority algorithm never compares depths where it paints, but for one case: two faces that
// share a fold are equally deep along it, and the canonical owner there is the lower id, in
// whatever order the faces are painted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "visibility/sampled_plane.hpp"

namespace sightline {

enum class Ties {
    last_wins,      ///< whoever is painted later
    lower_id_wins,  ///< at an exactly equal depth the lower id, else whoever is painted later
};

/// Planes of triangles by the last bits of their ids: neighbours on a row come again and again.
class PlaneCache {
public:
    PlaneCache(const ScreenScene& screen, const SampleUnits& units)
        : screen_(screen), units_(units), planes_(kPlanes) {
        for (SampledPlane& plane : planes_) plane.id = kNone;
    }

    /// Valid until the next call.
    [[nodiscard]] const SampledPlane& plane(std::uint32_t id) {
        SampledPlane& plane = planes_[id % kPlanes];
        if (plane.id != id) plane = sampled_plane_of(screen_, units_, id);
        return plane;
    }

private:
    static constexpr std::uint32_t kPlanes = 512;
    const ScreenScene& screen_;
    SampleUnits units_;
    std::vector<SampledPlane> planes_;
};

/// Paints runs over a row of owners. For one thread.
class Over {
public:
    Over(const ScreenScene& screen, const SampleUnits& units, Ties ties)
        : judge_(screen, units), planes_(screen, units), ties_(ties) {
        top_.id = kNone;
    }

    /// put(first, end) is called for the columns of the run where it is to be painted. `owners` are
    /// the ids of the run's row. Precondition with Ties::lower_id_wins: the run is nowhere behind
    /// an owner.
    template <class Put>
    void paint(const Run& run, const std::uint32_t* owners, const Put& put) {
        if (ties_ == Ties::last_wins) {
            put(run.first, run.end);
            return;
        }
        for (std::int32_t i = run.first; i < run.end;) {
            const std::uint32_t owner = owners[i];
            const std::int32_t first = i;
            while (i < run.end && owners[i] == owner) ++i;
            const bool free = owner == kNone || owner == run.id;
            const Stretch won = free ? Stretch{first, i} : won_from(run, owner, {first, i});
            if (won.first < won.end) put(won.first, won.end);
        }
    }

    [[nodiscard]] PlaneCache& planes() { return planes_; }
    [[nodiscard]] std::uint64_t comparisons() const { return judge_.comparisons; }
    [[nodiscard]] std::uint64_t exact() const { return judge_.exact; }

private:
    // The part of a stretch that the run wins from one owner.
    [[nodiscard]] Stretch won_from(const Run& run, std::uint32_t owner, Stretch stretch) {
        if (top_.id != run.id) top_ = planes_.plane(run.id);
        return judge_.part_before(top_, planes_.plane(owner), stretch, run.row);
    }

    DepthJudge judge_;
    PlaneCache planes_;
    SampledPlane top_;  // of the latest run
    Ties ties_;
};

}  // namespace sightline
