// What a plot is of: the things on the command line, their ranges and the view of them.
#pragma once

#include <vector>

#include "plot_options.hpp"
#include "sightline/sightline.hpp"

namespace sightline::cli {

/// What is to be plotted, in the coordinates in which it is drawn.
struct PlotSubject {
    std::vector<HeightMap> maps;  ///< in the order of the items
    PlotDomain domain;
    double stretch = 1;
    bool placed = false;  ///< z is minus the northing

    [[nodiscard]] Box box() const {
        return {{domain.x.x, domain.y.x, domain.z.x}, {domain.x.y, domain.y.y, domain.z.y}};
    }
};

/// The maps, and the ranges of x and z: as asked for, else those of the maps.
[[nodiscard]] Result<PlotSubject> load_subject(const PlotCommandOptions& options);

/// One for each item. Precondition: none is implicit.
[[nodiscard]] std::vector<PlotField> fields_of(const PlotCommandOptions& options,
                                               const PlotSubject& subject);
/// The same things, and implicit ones, as surfaces on which a field is 0.
[[nodiscard]] std::vector<Field> implicit_fields(const PlotCommandOptions& options,
                                                 const PlotSubject& subject);

/// Limits of the heights, then how much taller they are drawn. Error: there is none.
[[nodiscard]] Status set_heights(const PlotCommandOptions& options,
                                 const std::vector<PlotField>& fields, PlotSubject& subject);
/// How much taller heights of that range are drawn.
[[nodiscard]] double stretch_of(const PlotCommandOptions& options, const PlotSubject& subject,
                                double height);
[[nodiscard]] PlotField stretched(PlotField field, double factor);

/// Limits of implicit surfaces: ranges that nobody gave are those in which there is something.
[[nodiscard]] Status set_extent(const PlotCommandOptions& options, const std::vector<Field>& fields,
                                bool has_maps, PlotSubject& subject);

[[nodiscard]] CameraOptions camera_options(const PlotCommandOptions& options,
                                           const PlotSubject& subject);

}  // namespace sightline::cli
