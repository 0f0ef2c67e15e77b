// One pass of the floating horizon over a slab of a view, from front to back.
//
// Between two rows lies a strip of cells, two triangles each. A line of sight comes in through the
// near row or from the cell beside, and leaves through the far row or into the cell on the other
// side. So cells are taken in the order in which lines of sight pass them, away from the eye, and
// when an edge is looked at, the horizon has all that is in front of it and nothing else: then it
// is seen where it is above the upper horizon or below the lower one. What is highest between two
// rows lies on an edge of a triangle, hence the diagonals, which are never drawn, raise the horizon
// too.
//
// Of several surfaces each has horizons of its own. A part of one is seen when no surface hides it;
// those that cross it do so where their horizons pass it.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "drawing/curve_runs.hpp"
#include "drawing/horizon_view.hpp"
#include "drawing/skyline.hpp"
#include "drawing/work_meter.hpp"
#include "sightline/plot.hpp"

namespace sightline {

/// What is the same for all slabs.
struct HorizonPlan {
    const HeightGrid& grid;
    const PlotOptions& options;
    /// Of the curve along each row and column of the grid, rows first.
    std::vector<std::uint32_t> row_numbers, column_numbers;
    /// By layer and edge, which ones have a cut; empty where the layer has none.
    std::vector<std::vector<bool>> has_cut;
    glm::dvec3 light;  ///< towards it

    HorizonPlan(const HeightGrid& g, const Camera& camera, const PlotOptions& o);
};

class HorizonSweep {
public:
    /// The slab from..to of u.
    HorizonSweep(const HorizonPlan& plan, const HorizonView& view, double from, double to);

    void run(WorkMeter& meter);
    [[nodiscard]] double from() const { return from_; }
    [[nodiscard]] double to() const { return to_; }
    /// Units of work for the meter.
    [[nodiscard]] std::uint64_t work() const { return view_.rows().size(); }
    /// The parts of a line behind everything that are seen, within the slab.
    void see_behind(const Slope& line, std::vector<Seen>& out);

    DrawnLines lines;

private:
    /// A row with its nodes, as far as the slab needs them.
    struct Row {
        std::size_t index = 0;  // in the grid
        double depth = 0;
        std::vector<double> u;
        std::vector<std::vector<double>> v;  // by layer
    };
    enum class Exits { left, right, both };
    /// An edge as it is met with: from its node at the left, or in front.
    struct Edge {
        std::uint64_t number;            // of the grid
        bool reversed;                   // the grid counts it the other way round
        std::array<glm::dvec2, 2> plan;  // (across, depth) of its ends
        std::array<glm::dvec2, 2> seen;  // (u, v)
    };
    /// A corner of a piece of a cell, (u, v) and (across, depth).
    struct Corner {
        glm::dvec2 seen, plan;
    };
    /// The parts of an edge that there are: from its first node to `end0`, and from `end1` to its
    /// second one; of a whole edge the first part is all of it.
    struct Parts {
        bool has0 = false, has1 = false, whole = false;
        Corner end0, end1;
    };
    struct Part {
        glm::dvec2 from, to;
    };
    using Patch = std::vector<Corner>;
    /// The curve that an edge is a part of.
    struct Curve {
        LineUse use = LineUse::none;
        std::uint32_t number = 0;
        CurveRun* runs = nullptr;  // one for each layer
        bool backwards = false;    // its edges come from right to left
    };

    void set_row(Row& row, std::size_t index, std::size_t first, std::size_t last) const;
    [[nodiscard]] std::array<std::size_t, 2> columns(const Row& a, const Row& b) const;
    void draw_front_row();
    void strip(std::size_t first, std::size_t last);
    void cell(std::size_t column, Exits exits);
    [[nodiscard]] bool is_upright_column(std::size_t column) const;
    /// Where two slabs meet it is the right one's.
    [[nodiscard]] bool owns(double u) const { return u >= from_ && (u < to_ || to_ == view_.to()); }

    [[nodiscard]] std::size_t node(std::size_t column, std::size_t row) const {
        return column * column_stride_ + row * row_stride_;
    }
    [[nodiscard]] Edge across_edge(std::size_t layer, std::size_t column, const Row& row) const;
    [[nodiscard]] Edge depth_edge(std::size_t layer, std::size_t column) const;
    [[nodiscard]] bool is_whole(std::size_t layer, const Edge& edge) const;
    [[nodiscard]] Parts parts_of(std::size_t layer, const Edge& edge) const;
    /// From left to right, or straight up from front to back.
    [[nodiscard]] Slope line_of(const Part& part) const {
        if (skylines_[0].is_upright({part.from.x, part.to.x}))
            return {part.from.x, part.from.y, part.to.x, part.to.y};
        return slope_of(part.from, part.to);
    }
    /// Calls what(part) for each.
    template <class What>
    void each_part(std::size_t layer, const Edge& edge, const What& what) const;

    void inside(std::size_t layer, std::size_t column);
    void broken_inside(std::size_t layer, std::size_t column);
    void put_patch(std::size_t layer, const Patch& patch);

    void pass_row(std::size_t column, const Row& row, bool backwards);
    void pass_column(std::size_t column);
    /// Looks at one edge of every layer and lets it hide. `make(layer)` gives the edge.
    template <class Make>
    void pass(const Make& make, const Curve& curve);
    template <class Make>
    void pass_together(const Make& make, const Curve& curve);
    template <class Make>
    void others_hide(std::size_t layer, const Slope& line, std::vector<Seen>& seen,
                     const Make& make);
    void keep_common(std::vector<Seen>& seen);
    void put(std::size_t layer, const Edge& edge, const Part& part, const Curve& curve,
             const std::vector<Seen>& seen);
    void put_part(const Part& part, double t0, double t1, const CurveStyle& style,
                  const Curve& curve, CurveRun& run);
    [[nodiscard]] bool is_in_shade(std::size_t layer, const Edge& edge, LineUse use) const;

    const HorizonPlan& plan_;
    const HorizonView& view_;
    double from_, to_;
    std::size_t column_stride_, row_stride_;
    Row near_, far_;
    std::vector<Skyline> skylines_;      // by layer
    std::vector<CurveRun> row_runs_;     // by layer
    std::vector<CurveRun> column_runs_;  // by column and layer
    std::vector<Seen> seen_, other_, both_;
    std::vector<std::vector<Seen>> seen_of_;  // by layer and part, of the edge that is looked at
    std::vector<Patch> patches_;
};

}  // namespace sightline
