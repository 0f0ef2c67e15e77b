// A triangle cut by half-planes, in double precision: for bounds, where a unit of slack makes up
// for the rounding.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <utility>

#include "sightline/screen_scene.hpp"

namespace sightline {

class ClippedTriangle {
public:
    struct Corner {
        double x, y, z;
    };
    /// Each cut may add a corner.
    static constexpr std::size_t kMaxCuts = 5;

    ClippedTriangle(const ScreenPoint& p, const ScreenPoint& q, const ScreenPoint& r) {
        for (const ScreenPoint* s : {&p, &q, &r})
            corners_[count_++] = {static_cast<double>(s->x), static_cast<double>(s->y),
                                  static_cast<double>(s->z)};
    }

    /// Keeps what has distance(corner) >= 0, a linear function. At most kMaxCuts times.
    template <class Distance>
    void keep(const Distance& distance) {
        std::array<Corner, 3 + kMaxCuts> kept{};
        std::size_t count = 0;
        for (std::size_t i = 0; i < count_; ++i) {
            const Corner &a = corners_[i], &b = corners_[i + 1 == count_ ? 0 : i + 1];
            const double at_a = distance(a), at_b = distance(b);
            if (at_a >= 0) kept[count++] = a;
            if ((at_a >= 0) == (at_b >= 0)) continue;
            const double s = at_a / (at_a - at_b);
            kept[count++] = {a.x + s * (b.x - a.x), a.y + s * (b.y - a.y), a.z + s * (b.z - a.z)};
        }
        corners_ = kept;
        count_ = count;
    }

    /// Empty when nothing is left.
    [[nodiscard]] std::span<const Corner> corners() const { return {corners_.data(), count_}; }

private:
    std::array<Corner, 3 + kMaxCuts> corners_{};
    std::size_t count_ = 0;
};

}  // namespace sightline
