// Pairs of surfaces that cross, and where they do so in the world: an oracle for curves that knows
// nothing of pages.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "support/scenes.hpp"

namespace sightline::testing {

/// A frame turned at random, so that nothing runs along an axis.
struct TurnedFrame {
    glm::dvec3 u, v, n;

    explicit TurnedFrame(Random& random) {
        u = glm::normalize(random.point() + glm::dvec3(1e-3));
        n = glm::normalize(glm::cross(u, random.point() + glm::dvec3(0, 1e-3, 0)));
        v = glm::cross(n, u);
    }
    [[nodiscard]] glm::dvec3 at(double x, double y, double z) const {
        return x * u + y * v + z * n;
    }
};

/// Triangles over a grid of columns x rows cells; map(s, t) places the points of [0, 1]^2.
template <class Map>
void add_surface(SceneBuilder& b, std::uint32_t columns, std::uint32_t rows, const Map& map) {
    const auto at = [&](std::uint32_t i, std::uint32_t j) {
        return map(static_cast<double>(i) / columns, static_cast<double>(j) / rows);
    };
    for (std::uint32_t i = 0; i < columns; ++i)
        for (std::uint32_t j = 0; j < rows; ++j) {
            b.triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1));
            b.triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
}

/// Two surfaces; the triangles of the first one are those below `second`.
struct SurfacePair {
    SceneBuilder builder;
    std::uint32_t second = 0;
    glm::dvec3 floor{};  ///< normal of the first one where it is flat
};

inline constexpr int kSurfaceKinds = 7;

/// Kinds: 0 a wave and a plane over one grid, 1 two waves over one grid, 2 a wave and a large flat
/// rectangle, 3 a sphere and a plane, 4 a sphere and a cylinder, 5 two planes, 6 a wave and a plane
/// over one grid that graze each other.
inline SurfacePair surface_pair(int kind, std::uint64_t seed) {
    Random random(7 * seed + static_cast<std::uint64_t>(kind));
    const TurnedFrame frame(random);
    const double tau = 2 * std::acos(-1.0);
    const double fx = random.uniform(1, 4), fy = random.uniform(1, 4), phase = random.uniform(0, 6);
    const double amplitude =
        kind == 6 ? std::pow(10, random.uniform(-3, -1)) : random.uniform(.05, .5);
    const std::uint32_t n = 8 + random.below(6);
    const auto flat = [&](double s, double t) { return frame.at(2 * s - 1, 2 * t - 1, 0); };
    const auto wave = [&](double s, double t) {
        const double x = 2 * s - 1, y = 2 * t - 1;
        return frame.at(x, y, amplitude * std::sin(fx * x + phase) * std::cos(fy * y));
    };
    const auto sphere = [&](double r, double height) {
        return [=](double s, double t) {
            const double a = tau * s, b = tau / 2 * t;
            return frame.at(.03 + r * std::sin(b) * std::cos(a),
                            .01 + r * std::sin(b) * std::sin(a), height + r * std::cos(b));
        };
    };
    SurfacePair pair;
    pair.floor = frame.n;
    SceneBuilder& b = pair.builder;
    const double slope = random.uniform(-1, 1);
    switch (kind) {
        case 1:
            add_surface(b, n, n, [&](double s, double t) {
                const double x = 2 * s - 1, y = 2 * t - 1;
                return frame.at(x, y, amplitude * std::cos(fy * x + y));
            });
            break;
        case 2:
            add_surface(b, 1, 1, [&](double s, double t) {
                return frame.at(3 * s - 1.5, 3 * t - 1.5, .1 * (s - t));
            });
            break;
        case 3:
            add_surface(b, 1, 1, flat);
            break;
        case 4:
            add_surface(b, 2 * n, n, sphere(.6, .02));
            break;
        default:
            add_surface(b, n, n, flat);
    }
    pair.second = b.scene.triangle_count();
    if (kind == 3) {
        add_surface(b, 2 * n, n, sphere(.8, .7 * slope));
    } else if (kind == 4) {
        add_surface(b, 2 * n, 3, [&](double s, double t) {
            return frame.at(.2 + .4 * std::cos(tau * s), .4 * std::sin(tau * s), 2 * t - 1);
        });
    } else if (kind == 5) {
        add_surface(b, n - 1, n + 1, [&](double s, double t) {
            return frame.at(1.8 * s - .9, 1.7 * t - .8, slope * (1.8 * s - .91));
        });
    } else {
        add_surface(b, n, n, wave);
    }
    return pair;
}

/// A camera that looks at a scene from anywhere.
inline Camera random_view(const Scene& scene, std::uint64_t seed, Resolution resolution) {
    Random random(seed + 77);
    CameraOptions options;
    options.direction = random.point();
    options.projection = seed % 2 == 0 ? Projection::orthographic : Projection::perspective;
    return must(make_camera(options, scene.bounds, resolution));
}

/// Where two triangles of the world cross, and the edges on which the stretch ends.
struct WorldCrossing {
    std::uint32_t f = 0, g = 0;
    std::array<glm::dvec3, 2> end{};
    std::array<std::array<glm::dvec3, 2>, 2> edge{};
};

using WorldTriangle = std::array<glm::dvec3, 3>;

inline WorldTriangle corners_of(const Scene& scene, std::uint32_t t) {
    const Corners c = scene.triangles[t];
    return {scene.positions[c.x], scene.positions[c.y], scene.positions[c.z]};
}

/// In double precision, for triangles in general position.
inline bool cross_in_world(const WorldTriangle& a, const WorldTriangle& b, WorldCrossing& found) {
    const glm::dvec3 na = glm::cross(a[1] - a[0], a[2] - a[0]);
    const glm::dvec3 nb = glm::cross(b[1] - b[0], b[2] - b[0]);
    const glm::dvec3 along = glm::cross(na, nb);
    struct End {
        double at;
        glm::dvec3 point;
        std::array<glm::dvec3, 2> edge;
    };
    const auto ends = [&](const WorldTriangle& t, const glm::dvec3& n, const glm::dvec3& o,
                          std::array<End, 2>& out) {
        int count = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 &p = t[k], &q = t[(k + 1) % 3];
            const double at_p = glm::dot(n, p - o), at_q = glm::dot(n, q - o);
            if ((at_p >= 0) == (at_q >= 0)) continue;
            const glm::dvec3 point = p + at_p / (at_p - at_q) * (q - p);
            out[static_cast<std::size_t>(count++)] = {glm::dot(along, point), point, {p, q}};
        }
        if (count == 2 && out[1].at < out[0].at) std::swap(out[0], out[1]);
        return count == 2;
    };
    std::array<End, 2> of_a{}, of_b{};
    if (!ends(a, nb, b[0], of_a) || !ends(b, na, a[0], of_b)) return false;
    const End& from = of_a[0].at > of_b[0].at ? of_a[0] : of_b[0];
    const End& to = of_a[1].at < of_b[1].at ? of_a[1] : of_b[1];
    if (from.at >= to.at) return false;
    found.end = {from.point, to.point};
    found.edge = {from.edge, to.edge};
    return true;
}

inline std::vector<WorldCrossing> world_crossings(const Scene& scene, std::uint32_t second) {
    struct Box {
        glm::dvec3 lo, hi;
    };
    std::vector<Box> boxes;
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
        const WorldTriangle c = corners_of(scene, t);
        boxes.push_back(
            {glm::min(c[0], glm::min(c[1], c[2])), glm::max(c[0], glm::max(c[1], c[2]))});
    }
    std::vector<WorldCrossing> all;
    for (std::uint32_t f = 0; f < second; ++f)
        for (std::uint32_t g = second; g < scene.triangle_count(); ++g) {
            const Box &a = boxes[f], &b = boxes[g];
            if (a.lo.x > b.hi.x || b.lo.x > a.hi.x || a.lo.y > b.hi.y || b.lo.y > a.hi.y ||
                a.lo.z > b.hi.z || b.lo.z > a.hi.z)
                continue;
            WorldCrossing crossing{f, g, {}, {}};
            if (cross_in_world(corners_of(scene, f), corners_of(scene, g), crossing))
                all.push_back(crossing);
        }
    return all;
}

}  // namespace sightline::testing
