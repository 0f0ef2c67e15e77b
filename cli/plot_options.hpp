// What the command line of `plot` says.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drawing_output.hpp"
#include "options.hpp"
#include "sightline/plot.hpp"

namespace sightline::cli {

/// One thing to plot: a formula, or a map to be loaded.
struct PlotItem {
    std::string text;
    std::optional<Formula> formula;  ///< none: `text` is the path of a height map
};

struct PlotCommandOptions {
    CommonOptions common;
    std::vector<PlotItem> items;
    std::optional<glm::dvec2> x, z, y;  ///< ranges
    PlotCurves curves;
    PlotOptions plot;
    std::optional<double> stretch;  ///< none: as much as looks well
    bool axes = true, image_space = false, outline = true;
    HeightMapOptions map;
    CameraOptions camera;
    std::optional<glm::dvec3> from;  ///< in coordinates of the map
    Resolution resolution;
    DrawingOutput drawing;

    /// Whether there are surfaces that are no heights over x and z.
    [[nodiscard]] bool has_implicit() const;
    [[nodiscard]] bool has_map() const;
};

/// All options but --help, for the table of commands.
extern const std::span<const Option> kPlotLookOptions, kPlotDomainOptions, kPlotMapOptions,
    kPlotCameraOptions;

[[nodiscard]] Result<PlotCommandOptions> read_plot_options(const Arguments& arguments);

}  // namespace sightline::cli
