// Visible areas of faces, and the heirs of what only snapping shows of them.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "drawing/faces.hpp"
#include "drawing/polygon_tasks.hpp"
#include "view/clip.hpp"
#include "view/facing.hpp"
#include "view/transform.hpp"

namespace sightline {
namespace {

/// On the page, of a face that was removed because of the side it shows.
double removed_area(const ScreenScene& page, const ScreenTransform& transform, std::uint32_t t) {
    const Corners c = page.scene().triangles[t];
    const auto& positions = page.scene().positions;
    std::vector<ScreenPoint> polygon;
    clip_triangle(transform, {positions[c.x], positions[c.y], positions[c.z]}, polygon);
    std::int64_t doubled = 0;
    for (std::size_t k = 2; k < polygon.size(); ++k)
        doubled += side(polygon[0].x, polygon[0].y, polygon[k - 1].x, polygon[k - 1].y,
                        polygon[k].x, polygon[k].y);
    return 0.5 * std::abs(static_cast<double>(doubled));
}

/// Whether what shows the other side of a face counts in its place.
bool has_twin(const Scene& scene, std::uint32_t t) {
    return !scene.equal_faces.empty() && scene.equal_faces[t] != 0;
}

/// What is known of faces before any is compared with others.
std::vector<FaceArea> begin_areas(const ScreenScene& page, int threads) {
    std::vector<FaceArea> areas(page.scene().triangle_count());
    const ScreenTransform transform = page_transform(page);
    in_arena(threads, [&] {
        tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, page.scene().triangle_count(), 4096),
                          [&](const auto& range) {
                              for (std::uint32_t t = range.begin(); t != range.end(); ++t) {
                                  const Corners c = page.scene().triangles[t];
                                  const auto& positions = page.scene().positions;
                                  areas[t].front =
                                      facing(page.camera(), {positions[c.x], positions[c.y],
                                                             positions[c.z]}) == Facing::front;
                                  if (page.culled(t) && !has_twin(page.scene(), t))
                                      areas[t].projected = removed_area(page, transform, t);
                              }
                          });
    });
    return areas;
}

/// Areas of the triangles of one source polygon after another.
class AreaTask {
public:
    AreaTask(const ScreenScene& page, const Occluders& occluders, RegionFinder& finder,
             std::vector<FaceArea>& areas, std::span<std::uint8_t> seen)
        : page_(page), occluders_(occluders), finder_(finder), areas_(areas), seen_(seen) {}

    void run(std::span<const std::uint32_t> order, std::vector<Sliver>& slivers) {
        for (const std::uint32_t k : order) {
            const std::uint32_t polygon = page_.scene().triangle_polygon[occluders_[k].id];
            if (!parts_.empty() && polygon != polygon_) finish_polygon(slivers);
            polygon_ = polygon;
            take(k);
        }
        if (!parts_.empty()) finish_polygon(slivers);
    }

private:
    /// Of a triangle, or of a piece of one: its border, border_[begin] .. border_[end - 1].
    struct Part {
        std::uint32_t occluder, triangle;
        std::size_t begin, end;
    };

    void take(std::uint32_t k) {
        const Occluder& o = occluders_[k];
        Part part{k, o.id, border_.size(), 0};
        finder_.find(k, border_);
        part.end = border_.size();
        parts_.push_back(part);
        const double doubled = sight_.add(o, border_of(part));
        areas_[o.id].projected +=
            0.5 * static_cast<double>(side(o.p.x, o.p.y, o.q.x, o.q.y, o.r.x, o.r.y));
        areas_[o.id].visible += 0.5 * doubled;
    }
    [[nodiscard]] std::span<const BorderPiece> border_of(const Part& part) const {
        return std::span(border_).subspan(part.begin, part.end - part.begin);
    }
    void finish_polygon(std::vector<Sliver>& slivers) {
        if (sight_.is_sliver()) {
            slivers.push_back({polygon_, kNone, border_});
        } else if (!border_.empty()) {
            seen_[polygon_] = 1;
            share_out();
        }
        parts_.clear();
        border_.clear();
        sight_.clear();
    }
    /// Slivers of triangles go to the triangle of the polygon of which most is seen.
    void share_out() {
        std::ranges::sort(parts_, {}, &Part::triangle);
        if (parts_.front().triangle == parts_.back().triangle) return;
        std::uint32_t most = parts_.front().triangle;
        std::vector<std::uint32_t> narrow;
        for (std::size_t i = 0, end = 0; i < parts_.size(); i = end) {
            const std::uint32_t t = parts_[i].triangle;
            sight_.clear();
            for (; end < parts_.size() && parts_[end].triangle == t; ++end)
                sight_.add(occluders_[parts_[end].occluder], border_of(parts_[end]));
            if (areas_[t].visible > areas_[most].visible) most = t;
            if (sight_.is_sliver()) narrow.push_back(t);
        }
        for (const std::uint32_t t : narrow) {
            if (t == most) continue;
            areas_[most].visible += areas_[t].visible;
            areas_[t].visible = 0;
        }
    }

    const ScreenScene& page_;
    const Occluders& occluders_;
    RegionFinder& finder_;
    std::vector<FaceArea>& areas_;
    std::span<std::uint8_t> seen_;
    std::uint32_t polygon_ = 0;
    std::vector<Part> parts_;
    std::vector<BorderPiece> border_;
    FaceSight sight_;
};

/// Gives what is seen of slivers to their heirs: to the triangle of which most is seen.
void bequeath(const Scene& scene, std::span<const Sliver> slivers, std::vector<FaceArea>& areas) {
    if (slivers.empty()) return;
    std::vector<std::uint32_t> heir(nothing_seen(scene).size(), kNone), most = heir;
    for (const Sliver& sliver : slivers) heir[sliver.polygon] = sliver.heir;
    for (std::uint32_t t = 0; t < areas.size(); ++t) {
        std::uint32_t& best = most[scene.triangle_polygon[t]];
        if (best == kNone || areas[t].visible > areas[best].visible) best = t;
    }
    for (std::uint32_t t = 0; t < areas.size(); ++t) {
        const std::uint32_t polygon = heir[scene.triangle_polygon[t]];
        if (polygon == kNone) continue;
        areas[most[polygon]].visible += areas[t].visible;
        areas[t].visible = 0;
    }
}

}  // namespace

std::vector<FaceArea> find_areas(const ScreenScene& page, const Occluders& occluders,
                                 const TraceOptions& options, WorkMeter& meter) {
    std::vector<FaceArea> areas = begin_areas(page, options.threads);
    std::vector<std::uint8_t> seen = nothing_seen(page.scene());
    RegionFinders finders([&] { return RegionFinder(occluders, options.method); });
    // Polygons, so that the pieces of a clipped triangle are one thread's.
    const std::vector<std::uint32_t> order = by_polygon(page, occluders);
    std::vector<std::vector<Sliver>> tasks(order.size() / kFaceGrain + 1);
    for_polygons(page, occluders, order, options.threads,
                 [&](std::size_t task, std::size_t begin, std::size_t end) {
                     if (meter.stopped()) return;
                     AreaTask(page, occluders, finders.local(), areas, seen)
                         .run(std::span(order).subspan(begin, end - begin), tasks[task]);
                     meter.add(end - begin);
                 });
    std::vector<Sliver> slivers;
    for (auto& task : tasks) std::ranges::move(task, std::back_inserter(slivers));
    find_heirs(page, occluders, seen, slivers, options.threads);
    bequeath(page.scene(), slivers, areas);
    // What cancels out in a sum may leave less than nothing.
    for (FaceArea& area : areas) area.visible = std::max(area.visible, 0.0);
    return areas;
}

}  // namespace sightline
