// What a camera sees of the planes of a BSP tree: on which side of them it stands, and where on the
// page one plane cuts another.
#pragma once

#include <cstdint>
#include <vector>

#include "sightline/screen_scene.hpp"
#include "visibility/bsp.hpp"
#include "visibility/bsp_tree.hpp"

namespace sightline::bsp {

/// The rays of a view in the tree's coordinates. In perspective they run from one point in the
/// direction a + x a_x + y a_y, in parallel projection in one direction from a + x a_x + y a_y; x
/// and y in units of the screen.
class Rays {
public:
    Rays(const ScreenScene& screen, const WorldGrid& grid);

    /// Positive when the viewer is in front of a plane, negative when behind it.
    [[nodiscard]] double side_of_viewer(const TreePlane& plane) const {
        return perspective_ ? plane.at(fixed_) : -plane.along(fixed_);
    }

    /// The line of the page in which plane `node` cuts the plane of a surface: factors l, m, n, so
    /// that l x + m y + n >= 0 where the surface is in front of `node`.
    [[nodiscard]] glm::dvec3 line(const TreePlane& node, const TreePlane& surface) const;

private:
    [[nodiscard]] glm::dvec3 line_edge_on(const TreePlane& node) const;

    bool perspective_;
    double edge_on_;    // a plane with a smaller value or rate at `fixed_` is seen edge-on
    glm::dvec3 fixed_;  // the eye, or the direction
    glm::dvec3 a_, a_x_, a_y_;
};

/// Drops the cuts that a triangle does not need, and finds the rows of what they leave of it.
class CutPruner {
public:
    /// False: nothing of the triangle can hold a sample. The samples that the triangle and all cuts
    /// hold are the same before and after.
    [[nodiscard]] bool prune(const ScreenScene& screen, std::uint32_t triangle,
                             std::vector<PageCut>& cuts);

private:
    struct Corner {
        double x, y;
    };
    bool clip(const PageCut& cut, double slack);
    [[nodiscard]] bool needs(const PageCut& cut, double slack) const;

    std::vector<Corner> polygon_, clipped_;
};

}  // namespace sightline::bsp
