// The floating horizon in object space.
//
// Sources: those of horizon.hpp; D. P. Anderson, "Hidden line elimination in projected grid
// surfaces", ACM Transactions on Graphics 1 (1982), 274-288, for the order of cells; the version on
// arrays is that of Rogers, "Procedural Elements for Computer Graphics", chapter 4.
//
// How we differ: the textbook draws curves at constant depth and lets curves alone hide, on an
// array of heights. Here
//   - horizons are piecewise linear functions without a resolution (horizon.hpp),
//   - all of the surface hides, also between the curves that are drawn (horizon_sweep.hpp),
//   - any view is turned into one from straight ahead (horizon_view.hpp), and
//   - gaps and jumps can be looked through (horizon_cells.cpp).
// A view is swept in slabs, side by side, which do not depend on each other.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "drawing/horizon_sweep.hpp"
#include "math/arena.hpp"
#include "sightline/scene.hpp"

namespace sightline {
namespace {

/// Slabs of a view. A constant, lest the bytes depend on the number of threads.
constexpr std::size_t kSlabs = 16;
/// Rows on both sides of an eye over the grid, this share of the grid's size away from it.
constexpr double kBesideEye = 1e-6;

struct ViewSweeps {
    std::unique_ptr<HorizonView> view;
    std::vector<std::unique_ptr<HorizonSweep>> slabs;  // none where there is nothing to see
};

/// Plans for views whose depth grows along x, and along z.
std::vector<ViewSweeps> plan_sweeps(const HorizonPlan& for_x, const HorizonPlan& for_z,
                                    const Camera& camera) {
    std::vector<ViewSweeps> sweeps;
    for (HorizonView& view : HorizonView::all(for_x.grid, for_z.grid, camera)) {
        ViewSweeps one;
        one.view = std::make_unique<HorizonView>(std::move(view));
        const HorizonPlan& plan = one.view->along_x() ? for_x : for_z;
        const double from = one.view->from(), width = one.view->to() - from;
        for (std::size_t k = 0; k < kSlabs && width > 0; ++k) {
            const auto bound = [&](std::size_t n) {
                return n == kSlabs ? one.view->to()
                                   : from + width * static_cast<double>(n) / double{kSlabs};
            };
            one.slabs.push_back(
                std::make_unique<HorizonSweep>(plan, *one.view, bound(k), bound(k + 1)));
        }
        sweeps.push_back(std::move(one));
    }
    return sweeps;
}

// -- an eye over the grid -------------------------------------------------------------------------

/// Where new nodes are wanted so that the strip in which the eye is becomes very narrow. Only its
/// cells near the eye belong to the views that need it, and only there the surface is another: flat
/// across a diagonal that it is bent along.
std::vector<double> nodes_beside(const std::vector<double>& nodes, double eye) {
    const double size = nodes.back() - nodes.front();
    std::vector<double> out;
    for (const double node : {eye - kBesideEye * size, eye + kBesideEye * size}) {
        if (node > nodes.front() && node < nodes.back() &&
            !std::binary_search(nodes.begin(), nodes.end(), node))
            out.push_back(node);
    }
    return out;
}

/// The eye's distance from the grid's rectangle, in cells.
bool is_near(const HeightGrid& grid, glm::dvec3 eye) {
    const auto cells_off = [](const std::vector<double>& nodes, double at) {
        const double cell = (nodes.back() - nodes.front()) / static_cast<double>(nodes.size() - 1);
        return std::max({nodes.front() - at, at - nodes.back(), 0.0}) / cell;
    };
    return cells_off(grid.x, eye.x) < 4 && cells_off(grid.z, eye.z) < 4;
}

struct Refined {
    std::vector<double> nodes;
    std::vector<LineUse> use;
    std::vector<std::size_t> cell;  // of each node, the old one that it begins or lies in
};

Refined refined(const std::vector<double>& nodes, const std::vector<LineUse>& use, double eye) {
    const std::vector<double> added = nodes_beside(nodes, eye);
    Refined out;
    std::size_t next = 0;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        out.nodes.push_back(nodes[k]);
        out.use.push_back(use[k]);
        out.cell.push_back(k);
        while (k + 1 < nodes.size() && next < added.size() && added[next] < nodes[k + 1]) {
            out.nodes.push_back(added[next++]);
            out.use.push_back(LineUse::none);
            out.cell.push_back(k);
        }
    }
    return out;
}

/// The same surfaces with more columns, or more rows; cuts of the edges that get a node are lost.
HeightGrid with_nodes_beside(const HeightGrid& grid, glm::dvec3 eye, bool in_x) {
    const Refined x = refined(grid.x, grid.column_use, in_x ? eye.x : INFINITY),
                  z = refined(grid.z, grid.row_use, in_x ? INFINITY : eye.z);
    HeightGrid out{x.nodes, z.nodes, x.use, z.use, {}};
    const std::size_t columns = grid.x.size();
    for (const HeightLayer& layer : grid.layers) {
        HeightLayer finer;
        finer.open_gaps = layer.open_gaps;
        const auto old = [&](std::size_t i, std::size_t k) { return layer.y[k * columns + i]; };
        for (std::size_t k = 0; k < z.nodes.size(); ++k) {
            const std::size_t r = z.cell[k];
            const double t = z.nodes[k] == grid.z[r]
                                 ? 0
                                 : (z.nodes[k] - grid.z[r]) / (grid.z[r + 1] - grid.z[r]);
            for (std::size_t i = 0; i < x.nodes.size(); ++i) {
                const std::size_t c = x.cell[i];
                const double s = x.nodes[i] == grid.x[c]
                                     ? 0
                                     : (x.nodes[i] - grid.x[c]) / (grid.x[c + 1] - grid.x[c]);
                double y = old(c, r);  // on the triangle of the cell
                if (s > 0 && s >= t) y += s * (old(c + 1, r) - old(c, r));
                if (t > 0 && t > s) y += t * (old(c, r + 1) - old(c, r));
                if (s > 0 && t > 0) {
                    y += s >= t ? t * (old(c + 1, r + 1) - old(c + 1, r))
                                : s * (old(c + 1, r + 1) - old(c, r + 1));
                }
                finer.y.push_back(y);
            }
        }
        for (Cut cut : layer.cuts) {
            const std::size_t node = cut.edge / 2, i = node % columns, k = node / columns;
            const auto at_x = static_cast<std::size_t>(
                std::lower_bound(x.nodes.begin(), x.nodes.end(), grid.x[i]) - x.nodes.begin());
            const auto at_z = static_cast<std::size_t>(
                std::lower_bound(z.nodes.begin(), z.nodes.end(), grid.z[k]) - z.nodes.begin());
            const bool along_z = cut.edge % 2 != 0;
            if (along_z ? z.nodes[at_z + 1] != grid.z[k + 1] : x.nodes[at_x + 1] != grid.x[i + 1])
                continue;
            cut.edge = along_z ? out.edge_along_z(at_x, at_z) : out.edge_along_x(at_x, at_z);
            finer.cuts.push_back(cut);
        }
        out.layers.push_back(std::move(finer));
    }
    return out;
}

// -- the box of axes ------------------------------------------------------------------------------

/// Whether the surfaces lie behind a line beside the grid: it is on the side of the viewer.
bool is_in_front(const HeightGrid& grid, const HorizonView& view, const AxisLine& line) {
    const glm::dvec3 a = view.local(line[0]), b = view.local(line[1]);
    const glm::dvec2 middle = 0.5 * glm::dvec2(a.x + b.x, a.z + b.z);
    const glm::dvec3 corner0 = view.local({grid.x.front(), 0, grid.z.front()}),
                     corner1 = view.local({grid.x.back(), 0, grid.z.back()});
    const glm::dvec2 low =
                         glm::dvec2(std::min(corner0.x, corner1.x), std::min(corner0.z, corner1.z)),
                     high =
                         glm::dvec2(std::max(corner0.x, corner1.x), std::max(corner0.z, corner1.z));
    const glm::dvec2 sight = view.sight(middle);
    // It is beyond a side that lines of sight come in through, and beyond none that they leave by.
    const glm::dvec2 slack = 1e-9 * (high - low);
    bool front = false;
    for (int k = 0; k < 2; ++k) {
        const bool below = middle[k] <= low[k] + slack[k], above = middle[k] >= high[k] - slack[k];
        if ((below && sight[k] < 0) || (above && sight[k] > 0)) return false;
        front = front || (below && sight[k] > 0) || (above && sight[k] < 0);
    }
    return front;
}

class AxisPainter {
public:
    AxisPainter(const HeightGrid& grid, const PlotOptions& options, DrawnLines& out)
        : grid_(grid), options_(options), out_(out) {}

    void draw(const AxisLine& line, std::uint32_t number, std::vector<ViewSweeps>& sweeps) {
        style_ = {EdgeKind::axis, true, static_cast<std::uint32_t>(grid_.layers.size()), number};
        for (ViewSweeps& sweep : sweeps) {
            const auto seen = sweep.view->seen_line(line);
            if (!seen) continue;
            draw_in(sweep, line, (*seen)[0], (*seen)[1]);
        }
        run_.flush(0, out_);
    }

private:
    /// By the slabs that it passes, from its left to its right end.
    void draw_in(ViewSweeps& sweep, const AxisLine& line, glm::dvec2 a, glm::dvec2 b) {
        const Slope slope = slope_of(a, b);
        const HorizonView& view = *sweep.view;
        if (sweep.slabs.empty() || is_in_front(grid_, view, line)) {
            return put(view, slope, 0, 1, true);
        }
        const double width = slope.u1 - slope.u0;
        double last = 0;  // how far it is drawn
        for (const auto& slab : sweep.slabs) {
            const double from = std::max(slab->from(), slope.u0),
                         to = std::min(slab->to(), slope.u1);
            if (!(from < to) && !(width == 0 && from == to && last == 0)) continue;
            const double t0 = width > 0 ? (from - slope.u0) / width : 0,
                         t1 = width > 0 ? (to - slope.u0) / width : 1;
            put(view, slope, last, t0, true);  // beside everything
            slab->see_behind(slope, seen_);
            last = t0;
            for (const Seen& part : seen_) {
                put(view, slope, last, part.t0, false);
                put(view, slope, std::max(part.t0, last), std::min(part.t1, t1), true);
                last = std::max(last, std::min(part.t1, t1));
            }
            put(view, slope, last, t1, false);
            last = t1;
        }
        put(view, slope, last, 1, true);
    }

    void put(const HorizonView& view, const Slope& line, double t0, double t1, bool visible) {
        if (!(t0 < t1) || (!visible && !options_.hidden)) return;
        const auto at = [&](double t) {
            return t <= 0   ? glm::dvec2(line.u0, line.v0)
                   : t >= 1 ? glm::dvec2(line.u1, line.v1)
                            : glm::dvec2(line.u0 + t * (line.u1 - line.u0),
                                         line.v0 + t * (line.v1 - line.v0));
        };
        const auto page = view.on_page(at(t0), at(t1));
        if (!page) return;
        style_.visible = visible;
        run_.add((*page)[0], (*page)[1], style_, 0, out_);
    }

    const HeightGrid& grid_;
    const PlotOptions& options_;
    DrawnLines& out_;
    CurveStyle style_;
    CurveRun run_;
    std::vector<Seen> seen_;
};

// -- everything -----------------------------------------------------------------------------------

Result<Drawing> sweep_all(const HeightGrid& for_x, const HeightGrid& for_z, const Camera& camera,
                          const PlotOptions& options, const std::vector<AxisLine>& axes) {
    const HorizonPlan plan_x(for_x, camera, options), plan_z(for_z, camera, options);
    std::vector<ViewSweeps> sweeps = plan_sweeps(plan_x, plan_z, camera);
    std::vector<HorizonSweep*> jobs;
    WorkMeter meter(options.progress);
    std::uint64_t work = 0;
    for (const ViewSweeps& sweep : sweeps) {
        for (const auto& slab : sweep.slabs) {
            jobs.push_back(slab.get());
            work += slab->work();
        }
    }
    meter.expect(work);
    in_arena(options.threads, [&] {
        tbb::parallel_for(std::size_t{0}, jobs.size(), [&](std::size_t k) { jobs[k]->run(meter); });
    });
    meter.finish();
    if (meter.stopped()) return Error{ErrorKind::cancelled, "stopped"};
    Drawing drawing;
    drawing.resolution = camera.resolution;
    for (const HorizonSweep* job : jobs) append(drawing.lines, job->lines);
    AxisPainter painter(for_x, options, drawing.lines);
    for (std::size_t k = 0; k < axes.size(); ++k)
        painter.draw(axes[k], static_cast<std::uint32_t>(k), sweeps);
    count_lengths(drawing.lines, drawing.counts);
    return drawing;
}

}  // namespace

Box HeightGrid::bounds() const {
    Box box;
    for (const HeightLayer& layer : layers) {
        for (const double height : layer.y) {
            if (!std::isfinite(height)) continue;
            if (box.empty()) {
                box.lo = {x.front(), height, z.front()};
                box.hi = {x.back(), height, z.back()};
            }
            box.lo.y = std::min(box.lo.y, height);
            box.hi.y = std::max(box.hi.y, height);
        }
    }
    return box;
}

Result<Drawing> floating_horizon(const HeightGrid& grid, const Camera& camera,
                                 const PlotOptions& options, const std::vector<AxisLine>& axes) {
    if (camera.is_perspective() && is_near(grid, camera.eye))
        return sweep_all(with_nodes_beside(grid, camera.eye, true),
                         with_nodes_beside(grid, camera.eye, false), camera, options, axes);
    return sweep_all(grid, grid, camera, options, axes);
}

}  // namespace sightline
