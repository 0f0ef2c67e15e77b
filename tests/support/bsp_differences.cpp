#include "support/bsp_differences.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <sstream>

namespace sightline::testing {

namespace {

// Beyond, the bound is a sixty-fourth of the whole depth range and says little.
constexpr double kSteep = 0x1p24;

}  // namespace

Differences& Differences::operator+=(const Differences& other) {
    samples += other.samples;
    differing += other.differing;
    explained += other.explained;
    grazed += other.grazed;
    unexplained += other.unexplained;
    steep += other.steep;
    if (first.empty()) first = other.first;
    return *this;
}

DifferenceJudge::DifferenceJudge(const ScreenScene& screen)
    : screen_(screen),
      transform_(make_transform(screen.camera(), screen.subpixel_bits())),
      grid_(bsp::make_grid(screen.scene().reach)),
      surfaces_(screen.scene(), grid_) {}

// How z of a plane changes per unit of x and y. In perspective 1/depth is affine on the page, in
// parallel projection the depth is.
glm::dvec2 DifferenceJudge::gradient(const bsp::TreePlane& plane) const {
    const Camera& camera = screen_.camera();
    const double unit = 1 / (camera.pixels_per_unit() * std::ldexp(1.0, screen_.subpixel_bits()));
    const double nx = unit * plane.along(camera.right), ny = -unit * plane.along(camera.up);
    if (camera.is_perspective()) {
        const double gap = -plane.at(grid_.of(camera.eye)) * grid_.step;
        return transform_.z_scale / gap * glm::dvec2(nx, ny);
    }
    return -transform_.z_scale / plane.along(camera.view_vector({})) * glm::dvec2(nx, ny);
}

// Of a triangle's corners from the plane that its sheet shares, in steps.
double DifferenceJudge::deviation(std::uint32_t id, const bsp::TreePlane& plane) const {
    double most = 0;
    for (const glm::dvec3& p : surfaces_.corners(id)) most = std::max(most, std::abs(plane.at(p)));
    return most;
}

// Of a screen triangle's corners from the plane that its sheet shares on the screen, in units of z.
// Between the corners it is no more.
double DifferenceJudge::deviation_on_screen(std::uint32_t k) const {
    const std::uint32_t id = screen_.id(k);
    if (screen_.shared_plane(id) == kNone) return 0;
    const Corners c = screen_.corners(k);
    double most = 0;
    for (const std::uint32_t v : {c.x, c.y, c.z}) {
        const ScreenPoint& p = screen_.point(v);
        most = std::max(most, std::abs(evaluate_depth(screen_.plane(id), p.x, p.y) - p.z));
    }
    return most;
}

DifferenceJudge::Surface DifferenceJudge::surface_at(std::uint32_t id, std::int32_t x,
                                                     std::int32_t y) const {
    Surface s;
    for (std::uint32_t k = 0; k < screen_.triangle_count(); ++k) {
        if (screen_.id(k) != id || !screen_.drawable(k)) continue;
        const Corners c = screen_.corners(k);
        const OrientedTriangle t(screen_.point(c.x), screen_.point(c.y), screen_.point(c.z));
        if (!covers(t, x, y)) continue;
        s.covers = s.surely = true;
        s.screen = deviation_on_screen(k);
        // The true edge lies within half a unit in x and in y, so it may leave the sample out.
        for (const auto& [p, q] : {std::pair(t.p, t.q), std::pair(t.q, t.r), std::pair(t.r, t.p)})
            if (2 * side(p.x, p.y, q.x, q.y, x, y) <= std::abs(q.x - p.x) + std::abs(q.y - p.y))
                s.surely = false;
    }
    const Camera& camera = screen_.camera();
    s.z = evaluate_depth(screen_.plane(id), x, y);
    const bsp::TreePlane plane = surfaces_.plane(id);
    const glm::dvec2 g = glm::abs(gradient(plane));
    s.screen += 0.5 + 0.5 * (g.x + g.y);
    const double moved = (bsp::kWorldTerm + deviation(id, plane)) * grid_.step;
    const double scale = camera.pixels_per_unit() * std::ldexp(1.0, screen_.subpixel_bits());
    double dx = scale * moved, dy = dx, dz = std::abs(transform_.z_scale) * moved;
    if (camera.is_perspective()) {
        const double depth = screen_.metric_depth(s.z);
        dx *= std::hypot(1.0, (x - transform_.cx) / scale) / depth;
        dy *= std::hypot(1.0, (y - transform_.cy) / scale) / depth;
        dz /= depth * depth;
    } else {
        dx *= std::hypot(1.0, camera.oblique.x);
        dy *= std::hypot(1.0, camera.oblique.y);
    }
    s.world = dz + g.x * dx + g.y * dy;
    return s;
}

Differences DifferenceJudge::compare(const Visibility& canonical, const Visibility& bsp) const {
    Differences found;
    found.samples = canonical.ids.size();
    const std::int32_t step = canonical.grid.step(screen_.subpixel_bits());
    const std::int32_t offset = canonical.grid.offset(screen_.subpixel_bits());
    for (std::size_t i = 0; i < canonical.ids.size(); ++i) {
        const std::uint32_t ids[] = {canonical.ids[i], bsp.ids[i]};
        if (ids[0] == ids[1]) continue;
        ++found.differing;
        const auto column = static_cast<std::int32_t>(i % canonical.grid.columns());
        const auto row = static_cast<std::int32_t>(i / canonical.grid.columns());
        const std::int32_t x = offset + column * step, y = offset + row * step;
        Surface a, b;
        if (ids[0] != kNone && ids[1] != kNone) {
            a = surface_at(ids[0], x, y);
            b = surface_at(ids[1], x, y);
        }
        const double bound = a.screen + b.screen + a.world + b.world;
        const bool both = a.covers && b.covers;
        if (both && std::abs(a.z - b.z) <= bound) {
            ++found.explained;
            found.steep += bound > kSteep ? 1 : 0;
        } else if (both && !(a.surely && b.surely)) {
            ++found.grazed;
        } else if (found.unexplained++ == 0) {
            std::ostringstream text;
            text << "sample (" << column << ", " << row << "): " << ids[0] << " at " << a.z
                 << ", but " << ids[1] << " at " << b.z << ", bounds " << a.screen << " + "
                 << a.world << " and " << b.screen << " + " << b.world;
            found.first = text.str();
        }
    }
    return found;
}

}  // namespace sightline::testing
