// The floating horizon in image space, as the lecture notes and textbooks have it.
//
// Source: T. J. Wright, "A two-space solution to the hidden line problem for plotting functions of
// two variables", IEEE Transactions on Computers C-22 (1973), 28-33; Rogers, "Procedural Elements
// for Computer Graphics", chapter 4. Two arrays keep, for each column of the picture, how high and
// how low the curves have been so far; a curve is drawn where it is above the one or below the
// other.
//
// It is kept as it is, with its faults, to be compared with the exact one (floating_horizon.cpp):
// what happens between two columns is lost, so curves end up to a column too early or too late, and
// only curves hide, not the surface between them. We do mend what is a mistake and no property: the
// horizons begin beyond everything, and each is raised after a curve is drawn.
#include <algorithm>
#include <cmath>

#include "drawing/curve_runs.hpp"
#include "drawing/horizon_view.hpp"
#include "sightline/scene.hpp"

namespace sightline {
namespace {

constexpr double kMostColumns = 65536;

class ImageSpaceHorizon {
public:
    ImageSpaceHorizon(const HeightGrid& grid, const HorizonView& view, const PlotOptions& options,
                      DrawnLines& out)
        : grid_(grid), view_(view), options_(options), out_(out) {
        const double width = (view.to() - view.from()) * view.pixels_across();
        const auto columns =
            static_cast<std::size_t>(std::clamp(std::ceil(width), 2.0, kMostColumns));
        upper_.assign(columns, -INFINITY);
        lower_.assign(columns, INFINITY);
        heights_.resize(columns);
    }

    void run() {
        const std::vector<LineUse>& uses = view_.along_x() ? grid_.column_use : grid_.row_use;
        std::uint32_t number = 0;
        for (const std::size_t row : view_.rows()) {
            if (uses[row] != LineUse::curve) continue;
            for (std::size_t l = 0; l < grid_.layers.size(); ++l) {
                set_heights(l, row);
                draw(static_cast<std::uint32_t>(l), number);
            }
            ++number;
        }
    }

private:
    [[nodiscard]] double u_of(std::size_t column) const {
        const double t = static_cast<double>(column) / static_cast<double>(upper_.size() - 1);
        return view_.from() + t * (view_.to() - view_.from());
    }

    /// Of a curve in every column; NaN where there is none.
    void set_heights(std::size_t layer, std::size_t row) {
        const std::vector<double>& y = grid_.layers[layer].y;
        const std::vector<double>& across = view_.across();
        const double depth = view_.depth_of_row(row);
        const auto seen = [&](std::size_t i) {
            const std::size_t node =
                view_.along_x() ? i * grid_.x.size() + row : row * grid_.x.size() + i;
            return view_.seen({across[i], view_.local_height(y[node]), depth});
        };
        std::size_t cell = 0;
        for (std::size_t c = 0; c < heights_.size(); ++c) {
            const double u = u_of(c);
            while (cell + 2 < across.size() && seen(cell + 1).x < u) ++cell;
            const glm::dvec2 a = seen(cell), b = seen(cell + 1);
            const bool outside = u < a.x || u > b.x;
            heights_[c] = outside ? NAN : a.y + (u - a.x) / (b.x - a.x) * (b.y - a.y);
        }
    }

    void draw(std::uint32_t layer, std::uint32_t number) {
        CurveRun run;
        for (std::size_t c = 1; c < heights_.size(); ++c) {
            const double y = heights_[c], last = heights_[c - 1];
            if (std::isnan(y) || std::isnan(last)) continue;
            const bool above = y > upper_[c], below = y < lower_[c];
            const bool wanted = (above && options_.sides != PlotSides::lower) ||
                                (below && options_.sides != PlotSides::upper);
            if (!wanted && !options_.hidden) continue;
            const auto page = view_.on_page({u_of(c - 1), last}, {u_of(c), y});
            if (!page) continue;
            const bool first = above && below;
            const EdgeKind kind = above && !(first && options_.sides == PlotSides::lower)
                                      ? EdgeKind::upper
                                  : below ? EdgeKind::lower
                                          : EdgeKind::upper;
            run.add((*page)[0], (*page)[1], {kind, wanted, layer, number}, options_.tolerance,
                    out_);
        }
        run.flush(options_.tolerance, out_);
        for (std::size_t c = 0; c < heights_.size(); ++c) {
            if (std::isnan(heights_[c])) continue;
            upper_[c] = std::max(upper_[c], heights_[c]);
            lower_[c] = std::min(lower_[c], heights_[c]);
        }
    }

    const HeightGrid& grid_;
    const HorizonView& view_;
    const PlotOptions& options_;
    DrawnLines& out_;
    std::vector<double> upper_, lower_, heights_;  // by column of the picture
};

}  // namespace

Result<Drawing> image_space_horizon(const HeightGrid& grid, const Camera& camera,
                                    const PlotOptions& options) {
    Drawing drawing;
    drawing.resolution = camera.resolution;
    for (const HorizonView& view : HorizonView::all(grid, grid, camera)) {
        if (!(view.from() < view.to())) continue;
        ImageSpaceHorizon(grid, view, options, drawing.lines).run();
    }
    count_lengths(drawing.lines, drawing.counts);
    return drawing;
}

}  // namespace sightline
