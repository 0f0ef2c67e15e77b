#include "drawing/faces.hpp"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "drawing/region_loops.hpp"
#include "math/arena.hpp"
#include "shading/lighting.hpp"
#include "shading/surface.hpp"
#include "view/clip.hpp"
#include "view/facing.hpp"
#include "view/transform.hpp"

namespace sightline {
namespace {

constexpr std::size_t kGrain = 128;  // occluders that a task takes at a time, about
constexpr glm::vec3 kFlatColor{0.7f, 0.7f, 0.7f};

using RegionFinders = tbb::enumerable_thread_specific<RegionFinder>;

/// Occluders in the order of their source polygons, so that those of a polygon stand together.
std::vector<std::uint32_t> by_polygon(const ScreenScene& page, const Occluders& occluders) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sorted(occluders.size());
    for (std::uint32_t k = 0; k < occluders.size(); ++k)
        sorted[k] = {page.scene().triangle_polygon[occluders[k].id], k};
    tbb::parallel_sort(sorted.begin(), sorted.end());
    std::vector<std::uint32_t> order(sorted.size());
    std::ranges::transform(sorted, order.begin(), [](const auto& item) { return item.second; });
    return order;
}

/// body(task, begin, end) for stretches of the order that never divide a polygon.
template <class Body>
void for_polygons(const ScreenScene& page, const Occluders& occluders,
                  const std::vector<std::uint32_t>& order, int threads, const Body& body) {
    std::vector<std::size_t> starts = {0};
    const auto polygon = [&](std::size_t i) {
        return page.scene().triangle_polygon[occluders[order[i]].id];
    };
    while (starts.back() < order.size()) {
        std::size_t end = std::min(order.size(), starts.back() + kGrain);
        while (end < order.size() && polygon(end) == polygon(end - 1)) ++end;
        starts.push_back(end);
    }
    in_arena(threads, [&] {
        tbb::parallel_for(std::size_t{0}, starts.size() - 1,
                          [&](std::size_t task) { body(task, starts[task], starts[task + 1]); });
    });
}

/// The colour of a source polygon.
class FillColors {
public:
    FillColors(const ScreenScene& page, FillStyle style)
        : page_(page), style_(style), lighting_(page.scene(), page.camera()) {}

    [[nodiscard]] glm::vec3 of(std::uint32_t triangle) const {
        if (style_ == FillStyle::flat) return kFlatColor;
        const Surface surface = make_surface(page_, triangle);
        const glm::vec3 base = base_color(surface, triangle);
        if (style_ == FillStyle::material) return base;
        const Reflection light = lighting_.reflect(polygon_point(page_.scene(), triangle),
                                                   surface.normal, *surface.material);
        return glm::clamp(light.diffuse * base, 0.0f, 1.0f);
    }

private:
    [[nodiscard]] glm::vec3 base_color(const Surface& surface, std::uint32_t triangle) const {
        if (!surface.colored) return surface.material->base_color;
        const Scene& scene = page_.scene();
        const Corners c = scene.triangle_colors[triangle];
        return glm::vec3(scene.colors[c.x] + scene.colors[c.y] + scene.colors[c.z]) / 3.0f;
    }

    const ScreenScene& page_;
    FillStyle style_;
    Lighting lighting_;
};

/// What a task finds.
struct TaskRegions {
    std::vector<std::uint32_t> triangle;  // one of each region's polygon
    std::vector<glm::vec3> color;
    std::vector<std::uint32_t> loops;  // how many each region has
    RegionLoops shapes;
    DrawingCounts counts;
};

class RegionTask {
public:
    RegionTask(const ScreenScene& page, const Occluders& occluders, RegionFinder& finder,
               const FillColors& colors)
        : page_(page), occluders_(occluders), finder_(finder), colors_(colors) {}

    void run(std::span<const std::uint32_t> order, TaskRegions& found) {
        found.shapes.first.push_back(0);
        for (std::size_t i = 0; i < order.size(); ++i) {
            count(finder_.find(order[i], border_), found.counts);
            if (i + 1 < order.size() && polygon(order[i + 1]) == polygon(order[i])) continue;
            finish_polygon(occluders_[order[i]].id, found);
        }
    }

private:
    [[nodiscard]] std::uint32_t polygon(std::uint32_t k) const {
        return page_.scene().triangle_polygon[occluders_[k].id];
    }
    static void count(FaceFate fate, DrawingCounts& counts) {
        ++(fate == FaceFate::whole    ? counts.faces_whole
           : fate == FaceFate::partly ? counts.faces_partly
                                      : counts.faces_hidden);
    }
    void finish_polygon(std::uint32_t triangle, TaskRegions& found) {
        if (border_.empty()) return;
        const std::size_t before = found.shapes.first.size();
        join_loops(border_, found.shapes);
        if (found.shapes.first.size() == before) return;
        found.triangle.push_back(triangle);
        found.color.push_back(colors_.of(triangle));
        found.loops.push_back(static_cast<std::uint32_t>(found.shapes.first.size() - before));
    }

    const ScreenScene& page_;
    const Occluders& occluders_;
    RegionFinder& finder_;
    const FillColors& colors_;
    std::vector<BorderPiece> border_;
};

void append(const ScreenScene& page, const TaskRegions& found, Drawing& drawing) {
    DrawnRegions& all = drawing.regions;
    const double step = std::ldexp(1.0, -page.subpixel_bits());
    for (std::size_t r = 0; r < found.triangle.size(); ++r) {
        all.polygon.push_back(page.scene().triangle_polygon[found.triangle[r]]);
        all.object.push_back(page.scene().object_of(found.triangle[r]));
        all.color.push_back(found.color[r]);
        all.first_loop.push_back(all.first_loop.back() + found.loops[r]);
    }
    const std::uint32_t shift = all.first_point.back();
    for (std::size_t l = 1; l < found.shapes.first.size(); ++l)
        all.first_point.push_back(shift + found.shapes.first[l]);
    for (const glm::ivec2& p : found.shapes.points) all.points.push_back(step * glm::dvec2(p));
    drawing.counts.faces_whole += found.counts.faces_whole;
    drawing.counts.faces_partly += found.counts.faces_partly;
    drawing.counts.faces_hidden += found.counts.faces_hidden;
}

double cross(const glm::dvec2& u, const glm::dvec2& v) { return u.x * v.y - u.y * v.x; }

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

}  // namespace

void append_regions(const ScreenScene& page, const Occluders& occluders,
                    const TraceOptions& options, WorkMeter& meter, Drawing& drawing) {
    const FillColors colors(page, options.fill);
    const std::vector<std::uint32_t> order = by_polygon(page, occluders);
    std::vector<TaskRegions> tasks(order.size() / kGrain + 1);
    RegionFinders finders([&] { return RegionFinder(occluders, options.method); });
    for_polygons(page, occluders, order, options.threads,
                 [&](std::size_t task, std::size_t begin, std::size_t end) {
                     if (meter.stopped()) return;
                     RegionTask(page, occluders, finders.local(), colors)
                         .run(std::span(order).subspan(begin, end - begin), tasks[task]);
                     meter.add(end - begin);
                 });
    drawing.regions.first_loop.assign(1, 0);
    drawing.regions.first_point.assign(1, 0);
    for (const TaskRegions& found : tasks)
        if (!found.shapes.first.empty()) append(page, found, drawing);
}

std::vector<FaceArea> find_areas(const ScreenScene& page, const Occluders& occluders,
                                 const TraceOptions& options, WorkMeter& meter) {
    std::vector<FaceArea> areas = begin_areas(page, options.threads);
    RegionFinders finders([&] { return RegionFinder(occluders, options.method); });
    // Polygons, so that the pieces of a clipped triangle are one thread's.
    const std::vector<std::uint32_t> order = by_polygon(page, occluders);
    for_polygons(page, occluders, order, options.threads,
                 [&](std::size_t, std::size_t begin, std::size_t end) {
                     if (meter.stopped()) return;
                     RegionFinder& finder = finders.local();
                     std::vector<BorderPiece> border;
                     for (std::size_t i = begin; i < end; ++i) {
                         const Occluder& o = occluders[order[i]];
                         border.clear();
                         finder.find(order[i], border);
                         // From a corner of the face, so that little is lost in the sum.
                         const glm::dvec2 origin(o.p.x, o.p.y);
                         double doubled = 0;
                         for (const BorderPiece& piece : border)
                             doubled += cross(piece.exact_from - origin, piece.exact_to - origin);
                         areas[o.id].projected +=
                             0.5 *
                             static_cast<double>(side(o.p.x, o.p.y, o.q.x, o.q.y, o.r.x, o.r.y));
                         areas[o.id].visible += 0.5 * doubled;
                     }
                     meter.add(end - begin);
                 });
    return areas;
}

}  // namespace sightline
