#include "drawing/faces.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "drawing/polygon_tasks.hpp"
#include "drawing/region_loops.hpp"
#include "shading/lighting.hpp"
#include "shading/surface.hpp"

namespace sightline {
namespace {

constexpr glm::vec3 kFlatColor{0.7f, 0.7f, 0.7f};

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
    std::vector<Sliver> slivers;  // their regions are among the others
    DrawingCounts counts;
};

class RegionTask {
public:
    RegionTask(const ScreenScene& page, const Occluders& occluders, RegionFinder& finder,
               const FillColors& colors, std::span<std::uint8_t> seen)
        : page_(page), occluders_(occluders), finder_(finder), colors_(colors), seen_(seen) {}

    void run(std::span<const std::uint32_t> order, TaskRegions& found) {
        found.shapes.first.push_back(0);
        for (std::size_t i = 0; i < order.size(); ++i) {
            const std::size_t before = border_.size();
            count(finder_.find(order[i], border_), found.counts);
            sight_.add(occluders_[order[i]], std::span(border_).subspan(before));
            if (i + 1 < order.size() && polygon(order[i + 1]) == polygon(order[i])) continue;
            finish_polygon(occluders_[order[i]].id, found);
            sight_.clear();
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
        const std::uint32_t number = page_.scene().triangle_polygon[triangle];
        const bool sliver = sight_.is_sliver();
        Sliver kept{number, kNone, {}};
        if (sliver) kept.border = border_;
        const std::size_t before = found.shapes.first.size();
        join_loops(border_, found.shapes);
        if (found.shapes.first.size() == before) return;
        if (sliver)
            found.slivers.push_back(std::move(kept));
        else
            seen_[number] = 1;
        found.triangle.push_back(triangle);
        found.color.push_back(colors_.of(triangle));
        found.loops.push_back(static_cast<std::uint32_t>(found.shapes.first.size() - before));
    }

    const ScreenScene& page_;
    const Occluders& occluders_;
    RegionFinder& finder_;
    const FillColors& colors_;
    std::span<std::uint8_t> seen_;
    FaceSight sight_;
    std::vector<BorderPiece> border_;
};

/// Puts the regions of all tasks into a drawing, slivers into the regions of their heirs.
class RegionWriter {
public:
    RegionWriter(const ScreenScene& page, std::span<const TaskRegions> tasks,
                 std::span<const Sliver> slivers, Drawing& drawing)
        : page_(page),
          tasks_(tasks),
          slivers_(slivers),
          drawing_(drawing),
          step_(std::ldexp(1.0, -page.subpixel_bits())) {}

    void write() {
        drawing_.regions.first_loop.assign(1, 0);
        drawing_.regions.first_point.assign(1, 0);
        for_regions(
            [&](const TaskRegions& task, std::size_t r, std::uint32_t polygon, std::size_t first) {
                const std::uint32_t heir = heir_of(polygon);
                if (heir == kNone) return;
                for (std::size_t l = first; l < first + task.loops[r]; ++l)
                    inherited_.push_back({heir, loop(task, l)});
            });
        std::ranges::stable_sort(inherited_, {}, &Inherited::heir);
        for_regions(
            [&](const TaskRegions& task, std::size_t r, std::uint32_t polygon, std::size_t first) {
                if (heir_of(polygon) == kNone) add_region(task, r, polygon, first);
            });
        for (const TaskRegions& task : tasks_) {
            drawing_.counts.faces_whole += task.counts.faces_whole;
            drawing_.counts.faces_partly += task.counts.faces_partly;
            drawing_.counts.faces_hidden += task.counts.faces_hidden;
        }
    }

private:
    using Loop = std::span<const glm::ivec2>;
    struct Inherited {
        std::uint32_t heir;
        Loop loop;
    };

    /// visit(task, region, its polygon, its first loop).
    template <class Visit>
    void for_regions(const Visit& visit) const {
        for (const TaskRegions& task : tasks_) {
            std::size_t first = 0;
            for (std::size_t r = 0; r < task.triangle.size(); first += task.loops[r++])
                visit(task, r, page_.scene().triangle_polygon[task.triangle[r]], first);
        }
    }
    static Loop loop(const TaskRegions& task, std::size_t l) {
        const std::uint32_t first = task.shapes.first[l];
        return Loop(task.shapes.points).subspan(first, task.shapes.first[l + 1] - first);
    }
    [[nodiscard]] std::uint32_t heir_of(std::uint32_t polygon) const {
        const auto at = std::ranges::lower_bound(slivers_, polygon, {}, &Sliver::polygon);
        return at != slivers_.end() && at->polygon == polygon ? at->heir : kNone;
    }
    void add_region(const TaskRegions& task, std::size_t r, std::uint32_t polygon,
                    std::size_t first) {
        DrawnRegions& all = drawing_.regions;
        for (std::size_t l = first; l < first + task.loops[r]; ++l) add_loop(loop(task, l));
        auto more = std::ranges::lower_bound(inherited_, polygon, {}, &Inherited::heir);
        for (; more != inherited_.end() && more->heir == polygon; ++more) add_loop(more->loop);
        all.polygon.push_back(polygon);
        all.object.push_back(page_.scene().object_of(task.triangle[r]));
        all.color.push_back(task.color[r]);
        all.first_loop.push_back(static_cast<std::uint32_t>(all.first_point.size() - 1));
    }
    void add_loop(Loop loop) {
        DrawnRegions& all = drawing_.regions;
        for (const glm::ivec2& p : loop) all.points.push_back(step_ * glm::dvec2(p));
        all.first_point.push_back(static_cast<std::uint32_t>(all.points.size()));
    }

    const ScreenScene& page_;
    std::span<const TaskRegions> tasks_;
    std::span<const Sliver> slivers_;
    Drawing& drawing_;
    double step_;
    std::vector<Inherited> inherited_;  // by heir
};

}  // namespace

void append_regions(const ScreenScene& page, const Occluders& occluders,
                    const TraceOptions& options, WorkMeter& meter, Drawing& drawing) {
    const FillColors colors(page, options.fill);
    const std::vector<std::uint32_t> order = by_polygon(page, occluders);
    std::vector<TaskRegions> tasks(order.size() / kFaceGrain + 1);
    std::vector<std::uint8_t> seen = nothing_seen(page.scene());
    RegionFinders finders([&] { return RegionFinder(occluders, options.method); });
    for_polygons(page, occluders, order, options.threads,
                 [&](std::size_t task, std::size_t begin, std::size_t end) {
                     if (meter.stopped()) return;
                     RegionTask(page, occluders, finders.local(), colors, seen)
                         .run(std::span(order).subspan(begin, end - begin), tasks[task]);
                     meter.add(end - begin);
                 });
    std::vector<Sliver> slivers;
    for (TaskRegions& task : tasks) std::ranges::move(task.slivers, std::back_inserter(slivers));
    find_heirs(page, occluders, seen, slivers, options.threads);
    RegionWriter(page, tasks, slivers, drawing).write();
}

}  // namespace sightline
