// A grid as the floating horizon wants to see it: from straight ahead.
//
// Vertical planes through the eye (parallel to the gaze, in parallel projections) are lines of
// constant u; along them v says which of two points is seen higher up. (u, v) are the coordinates
// of a picture whose plane is upright and parallel to one axis of the grid, so
//   - the rows along that axis are graphs v(u) whose nodes are in order,
//   - straight lines stay straight, here and on the page.
// A parallel view is a shear of space, and one picture shows all. Around an eye there are four, a
// quarter of all directions each; they do not hide each other.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "sightline/camera.hpp"
#include "sightline/plot.hpp"

namespace sightline {

class HorizonView {
public:
    /// All the views that are needed to see a grid through a camera. Views whose depth grows along
    /// x and along z may look at grids that differ in the nodes of that axis.
    [[nodiscard]] static std::vector<HorizonView> all(const HeightGrid& for_x,
                                                      const HeightGrid& for_z,
                                                      const Camera& camera);

    /// Depth grows along x, else along z.
    [[nodiscard]] bool along_x() const { return along_x_; }
    /// Whether it grows with the coordinate.
    [[nodiscard]] bool forward() const { return forward_; }
    [[nodiscard]] bool is_perspective() const { return perspective_; }
    /// The range of u over which there is some of the grid; from() >= to() where there is none.
    [[nodiscard]] double from() const { return from_; }
    [[nodiscard]] double to() const { return to_; }
    /// Rows that can be seen, by their index in the grid, from front to back.
    [[nodiscard]] const std::vector<std::size_t>& rows() const { return rows_; }
    /// The other coordinate of the nodes, relative to the eye or the middle; ascending.
    [[nodiscard]] const std::vector<double>& across() const { return across_; }
    /// Pixels that a unit of u has on the page, about.
    [[nodiscard]] double pixels_across() const;
    /// Depth of a row of the grid; positive in perspective.
    [[nodiscard]] double depth_of_row(std::size_t row) const;

    /// (across, y, depth) of a point.
    [[nodiscard]] glm::dvec3 local(glm::dvec3 point) const;
    /// Relative to the same origin as across().
    [[nodiscard]] double local_height(double y) const { return y - origin_.y; }
    [[nodiscard]] glm::dvec2 seen(glm::dvec3 local) const {
        if (perspective_) return {local.x / local.z, local.y / local.z};
        return {local.x - slant_.x * local.z, local.y - slant_.y * local.z};
    }
    /// Where the line of sight through u is, at a depth.
    [[nodiscard]] double across_at(double u, double depth) const {
        return perspective_ ? u * depth : u + slant_.x * depth;
    }
    /// Direction of the line of sight through a point, seen from above: (across, depth).
    [[nodiscard]] glm::dvec2 sight(glm::dvec2 at) const {
        return perspective_ ? at : glm::dvec2(slant_.x, 1);
    }
    /// The part of a line of this view that is on the page, as pixels. Ends that are not cut are
    /// the same for all lines that have them.
    [[nodiscard]] std::optional<std::array<glm::dvec2, 2>> on_page(glm::dvec2 a,
                                                                   glm::dvec2 b) const;
    /// The part of a line in space that belongs to the view, in (u, v).
    [[nodiscard]] std::optional<std::array<glm::dvec2, 2>> seen_line(const AxisLine& line) const;

private:
    HorizonView(const HeightGrid& grid, const Camera& camera, bool along_x, bool forward,
                double half_width);
    void set_parallel();
    void set_axes(const HeightGrid& grid);
    void set_range();
    /// The vector of the world that is (across, y, depth) here.
    [[nodiscard]] glm::dvec3 world(glm::dvec3 local) const;
    /// What moves a point on the page in parallel projections, in pixels.
    [[nodiscard]] glm::dvec2 moved(glm::dvec3 vector) const;
    /// Of the line of sight through (u, v) in perspective, depth along the camera's gaze.
    [[nodiscard]] double camera_depth(glm::dvec2 uv) const;
    [[nodiscard]] glm::dvec2 pixel(glm::dvec2 uv) const;

    const Camera* camera_;
    bool along_x_, forward_, perspective_;
    glm::dvec3 origin_{0, 0, 0};
    glm::dvec2 slant_{0, 0};  // of parallel lines of sight: across and up for each unit of depth
    glm::dvec2 base_{0, 0}, page_u_{0, 0}, page_v_{0, 0};  // the page in parallel projections
    std::vector<double> across_, depths_;                  // depths of all rows of the grid
    std::vector<std::size_t> rows_;
    double half_width_ = 0;  // of the view in u, in perspective
    double nearest_ = 0;     // depth, in perspective
    double from_ = 0, to_ = 0;
};

}  // namespace sightline
