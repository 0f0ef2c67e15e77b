// A triangle's plane over the samples of a picture: what the scan-line algorithms and Warnock's
// compare, and how they write what they have decided.
#pragma once

#include <cstdint>

#include "sightline/visibility.hpp"
#include "visibility/sample_units.hpp"
#include "visibility/stored_depth.hpp"

namespace sightline {

/// The plane of a triangle in double precision, with a bound of the error.
///
/// Error. With u = 2^-53, X = |gx i| and Y = |gy j| at the farthest sample, and R the sum of the
/// two terms of the rise from the plane's anchor to sample (0, 0): gx and gy are off by 3 u, their
/// products by 4 u, the sum of the two by 5 u (X + Y); z0 by 5 u R + u (at.z + R); the last
/// addition by u (at.z + R + X + Y). Together below 6 u (X + Y) + 7 u R + 2 u at.z; 8 u of their
/// sum is kept.
struct SampledPlane {
    double z0, gx, gy;     ///< depth at sample (i, j) is z0 + (gx * i + gy * j) ...
    double slack;          ///< ... within this, at every sample of the picture
    DepthGradient stored;  ///< for the depth that is stored, from the plane's anchor:
    std::int32_t at_x, at_y;
    std::uint32_t id;      ///< of the triangle in the scene
    std::uint32_t shared;  ///< its sheet, when the shared plane is in force, else kNone

    [[nodiscard]] double depth(std::int32_t i, std::int32_t j) const {
        return z0 + (gx * i + gy * j);
    }
};

/// The surface of screen triangle `number`. Precondition: it is drawable and covers a sample.
[[nodiscard]] SampledPlane sampled_plane_of(const ScreenScene& screen, const SampleUnits& units,
                                            std::uint32_t number);

/// Columns first .. end-1 of a row.
struct Stretch {
    std::int32_t first, end;
};

/// Puts surfaces into the canonical order at a sample, and counts what that took.
class DepthJudge {
public:
    DepthJudge(const ScreenScene& screen, const SampleUnits& units, Observer* observer = nullptr)
        : screen_(screen), units_(units), observer_(observer) {}

    /// True when a is nearer than b at sample (i, j): exact depth, then the lower id.
    [[nodiscard]] bool before(const SampledPlane& a, const SampledPlane& b, std::int32_t i,
                              std::int32_t j) {
        ++comparisons;
        tell(StepKind::depths_compared, a, b, i, j);
        const double difference = a.depth(i, j) - b.depth(i, j);
        const double slack = a.slack + b.slack;
        if (difference < -slack) return true;
        if (difference > slack) return false;
        return before_exactly(a, b, i, j);
    }

    /// The first column of first+1 .. last at which b is before a in row j. Precondition: a is
    /// before b at `first`, and b before a at `last`.
    [[nodiscard]] std::int32_t crossing(const SampledPlane& a, const SampledPlane& b,
                                        std::int32_t first, std::int32_t last, std::int32_t j);

    /// The columns of a stretch of row j, not empty, where a is before b. Depths along a row are
    /// linear, so its ends tell.
    [[nodiscard]] Stretch part_before(const SampledPlane& a, const SampledPlane& b, Stretch stretch,
                                      std::int32_t j);

    std::uint64_t comparisons = 0;  ///< all of them
    std::uint64_t exact = 0;        ///< those that went to integers

private:
    void tell(StepKind kind, const SampledPlane& a, const SampledPlane& b, std::int32_t i,
              std::int32_t j) const {
        if (observer_ == nullptr) return;
        const auto x = static_cast<std::uint32_t>(i), y = static_cast<std::uint32_t>(j);
        observer_->step({kind, a.id, b.id, x, y, x + 1, y + 1});
    }
    [[nodiscard]] bool before_exactly(const SampledPlane& a, const SampledPlane& b, std::int32_t i,
                                      std::int32_t j);

    const ScreenScene& screen_;
    SampleUnits units_;
    Observer* observer_;
};

/// Writes samples first .. end-1 of row j: the surface's id and its stored depth. ids and depth
/// point to the row's first sample.
void fill_run(const ScreenScene& screen, const SampleUnits& units, const SampledPlane& surface,
              std::int32_t j, std::int32_t first, std::int32_t end, std::uint32_t* ids,
              float* depth);

/// The same for samples that see nothing.
void fill_background(std::int32_t first, std::int32_t end, std::uint32_t* ids, float* depth);

}  // namespace sightline
