#include "drawing/horizon_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "math/elementary.hpp"
#include "sightline/scene.hpp"

namespace sightline {
namespace {

constexpr std::size_t kRowsBetweenNotes = 4;

std::vector<std::uint32_t> numbers(const std::vector<LineUse>& uses, std::uint32_t& next) {
    std::vector<std::uint32_t> out(uses.size(), kNone);
    for (std::size_t k = 0; k < uses.size(); ++k)
        if (uses[k] != LineUse::none) out[k] = next++;
    return out;
}

glm::dvec2 between(glm::dvec2 a, glm::dvec2 b, double t) {
    if (t <= 0) return a;
    if (t >= 1) return b;
    return a + t * (b - a);
}

}  // namespace

HorizonPlan::HorizonPlan(const HeightGrid& g, const Camera& camera, const PlotOptions& o)
    : grid(g), options(o) {
    std::uint32_t next = 0;
    row_numbers = numbers(grid.row_use, next);
    column_numbers = numbers(grid.column_use, next);
    for (const HeightLayer& layer : grid.layers) {
        std::vector<bool> marks;
        if (!layer.cuts.empty()) marks.resize(2 * layer.y.size(), false);
        for (const Cut& cut : layer.cuts) marks[cut.edge] = true;
        has_cut.push_back(std::move(marks));
    }
    // From above, from the left of the viewer and from behind him.
    light = glm::normalize(glm::dvec3(0, 0.8, 0) - 0.6 * camera.right + 0.35 * camera.back);
}

HorizonSweep::HorizonSweep(const HorizonPlan& plan, const HorizonView& view, double from, double to)
    : plan_(plan), view_(view), from_(from), to_(to) {
    const std::size_t columns = plan.grid.x.size(), layers = plan.grid.layers.size();
    column_stride_ = view.along_x() ? columns : 1;
    row_stride_ = view.along_x() ? 1 : columns;
    const std::size_t nodes = view.across().size();
    for (Row* row : {&near_, &far_}) {
        row->u.resize(nodes);
        row->v.assign(layers, std::vector<double>(nodes));
    }
    for (std::size_t l = 0; l < layers; ++l) skylines_.emplace_back(from, to);
    row_runs_.resize(layers);
    column_runs_.resize(layers * nodes);
    seen_of_.resize(2 * layers);
}

// -- order ----------------------------------------------------------------------------------------

void HorizonSweep::run(WorkMeter& meter) {
    const std::vector<std::size_t>& rows = view_.rows();
    for (std::size_t k = 0; k + 1 < rows.size() && !meter.stopped(); ++k) {
        near_.index = rows[k];
        near_.depth = view_.depth_of_row(rows[k]);
        far_.index = rows[k + 1];
        far_.depth = view_.depth_of_row(rows[k + 1]);
        const auto [first, last] = columns(near_, far_);
        if (first < last) {
            set_row(near_, near_.index, first, last);
            set_row(far_, far_.index, first, last);
            if (k == 0)
                for (std::size_t c = first; c < last; ++c) pass_row(c, near_, false);
            strip(first, last);
        }
        for (CurveRun& run : row_runs_) run.flush(plan_.options.tolerance, lines);
        if (k % kRowsBetweenNotes == 0)
            for (Skyline& skyline : skylines_) skyline.note_heights();
        if (k % 16 == 0) meter.add(16);
    }
    for (CurveRun& run : column_runs_) run.flush(plan_.options.tolerance, lines);
    column_runs_ = {};
}

/// First and last column of the cells that reach into the slab between two rows.
std::array<std::size_t, 2> HorizonSweep::columns(const Row& a, const Row& b) const {
    const std::vector<double>& across = view_.across();
    const double low = std::min(view_.across_at(from_, a.depth), view_.across_at(from_, b.depth));
    const double high = std::max(view_.across_at(to_, a.depth), view_.across_at(to_, b.depth));
    const auto first = std::upper_bound(across.begin(), across.end(), low) - across.begin();
    const auto last = std::lower_bound(across.begin(), across.end(), high) - across.begin();
    const auto end = static_cast<std::ptrdiff_t>(across.size()) - 1;
    // One more on either side, for what rounding does to the bounds.
    return {static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(first - 2, 0, end)),
            static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(last + 1, 0, end))};
}

void HorizonSweep::set_row(Row& row, std::size_t index, std::size_t first, std::size_t last) const {
    const std::vector<double>& across = view_.across();
    for (std::size_t c = first; c <= last; ++c) row.u[c] = view_.seen({across[c], 0, row.depth}).x;
    for (std::size_t l = 0; l < row.v.size(); ++l) {
        const std::vector<double>& y = plan_.grid.layers[l].y;
        for (std::size_t c = first; c <= last; ++c) {
            const double height = view_.local_height(y[node(c, index)]);
            row.v[l][c] = view_.seen({across[c], height, row.depth}).y;
        }
    }
}

void HorizonSweep::strip(std::size_t first, std::size_t last) {
    const std::vector<double>& across = view_.across();
    for (std::size_t c = first; c <= last; ++c)
        if (is_upright_column(c) && owns(near_.u[c])) pass_column(c);
    // Lines of sight go to the right from this column on.
    std::size_t middle = view_.sight({0, 1}).x >= 0 ? first : last;
    if (view_.is_perspective()) {
        const auto after = std::upper_bound(across.begin(), across.end(), 0.0) - across.begin();
        middle = std::clamp(static_cast<std::size_t>(after), first, last);
        if (middle > first && across[middle] > 0) {  // the eye is between two columns
            cell(middle - 1, Exits::both);
            for (std::size_t c = middle; c < last; ++c) cell(c, Exits::right);
            for (std::size_t c = middle - 1; c > first; --c) cell(c - 1, Exits::left);
            return;
        }
    }
    if (!is_upright_column(middle)) pass_column(middle);
    for (std::size_t c = middle; c < last; ++c) cell(c, Exits::right);
    for (std::size_t c = middle; c > first; --c) cell(c - 1, Exits::left);
}

void HorizonSweep::cell(std::size_t column, Exits exits) {
    if (!plan_.options.ridges) {
        for (std::size_t l = 0; l < skylines_.size(); ++l) inside(l, column);
        if (exits != Exits::left && !is_upright_column(column + 1)) pass_column(column + 1);
        if (exits != Exits::right && !is_upright_column(column)) pass_column(column);
    }
    pass_row(column, far_, exits == Exits::left);
}

/// Lines of sight run along it. It is looked at before the cells beside it, whose diagonals reach
/// its far end.
bool HorizonSweep::is_upright_column(std::size_t column) const {
    return skylines_[0].is_upright({near_.u[column], far_.u[column]});
}

// -- edges ----------------------------------------------------------------------------------------

HorizonSweep::Edge HorizonSweep::across_edge(std::size_t layer, std::size_t column,
                                             const Row& row) const {
    const std::vector<double>& across = view_.across();
    const HeightGrid& grid = plan_.grid;
    const std::vector<double>& v = row.v[layer];
    return {view_.along_x() ? grid.edge_along_z(row.index, column)
                            : grid.edge_along_x(column, row.index),
            false,
            {glm::dvec2(across[column], row.depth), glm::dvec2(across[column + 1], row.depth)},
            {glm::dvec2(row.u[column], v[column]), glm::dvec2(row.u[column + 1], v[column + 1])}};
}

HorizonSweep::Edge HorizonSweep::depth_edge(std::size_t layer, std::size_t column) const {
    const double across = view_.across()[column];
    const HeightGrid& grid = plan_.grid;
    const std::size_t lower = std::min(near_.index, far_.index);
    return {view_.along_x() ? grid.edge_along_x(lower, column) : grid.edge_along_z(column, lower),
            !view_.forward(),
            {glm::dvec2(across, near_.depth), glm::dvec2(across, far_.depth)},
            {glm::dvec2(near_.u[column], near_.v[layer][column]),
             glm::dvec2(far_.u[column], far_.v[layer][column])}};
}

bool HorizonSweep::is_whole(std::size_t layer, const Edge& edge) const {
    return !std::isnan(edge.seen[0].y) && !std::isnan(edge.seen[1].y) &&
           (plan_.has_cut[layer].empty() || !plan_.has_cut[layer][edge.number]);
}

HorizonSweep::Parts HorizonSweep::parts_of(std::size_t layer, const Edge& edge) const {
    Parts parts;
    const bool has0 = !std::isnan(edge.seen[0].y), has1 = !std::isnan(edge.seen[1].y);
    parts.end0 = {edge.seen[0], edge.plan[0]};
    parts.end1 = {edge.seen[1], edge.plan[1]};
    parts.has0 = has0;
    parts.has1 = has1;
    if (plan_.has_cut[layer].empty() || !plan_.has_cut[layer][edge.number]) {
        parts.whole = has0 && has1;
        return parts;
    }
    const std::vector<Cut>& cuts = plan_.grid.layers[layer].cuts;
    Cut cut = *std::ranges::lower_bound(cuts, edge.number, {}, &Cut::edge);
    if (edge.reversed) cut = {cut.edge, 1 - cut.end1, 1 - cut.end0, cut.y1, cut.y0};
    const auto at = [&](double share, double y) {
        const glm::dvec2 plan = between(edge.plan[0], edge.plan[1], share);
        return Corner{view_.seen({plan.x, view_.local_height(y), plan.y}), plan};
    };
    if (has0) parts.end0 = at(cut.end0, cut.y0);
    if (has1) parts.end1 = at(cut.end1, cut.y1);
    return parts;
}

template <class What>
void HorizonSweep::each_part(std::size_t layer, const Edge& edge, const What& what) const {
    if (is_whole(layer, edge)) return what(Part{edge.seen[0], edge.seen[1]});
    const Parts parts = parts_of(layer, edge);
    if (parts.has0 && parts.end0.seen != edge.seen[0]) what(Part{edge.seen[0], parts.end0.seen});
    if (parts.has1 && parts.end1.seen != edge.seen[1]) what(Part{parts.end1.seen, edge.seen[1]});
}

void HorizonSweep::pass_row(std::size_t column, const Row& row, bool backwards) {
    const HeightGrid& grid = plan_.grid;
    const LineUse use = (view_.along_x() ? grid.column_use : grid.row_use)[row.index];
    if (plan_.options.ridges && use == LineUse::none) return;
    const std::uint32_t number =
        (view_.along_x() ? plan_.column_numbers : plan_.row_numbers)[row.index];
    pass([&](std::size_t layer) { return across_edge(layer, column, row); },
         {use, number, row_runs_.data(), backwards});
}

void HorizonSweep::pass_column(std::size_t column) {
    if (plan_.options.ridges) return;
    const HeightGrid& grid = plan_.grid;
    const LineUse use = (view_.along_x() ? grid.row_use : grid.column_use)[column];
    const std::uint32_t number =
        (view_.along_x() ? plan_.row_numbers : plan_.column_numbers)[column];
    pass([&](std::size_t layer) { return depth_edge(layer, column); },
         {use, number, column_runs_.data() + column * skylines_.size(), false});
}

/// Looks at the parts of an edge of every layer, and lets them hide.
template <class Make>
void HorizonSweep::pass(const Make& make, const Curve& curve) {
    if (skylines_.size() > 1) return pass_together(make, curve);
    const Edge edge = make(0);
    each_part(0, edge, [&](const Part& part) {
        if (curve.use == LineUse::none) return skylines_[0].raise(line_of(part));
        skylines_[0].see_and_raise(line_of(part), seen_);
        put(0, edge, part, curve, seen_);
    });
}

/// The edges of all layers lie in one vertical plane: whether a surface is in front of a point of
/// another one's edge is known when its own edge has raised its horizon. No edge hides itself.
template <class Make>
void HorizonSweep::pass_together(const Make& make, const Curve& curve) {
    const std::size_t layers = skylines_.size();
    if (curve.use != LineUse::none) {
        for (std::size_t l = 0; l < layers; ++l) {
            std::size_t k = 2 * l;
            each_part(l, make(l),
                      [&](const Part& part) { skylines_[l].see(line_of(part), seen_of_[k++]); });
        }
    }
    for (std::size_t l = 0; l < layers; ++l) {
        each_part(l, make(l), [&](const Part& part) { skylines_[l].raise(line_of(part)); });
    }
    if (curve.use == LineUse::none) return;
    for (std::size_t l = 0; l < layers; ++l) {
        std::size_t k = 2 * l;
        const Edge edge = make(l);
        each_part(l, edge, [&](const Part& part) {
            std::vector<Seen>& seen = seen_of_[k++];
            others_hide(l, line_of(part), seen, make);
            put(l, edge, part, curve, seen);
        });
    }
}

namespace {

/// Two edges that lines of sight run along, one above the other. What is seen over the horizon of
/// the other one's surface is seen only where it is over its edge, too; likewise what is under it.
void hide_beside(const Slope& own, const Slope& other, bool in_front, std::vector<Seen>& seen) {
    const double over0 = own.v0 - other.v0, over1 = own.v1 - other.v1;
    if (over0 == 0 && over1 == 0 && !in_front) return seen.clear();
    const double cross = over0 * over1 < 0 ? over0 / (over0 - over1) : 1;
    for (Seen& part : seen) {
        if (part.side == Side::either) continue;
        const bool before = part.side == Side::upper ? over0 > 0 || (over0 == 0 && over1 >= 0)
                                                     : over0 < 0 || (over0 == 0 && over1 <= 0);
        if (before) {
            part.t1 = std::min(part.t1, cross);
        } else {
            part.t0 = std::max(part.t0, cross);
        }
    }
    std::erase_if(seen, [](const Seen& part) { return !(part.t0 < part.t1); });
}

}  // namespace

/// Leaves of `seen` what no other layer hides.
template <class Make>
void HorizonSweep::others_hide(std::size_t layer, const Slope& line, std::vector<Seen>& seen,
                               const Make& make) {
    for (std::size_t l = 0; l < skylines_.size() && !seen.empty(); ++l) {
        if (l == layer) continue;
        // Of surfaces that coincide the first one is in front.
        skylines_[l].see(line, other_, l > layer ? Horizon::Ties::above : Horizon::Ties::below);
        if (skylines_[l].is_upright({line.u0, line.u1})) {
            const Edge other = make(l);
            if (is_whole(l, other))
                hide_beside(line, line_of({other.seen[0], other.seen[1]}), l > layer, other_);
        }
        keep_common(seen);
    }
}

/// Leaves of `seen` what is in other_, too.
void HorizonSweep::keep_common(std::vector<Seen>& seen) {
    both_.clear();
    for (const Seen& a : seen) {
        for (const Seen& b : other_) {
            const double t0 = std::max(a.t0, b.t0), t1 = std::min(a.t1, b.t1);
            if (t0 < t1) both_.push_back({t0, t1, a.side});
        }
    }
    seen.swap(both_);
}

// -- what is drawn --------------------------------------------------------------------------------

bool HorizonSweep::is_in_shade(std::size_t layer, const Edge& edge, LineUse use) const {
    const HeightGrid& grid = plan_.grid;
    const std::vector<double>& y = grid.layers[layer].y;
    const std::size_t columns = grid.x.size(), at = edge.number / 2;
    const std::size_t i = std::min(at % columns, columns - 2),
                      k = std::min(at / columns, grid.z.size() - 2);
    const std::size_t here = k * columns + i;
    const double along_x = (y[here + 1] - y[here]) / (grid.x[i + 1] - grid.x[i]);
    const double along_z = (y[here + columns] - y[here]) / (grid.z[k + 1] - grid.z[k]);
    if (std::isnan(along_x) || std::isnan(along_z)) return false;
    const double light = glm::dot(glm::normalize(glm::dvec3(-along_x, 1, -along_z)), plan_.light);
    return light < (use == LineUse::half_shade ? 0.6 : 0.3);
}

/// The parts of a curve that are seen, and where they are wanted those that are not.
void HorizonSweep::put(std::size_t layer, const Edge& edge, const Part& part, const Curve& curve,
                       const std::vector<Seen>& seen) {
    const bool hatch = curve.use != LineUse::curve;
    if (hatch && !is_in_shade(layer, edge, curve.use)) return;
    CurveRun& run = curve.runs[layer];
    const PlotSides sides = plan_.options.sides;
    CurveStyle style{EdgeKind::upper, true, static_cast<std::uint32_t>(layer), curve.number};
    // As parameters of the part, which may run the other way than the line that was looked at.
    const bool turned = line_of(part).u0 != part.from.x;
    const double width = std::abs(part.to.x - part.from.x), left = std::min(part.from.x, part.to.x);
    const double begin = width > 0 ? std::clamp((from_ - left) / width, 0.0, 1.0) : 0;
    const double end = width > 0 ? std::clamp((to_ - left) / width, 0.0, 1.0) : 1;
    const auto put_piece = [&](double t0, double t1, EdgeKind kind, bool visible) {
        if (!(t0 < t1) || (!visible && !plan_.options.hidden)) return;
        style.kind = hatch ? EdgeKind::hatch : kind;
        style.visible = visible;
        put_part(part, turned ? 1 - t1 : t0, turned ? 1 - t0 : t1, style, curve, run);
    };
    const auto put_seen = [&](const Seen& piece) {
        const bool lower =
            piece.side == Side::lower || (piece.side == Side::either && sides == PlotSides::lower);
        const bool wanted = sides == PlotSides::both || lower == (sides == PlotSides::lower);
        put_piece(piece.t0, piece.t1, lower ? EdgeKind::lower : EdgeKind::upper, wanted);
    };
    if (turned != curve.backwards) {
        double last = end;
        for (std::size_t k = seen.size(); k-- > 0;) {
            put_piece(seen[k].t1, last, EdgeKind::upper, false);
            put_seen(seen[k]);
            last = seen[k].t0;
        }
        put_piece(begin, last, EdgeKind::upper, false);
        return;
    }
    double last = begin;
    for (const Seen& piece : seen) {
        put_piece(last, piece.t0, EdgeKind::upper, false);
        put_seen(piece);
        last = piece.t1;
    }
    put_piece(last, end, EdgeKind::upper, false);
}

void HorizonSweep::put_part(const Part& part, double t0, double t1, const CurveStyle& style,
                            const Curve& curve, CurveRun& run) {
    glm::dvec2 a = between(part.from, part.to, t0), b = between(part.from, part.to, t1);
    if (curve.backwards) std::swap(a, b);
    const auto page = view_.on_page(a, b);
    if (page) run.add((*page)[0], (*page)[1], style, plan_.options.tolerance, lines);
}

void HorizonSweep::see_behind(const Slope& line, std::vector<Seen>& out) {
    skylines_[0].see(line, out);
    for (std::size_t l = 1; l < skylines_.size(); ++l) {
        skylines_[l].see(line, other_);
        keep_common(out);
    }
}

}  // namespace sightline
