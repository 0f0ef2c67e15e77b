// The box of axes: which edges, where the ticks are, what stands beside them.
//
// Steps of ticks are 1, 2 or 5 times a power of ten: P. S. Heckbert, "Nice numbers for graph
// labels", Graphics Gems, 1990.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "sightline/plot.hpp"
#include "sightline/scene.hpp"

namespace sightline {
namespace {

constexpr double kTick = 7, kToNumber = 5, kToName = 34;  // pixels
constexpr double kBetweenNumbers = 46;                    // pixels along an axis, at least
constexpr double kDigitWidth = 7.5, kDigitHeight = 14;    // pixels
constexpr double kShortestAxis = 40;

/// The least nice number that is not below `least`.
double nice_step(double least) {
    const double power = std::pow(10.0, std::floor(std::log10(least)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (factor * power >= least * (1 - 1e-9)) return factor * power;
    return 10 * power;
}

std::string number(double value, double step) {
    if (std::abs(value) < 1e-9 * step) return "0";
    if (std::abs(value) >= 1e6 || step < 1e-4) return fmt::format("{:.6g}", value);
    const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step * 1.0000001))));
    return fmt::format("{:.{}f}", value, decimals);
}

/// -1, 0 or 1 in x and y: towards which of eight sides a vector of the page points.
glm::dvec2 side(glm::dvec2 vector) {
    const double length = glm::length(vector);
    const auto sign = [&](double part) {
        return std::abs(part) < 0.38 * length ? 0.0 : part < 0 ? -1.0 : 1.0;
    };
    return {sign(vector.x), sign(vector.y)};
}

/// Left and right end of a word, about.
glm::dvec2 across(const Label& label) {
    const double width = kDigitWidth * static_cast<double>(label.text.size());
    const double left = label.position.x - 0.5 * (1 - label.away.x) * width;
    return {left, left + width};
}

bool overlap(const Label& a, const Label& b) {
    const glm::dvec2 of_a = across(a), of_b = across(b);
    return of_a.x < of_b.y && of_b.x < of_a.y &&
           std::abs(a.position.y - b.position.y) < kDigitHeight;
}

class AxesBuilder {
public:
    AxesBuilder(const Box& box, const Camera& camera, glm::dvec3 units)
        : box_(box), camera_(camera), units_(units) {
        const glm::dvec3 sight = camera.view_vector(box.centre());
        const double none = 1e-9 * glm::length(sight);
        for (int k = 0; k < 3; ++k) near_[k] = sight[k] <= none;
    }

    PlotAxes build() {
        add_edges();
        add_axis(0, corner({false, !near_.y, near_.z}), 2);
        add_axis(2, corner({near_.x, !near_.y, false}), 0);
        // Of the two upright edges at the sides, the left one.
        const glm::bvec3 one(near_.x, false, !near_.z), other(!near_.x, false, near_.z);
        const bool first = camera_.pixel_of(corner(one)).x < camera_.pixel_of(corner(other)).x;
        add_axis(1, corner(first ? one : other), first ? 0 : 2);
        return std::move(axes_);
    }

private:
    /// Of the box: high where `high` says so.
    [[nodiscard]] glm::dvec3 corner(glm::bvec3 high) const {
        return {high.x ? box_.hi.x : box_.lo.x, high.y ? box_.hi.y : box_.lo.y,
                high.z ? box_.hi.z : box_.lo.z};
    }

    /// All but those that meet in the corner nearest to the viewer.
    void add_edges() {
        for (int axis = 0; axis < 3; ++axis) {
            if (!(box_.hi[axis] > box_.lo[axis])) continue;
            for (int n = 0; n < 4; ++n) {
                glm::bvec3 at(false);
                at[(axis + 1) % 3] = (n & 1) != 0;
                at[(axis + 2) % 3] = (n & 2) != 0;
                glm::bvec3 end = at;
                end[axis] = true;
                if (at[(axis + 1) % 3] == near_[(axis + 1) % 3] &&
                    at[(axis + 2) % 3] == near_[(axis + 2) % 3])
                    continue;
                axes_.lines.push_back({corner(at), corner(end)});
            }
        }
    }

    [[nodiscard]] bool is_visible(glm::dvec3 p) const {
        return !camera_.is_perspective() || camera_.depth_of(p) > 0;
    }

    /// Ticks along an axis of the world, from where it begins; they point along another axis, to
    /// the side of the viewer for x and z.
    void add_axis(int axis, glm::dvec3 begin, int tick_axis) {
        glm::dvec3 end = begin;
        end[axis] = box_.hi[axis];
        if (!(end[axis] > begin[axis]) || !is_visible(begin) || !is_visible(end)) return;
        glm::dvec3 out(0);
        out[tick_axis] = begin[tick_axis] == box_.hi[tick_axis] ? 1 : -1;
        const glm::dvec3 middle = 0.5 * (begin + end);
        const double step_out = 1e-4 * glm::length(box_.extent());
        const glm::dvec2 on_page =
            (camera_.pixel_of(middle + step_out * out) - camera_.pixel_of(middle)) / step_out;
        const double length = glm::length(camera_.pixel_of(end) - camera_.pixel_of(begin));
        const double pixels = glm::length(on_page);
        if (length < kShortestAxis) return;
        // Seen from its end a tick has no length; numbers go below, or beside an upright axis.
        const bool flat = pixels * glm::length(box_.extent()) < kTick;
        const glm::dvec2 way =
            flat ? (axis == 1 ? glm::dvec2(-1, 0) : glm::dvec2(0, 1)) : on_page / pixels;
        const double tick = flat ? 0 : kTick / pixels;
        add_ticks(axis, begin, end, tick * out, way, length);
        const glm::dvec2 name = camera_.pixel_of(middle) + (kTick + kToName) * way;
        add_label(name, glm::dvec2(0), std::string(1, "xyz"[axis]));
    }

    void add_ticks(int axis, glm::dvec3 begin, glm::dvec3 end, glm::dvec3 tick, glm::dvec2 way,
                   double length) {
        const double units = units_[axis];
        const double low = std::min(begin[axis] * units, end[axis] * units),
                     high = std::max(begin[axis] * units, end[axis] * units);
        const double step = nice_step((high - low) * kBetweenNumbers / length);
        for (double n = std::ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; ++n) {
            glm::dvec3 at = begin;
            at[axis] = std::clamp(n * step / units, begin[axis], end[axis]);
            if (tick != glm::dvec3(0)) axes_.lines.push_back({at, at + tick});
            add_label(camera_.pixel_of(at) + (kTick + kToNumber) * way, side(way),
                      number(n * step, step));
        }
    }

    void add_label(glm::dvec2 at, glm::dvec2 away, std::string text) {
        const Resolution size = camera_.resolution;
        if (at.x < 0 || at.y < 0 || at.x > size.width || at.y > size.height) return;
        // Where two axes meet, the number of the first one stands there.
        const Label label{at, away, std::move(text)};
        for (const Label& other : axes_.labels)
            if (overlap(label, other)) return;
        axes_.labels.push_back(label);
    }

    const Box& box_;
    const Camera& camera_;
    glm::dvec3 units_;
    glm::bvec3 near_{false};  // whether the high side is that of the viewer
    PlotAxes axes_;
};

}  // namespace

PlotAxes axes_around(const Box& box, const Camera& camera, glm::dvec3 units) {
    if (box.empty()) return {};
    return AxesBuilder(box, camera, units).build();
}

}  // namespace sightline
