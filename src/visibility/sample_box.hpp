// The samples that a triangle can cover, by its corners.
#pragma once

#include <algorithm>
#include <cstdint>

#include "sightline/screen_scene.hpp"
#include "visibility/sample_units.hpp"

namespace sightline {

/// Half-open in columns and rows, inside of the picture.
struct SampleBox {
    std::int32_t left = 0, right = 0, top = 0, bottom = 0;

    [[nodiscard]] bool empty() const { return left >= right || top >= bottom; }
};

/// Of a screen triangle. Exact for the rule that owns a sample on a left or top edge only.
[[nodiscard]] inline SampleBox sample_box(const ScreenScene& screen, const SampleUnits& units,
                                          std::uint32_t number) {
    const Corners c = screen.corners(number);
    const ScreenPoint &p = screen.point(c.x), &q = screen.point(c.y), &r = screen.point(c.z);
    return {std::max(0, units.first_from(std::min({p.x, q.x, r.x}))),
            std::min(units.columns, units.first_from(std::max({p.x, q.x, r.x}))),
            std::max(0, units.first_from(std::min({p.y, q.y, r.y}))),
            std::min(units.rows, units.first_from(std::max({p.y, q.y, r.y})))};
}

}  // namespace sightline
