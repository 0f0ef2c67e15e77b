// Where a drawing lies on its page.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "sightline/vector.hpp"

namespace sightline {
namespace {

Error wrong(std::string message) { return {ErrorKind::bad_option, std::move(message)}; }

/// A drawing that fits to 1 part in 10^9 is not refused for how numbers were rounded.
constexpr double kSlack = 1 + 1e-9;

bool positive(double x) { return std::isfinite(x) && x > 0; }

/// What does not depend on the camera's numbers.
Status check(const PageOptions& options, const Camera& camera) {
    if (options.scale && !positive(*options.scale)) {
        return wrong("the scale of a drawing must be positive, such as 1:50");
    }
    if (options.scale && camera.is_perspective()) {
        return wrong(
            "lengths in perspective have no scale: leave --scale out or choose a parallel "
            "--projection");
    }
    if (!options.size) return success();
    if (!positive(options.size->x) || !positive(options.size->y)) {
        return wrong("the width and height of a page must be positive");
    }
    if (!std::isfinite(options.margin) || options.margin < 0) {
        return wrong("--margin must not be negative");
    }
    return success();
}

/// The scale at which the drawing fills `room` in one direction.
double filling_scale(glm::dvec2 room, glm::dvec2 pixels) {
    return std::min(room.x / pixels.x, room.y / pixels.y);
}

}  // namespace

Result<PageLayout> lay_out(const PageOptions& options, const Camera& camera) {
    if (Status checked = check(options, camera); !checked) return checked.error();
    const glm::dvec2 pixels(camera.resolution.width, camera.resolution.height);
    PageLayout layout;
    layout.millimetres = options.size || options.scale;
    if (options.scale) layout.scale = *options.scale / camera.pixels_per_unit();
    glm::dvec2 page = layout.scale * pixels;
    if (options.size) {
        page = *options.size;
        const glm::dvec2 room = page - 2 * options.margin;
        if (!(room.x > 0 && room.y > 0)) {
            return wrong(fmt::format("a --margin of {} mm leaves nothing of a page of {} x {} mm",
                                     options.margin, page.x, page.y));
        }
        if (!options.scale) layout.scale = filling_scale(room, pixels);
        const glm::dvec2 drawn = layout.scale * pixels;
        if (drawn.x > room.x * kSlack || drawn.y > room.y * kSlack) {
            return wrong(fmt::format(
                "at its --scale the drawing is {:.1f} x {:.1f} mm, but the page has room for "
                "{:.1f} x {:.1f} mm: choose a smaller scale, a larger page or a smaller --margin",
                drawn.x, drawn.y, room.x, room.y));
        }
        layout.offset = 0.5 * (page - drawn);
    }
    layout.width = page.x;
    layout.height = page.y;
    return layout;
}

}  // namespace sightline
