#include "plot_subject.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <utility>

#include "errors.hpp"
#include "scene/load/text.hpp"

namespace sightline::cli {
namespace {

constexpr glm::dvec2 kDefaultRange(-10, 10);
constexpr double kAutomaticHeight = 0.4;  // of the longer side of the domain
const glm::dvec3 kRidgeDirection(0, -0.8, -1);

Error nothing_there(const PlotCommandOptions& options, const PlotDomain& domain) {
    return {ErrorKind::bad_input,
            fmt::format("{}: no height anywhere over x {:g}:{:g}, z {:g}:{:g}; choose another --x, "
                        "--z or --y",
                        load::shortened(options.items.front().text), domain.x.x, domain.x.y,
                        domain.z.x, domain.z.y)};
}

/// An error when there are heights so large that distances between them could not be computed.
Status check_heights(const HeightMap& map, const std::string& path) {
    constexpr double kLargestHeight = 1e150;  // its square is finite
    double lowest = 0, highest = 0;
    for (const double height : map.y) {
        if (height < lowest) lowest = height;
        if (height > highest) highest = height;
    }
    if (lowest >= -kLargestHeight && highest <= kLargestHeight) return success();
    return failure(
        "{}: heights from {:g} to {:g}, and none beyond {:g} can be drawn; make them smaller "
        "(--height-scale 1e-300) or name the value that means no data (--no-data {:g})",
        path, lowest, highest, kLargestHeight, -lowest > highest ? lowest : highest);
}

Result<std::vector<HeightMap>> load_maps(const PlotCommandOptions& options) {
    std::vector<HeightMap> maps;
    for (const PlotItem& item : options.items) {
        if (item.formula) continue;
        Result<HeightMap> map = load_height_map(item.text, options.map);
        if (!map) return map.error();
        if (Status drawable = check_heights(*map, item.text); !drawable) return drawable.error();
        maps.push_back(std::move(*map));
    }
    return maps;
}

/// Ranges of x and z: as asked for, else those of the maps.
void set_domain(const PlotCommandOptions& options, PlotSubject& subject) {
    const auto range = [&](const std::optional<glm::dvec2>& asked, auto nodes, glm::dvec2 other) {
        if (asked) return *asked;
        if (subject.maps.empty()) return other;
        glm::dvec2 all(INFINITY, -INFINITY);
        for (const HeightMap& map : subject.maps) {
            all.x = std::min(all.x, (map.*nodes).front());
            all.y = std::max(all.y, (map.*nodes).back());
        }
        return all;
    };
    subject.domain.x = range(options.x, &HeightMap::x, kDefaultRange);
    subject.domain.z = range(options.z, &HeightMap::z, options.x.value_or(kDefaultRange));
    if (options.y) subject.domain.y = *options.y;
    for (const HeightMap& map : subject.maps) subject.placed = subject.placed || map.placed;
}

}  // namespace

Result<PlotSubject> load_subject(const PlotCommandOptions& options) {
    PlotSubject subject;
    Result<std::vector<HeightMap>> maps = load_maps(options);
    if (!maps) return maps.error();
    subject.maps = std::move(*maps);
    set_domain(options, subject);
    return subject;
}

std::vector<Field> implicit_fields(const PlotCommandOptions& options, const PlotSubject& subject) {
    std::vector<Field> fields;
    std::size_t next_map = 0;
    for (const PlotItem& item : options.items) {
        if (item.formula && item.formula->kind == Formula::Kind::implicit) {
            fields.push_back(field_of(item.formula->value, item.text));
            continue;
        }
        const PlotField height =
            item.formula ? field_of(*item.formula) : field_of(subject.maps[next_map++]);
        fields.push_back({[height]() -> Evaluator {
                              return [own = height.make()](glm::dvec3 at) {
                                  return at.y - own(at.x, at.z);
                              };
                          },
                          item.text});
    }
    return fields;
}

std::vector<PlotField> fields_of(const PlotCommandOptions& options, const PlotSubject& subject) {
    std::vector<PlotField> fields;
    std::size_t next_map = 0;
    for (const PlotItem& item : options.items) {
        PlotField field =
            item.formula ? field_of(*item.formula) : field_of(subject.maps[next_map++]);
        fields.push_back(std::move(field));
    }
    return fields;
}

PlotField stretched(PlotField field, double factor) {
    if (factor == 1) return field;
    field.make = [make = std::move(field.make), factor] {
        return std::function<double(double, double)>(
            [own = make(), factor](double x, double z) { return factor * own(x, z); });
    };
    return field;
}

double stretch_of(const PlotCommandOptions& options, const PlotSubject& subject, double height) {
    const PlotDomain& domain = subject.domain;
    const double side = std::max(domain.x.y - domain.x.x, domain.z.y - domain.z.x);
    return options.stretch.value_or(height > 0 ? kAutomaticHeight * side / height : 1);
}

Status set_heights(const PlotCommandOptions& options, const std::vector<PlotField>& fields,
                   PlotSubject& subject) {
    const auto found = height_range(fields, subject.domain);
    if (!found) return nothing_there(options, subject.domain);
    if (!options.y) subject.domain.y = *found;
    subject.stretch = stretch_of(options, subject, subject.domain.y.y - subject.domain.y.x);
    subject.domain.y *= subject.stretch;
    return success();
}

namespace {

void shrink_domain(const std::vector<Field>& fields, bool keep_heights, PlotSubject& subject) {
    PlotDomain& domain = subject.domain;
    for (int round = 0; round < 2; ++round) {
        Box all = find_extent(fields.front(), subject.box());
        for (std::size_t k = 1; k < fields.size(); ++k) {
            const Box part = find_extent(fields[k], subject.box());
            all = {glm::min(all.lo, part.lo), glm::max(all.hi, part.hi)};
        }
        domain.x = {all.lo.x, all.hi.x};
        domain.z = {all.lo.z, all.hi.z};
        if (!keep_heights) domain.y = {all.lo.y, all.hi.y};
    }
}

}  // namespace

Status set_extent(const PlotCommandOptions& options, const std::vector<Field>& fields,
                  bool has_maps, PlotSubject& subject) {
    PlotDomain& domain = subject.domain;
    if (!options.y) {
        domain.y = {INFINITY, -INFINITY};
        for (const Field& field : fields) {
            const auto range = find_y_range(field, domain.x, domain.z);
            if (!range) return range.error();
            domain.y = {std::min(domain.y.x, range->x), std::max(domain.y.y, range->y)};
        }
    }
    if (!options.x && !options.z && !has_maps)
        shrink_domain(fields, options.y.has_value(), subject);
    return success();
}

CameraOptions camera_options(const PlotCommandOptions& options, const PlotSubject& subject) {
    CameraOptions camera = options.camera;
    const bool aimed = camera.eye || camera.target || camera.direction || camera.view;
    if (options.plot.ridges && !options.from) {
        if (!aimed) camera.direction = kRidgeDirection;
        if (!camera.projection) camera.projection = Projection::orthographic;
    }
    if (!options.from) return camera;
    camera.eye = *options.from * glm::dvec3(1, subject.stretch, subject.placed ? -1 : 1);
    camera.projection = Projection::perspective;
    if (camera.target || camera.direction || camera.view) return camera;
    const glm::dvec3 middle = subject.box().centre();
    const glm::dvec3 level(middle.x - camera.eye->x, 0, middle.z - camera.eye->z);
    const bool at_middle =
        std::hypot(level.x, level.z) < 1e-3 * glm::length(subject.box().extent());
    camera.direction = at_middle ? glm::dvec3(0, 0, -1) : level;
    return camera;
}

}  // namespace sightline::cli
