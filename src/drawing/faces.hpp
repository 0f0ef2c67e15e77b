// All visible faces of a page: their regions, and their areas.
#pragma once

#include <vector>

#include "drawing/regions.hpp"
#include "drawing/work_meter.hpp"

namespace sightline {

/// Appends the region of every source polygon that can be seen, in the order of the polygons.
void append_regions(const ScreenScene& page, const Occluders& occluders,
                    const TraceOptions& options, WorkMeter& meter, Drawing& drawing);

/// See visible_areas(); units of the page squared.
[[nodiscard]] std::vector<FaceArea> find_areas(const ScreenScene& page, const Occluders& occluders,
                                               const TraceOptions& options, WorkMeter& meter);

}  // namespace sightline
