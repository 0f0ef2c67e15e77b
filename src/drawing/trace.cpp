// From a page to a drawing.
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "drawing/faces.hpp"
#include "drawing/lines.hpp"
#include "math/arena.hpp"

namespace sightline {
namespace {

Error stopped() { return {ErrorKind::cancelled, "the drawing was stopped before it was done"}; }

}  // namespace

Result<Drawing> trace(const ScreenScene& page, const TraceOptions& options) {
    assert(page.scene().quadrics.empty());
    Drawing drawing;
    drawing.resolution = page.resolution();
    WorkMeter meter(options.progress);
    PageEdges edges;
    std::optional<Occluders> made;
    in_arena(options.threads, [&] {
        tbb::parallel_invoke([&] { made.emplace(page, options.method, options.threads); },
                             [&] { edges = collect_edges(page, options); });
    });
    const Occluders& occluders = *made;
    if (options.edges.has(EdgeKind::intersection))
        append_crossings(occluders, options.threads, meter, edges);
    const bool fills = options.fill != FillStyle::none;
    meter.expect(edges.edges.size() + (fills ? occluders.size() : 0));
    const HiddenParts parts = find_hidden_parts(page, occluders, edges, options.threads, meter);
    if (meter.stopped()) return stopped();
    append_lines(page, edges, parts, options.hidden, drawing);
    drawing.counts.edges = edges.edges.size();
    drawing.counts.intersections = edges.crossings;
    drawing.counts.dismissed =
        static_cast<std::uint64_t>(std::ranges::count_if(edges.edges, &PageEdge::culled));
    drawing.counts.occluder_tests = parts.tests;
    if (fills) append_regions(page, occluders, options, meter, drawing);
    meter.finish();
    if (meter.stopped()) return stopped();
    return drawing;
}

Result<std::vector<FaceArea>> visible_areas(const ScreenScene& page, const TraceOptions& options) {
    assert(page.scene().quadrics.empty());
    const Occluders occluders(page, options.method, options.threads);
    WorkMeter meter(options.progress);
    meter.expect(occluders.size());
    std::vector<FaceArea> areas = find_areas(page, occluders, options, meter);
    meter.finish();
    if (meter.stopped()) return stopped();
    const double scale = std::ldexp(1.0, -2 * page.subpixel_bits());
    for (FaceArea& area : areas) {
        area.projected *= scale;
        area.visible *= scale;
    }
    return areas;
}

}  // namespace sightline
