#include "support/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace sightline::testing {

std::uint64_t Random::next() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return z ^ z >> 31;
}

double Random::uniform(double lo, double hi) {
    return lo + (hi - lo) * static_cast<double>(next() >> 11) * 0x1p-53;
}

glm::dvec3 Random::point(double extent) {
    const double x = uniform(-extent, extent), y = uniform(-extent, extent);
    return {x, y, uniform(-extent, extent)};
}

SceneBuilder::SceneBuilder() {
    scene.materials.resize(1);
    scene.materials[0].specular = 0;
    scene.objects.resize(1);
    scene.objects[0].name = "object";
}

SceneBuilder& SceneBuilder::polygon(std::initializer_list<glm::dvec3> corners) {
    Object& object = scene.objects[0];
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    const auto count = static_cast<std::uint32_t>(corners.size());
    scene.positions.insert(scene.positions.end(), corners);
    for (std::uint32_t k = 2; k < count; ++k) {
        scene.triangles.push_back({first, first + k - 1, first + k});
        scene.triangle_polygon.push_back(object.polygon_count);
        const int edges = 2 | (k == 2 ? 1 : 0) | (k == count - 1 ? 4 : 0);
        scene.polygon_edges.push_back(static_cast<std::uint8_t>(edges));
    }
    object.triangle_count = scene.triangle_count();
    scene.counts.polygons = ++object.polygon_count;
    return *this;
}

SceneBuilder& SceneBuilder::box(glm::dvec3 lo, glm::dvec3 hi) {
    const auto at = [&](int x, int y, int z) {
        return glm::dvec3{x ? hi.x : lo.x, y ? hi.y : lo.y, z ? hi.z : lo.z};
    };
    quad(at(0, 0, 0), at(0, 1, 0), at(1, 1, 0), at(1, 0, 0));
    quad(at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1));
    quad(at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1));
    quad(at(0, 1, 0), at(0, 1, 1), at(1, 1, 1), at(1, 1, 0));
    quad(at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0));
    return quad(at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1));
}

void SceneBuilder::vertex_normals(const std::vector<glm::vec3>& normals) {
    scene.normals.assign(normals.begin(), normals.end());
    scene.triangle_normals = scene.triangles;
}

void SceneBuilder::vertex_colors(const std::vector<glm::vec4>& colors) {
    scene.colors.assign(colors.begin(), colors.end());
    scene.triangle_colors = scene.triangles;
}

Scene SceneBuilder::build() const {
    Scene joined = scene;
    joined.positions.clear();
    std::map<std::tuple<double, double, double>, std::uint32_t> known;
    for (Corners& corners : joined.triangles) {
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3& p = scene.positions[corners[k]];
            const auto [it, fresh] = known.try_emplace(
                {p.x, p.y, p.z}, static_cast<std::uint32_t>(joined.positions.size()));
            if (fresh) joined.positions.push_back(p);
            corners[k] = it->second;
        }
    }
    finish_scene(joined);
    return joined;
}

namespace {

struct Frame {
    glm::dvec3 origin, u, v, n;
};

Frame random_frame(Random& random) {
    const glm::dvec3 u = glm::normalize(random.point() + glm::dvec3{1e-3, 0, 0});
    const glm::dvec3 n = glm::normalize(glm::cross(u, random.point() + glm::dvec3{0, 1e-3, 2e-3}));
    return {random.point(0.5), u, glm::cross(n, u), n};
}

glm::dvec3 in_plane(const Frame& f, double s, double t) { return f.origin + s * f.u + t * f.v; }

// A wall and decals in its plane, one of them overhanging.
void add_decals(SceneBuilder& b, Random& random) {
    const Frame f = random_frame(random);
    b.quad(in_plane(f, -.8, -.6), in_plane(f, .8, -.6), in_plane(f, .8, .6), in_plane(f, -.8, .6));
    for (std::uint32_t k = 0; k < 1 + random.below(4); ++k) {
        const double s = random.uniform(-.7, .6), t = random.uniform(-.5, .4);
        const double w = random.uniform(.05, .5), h = random.uniform(.05, .5);
        b.quad(in_plane(f, s, t), in_plane(f, s + w, t), in_plane(f, s + w, t + h),
               in_plane(f, s, t + h));
    }
}

// Two faces that cross at so small an angle that their depths differ by less than the error of
// single precision over much of their area, but too much to be one sheet.
void add_grazing(SceneBuilder& b, Random& random) {
    const Frame f = random_frame(random);
    const auto lifted = [&](double s, double t) {
        const double side = random.chance(0.5) ? 1 : -1;
        return in_plane(f, s, t) + side * random.uniform(3e-6, 6e-6) * f.n;
    };
    b.triangle(in_plane(f, -.9, -.8), in_plane(f, .9, -.7), in_plane(f, 0, .9));
    b.triangle(lifted(-.8, -.9), lifted(.8, -.9), lifted(.1, .8));
    b.triangle(lifted(-.9, .5), lifted(-.2, -.9), lifted(.9, .6));
}

// A fan around a vertex: shared edges and a shared corner, folded so that faces tie along folds.
void add_fan(SceneBuilder& b, Random& random) {
    const glm::dvec3 hub = random.point(.4);
    const std::uint32_t n = 3 + random.below(12);
    std::vector<glm::dvec3> rim;
    for (std::uint32_t k = 0; k < n; ++k) rim.push_back(hub + random.point(.6));
    for (std::uint32_t k = 0; k < n; ++k) b.triangle(hub, rim[k], rim[(k + 1) % n]);
}

void add_needles(SceneBuilder& b, Random& random) {
    for (std::uint32_t k = 0; k < 6; ++k) {
        const glm::dvec3 p = random.point(), q = random.point();
        const double width = std::pow(10.0, random.uniform(-9, -2));
        b.triangle(p, q, q + width * random.point());
    }
}

// Corners on multiples of 1/8: under an orthographic view they meet sample points exactly.
void add_lattice(SceneBuilder& b, Random& random) {
    const auto corner = [&] {
        return glm::dvec3{(random.below(17) - 8.0) / 8, (random.below(17) - 8.0) / 8,
                          (random.below(5) - 2.0) / 4};
    };
    for (std::uint32_t k = 0; k < 10; ++k) {
        const glm::dvec3 p = corner(), q = corner(), r = corner();
        b.triangle(p, q, r);
    }
}

void add_copies(SceneBuilder& b, Random& random) {
    const glm::dvec3 p = random.point(), q = random.point(), r = random.point();
    b.triangle(p, q, r).triangle(q, r, p).triangle(r, q, p).triangle(p, q,
                                                                     (p + q) * 0.5 + r * 0.25);
}

}  // namespace

Scene hostile_scene(std::uint64_t seed) {
    Random random(seed);
    SceneBuilder b;
    const std::uint32_t parts = 1 + random.below(5);
    for (std::uint32_t k = 0; k < parts; ++k) {
        switch (random.below(9)) {
            case 0:
                add_decals(b, random);
                break;
            case 1:
                add_fan(b, random);
                break;
            case 2:
                add_needles(b, random);
                break;
            case 3:
                add_lattice(b, random);
                break;
            case 4:
                add_copies(b, random);
                break;
            case 5:
                add_grazing(b, random);
                break;
            case 6: {  // touching boxes: coincident walls
                const glm::dvec3 p = random.point(.5);
                const double s = random.uniform(.1, .6);
                b.box(p, p + s).box({p.x + s, p.y, p.z}, {p.x + 2 * s, p.y + .7 * s, p.z + s});
                break;
            }
            default:
                for (std::uint32_t i = 0; i < 8; ++i) {
                    const glm::dvec3 p = random.point(), q = random.point();
                    b.triangle(p, q, random.point());
                }
        }
    }
    return b.build();
}

Camera hostile_camera(const Scene& scene, std::uint64_t seed, Resolution resolution) {
    Random random(seed ^ 0xCA3E5Au);
    CameraOptions options;
    constexpr Projection kinds[] = {Projection::perspective, Projection::orthographic,
                                    Projection::cavalier, Projection::cabinet};
    options.projection = kinds[random.below(4)];
    if (random.chance(0.3)) {
        options.view = static_cast<NamedView>(random.below(9));
    } else {
        options.direction = random.point() + glm::dvec3{0.01, 0, 0};
        options.up = glm::cross(*options.direction, glm::dvec3{0.3, 0.4, -0.6});
    }
    if (options.projection == Projection::perspective && random.chance(0.3)) {
        options.eye = random.point(.6);  // among the faces: near clipping
        options.near_plane = std::pow(10.0, random.uniform(-3, -0.3));
        options.fov = random.uniform(20, 150);
    } else if (random.chance(0.3)) {
        options.zoom = random.uniform(0.5, 200);  // the guard band clips
    } else if (random.chance(0.3)) {
        options.ortho_height = 2;  // lattices meet sample points
    }
    Result<Camera> camera = make_camera(options, scene.bounds, resolution);
    if (!camera) camera = make_camera({}, scene.bounds, resolution);
    return must(std::move(camera));
}

Scene shuffled(const Scene& scene, std::uint64_t seed, std::vector<std::uint32_t>& order) {
    Random random(seed);
    order.resize(scene.triangles.size());
    std::iota(order.begin(), order.end(), 0u);
    for (std::size_t i = order.size(); i > 1; --i)
        std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
    Scene out = scene;
    for (std::size_t t = 0; t < order.size(); ++t) {
        out.triangles[t] = scene.triangles[order[t]];
        out.triangle_polygon[t] = scene.triangle_polygon[order[t]];
        out.polygon_edges[t] = scene.polygon_edges[order[t]];
    }
    finish_scene(out);
    return out;
}

Scene sphere_scene(std::uint32_t rings, std::uint32_t sectors) {
    SceneBuilder b;
    const double pi = std::acos(-1.0);
    const auto at = [&](std::uint32_t ring, std::uint32_t sector) {
        const double t = pi * ring / rings, p = 2 * pi * (sector % sectors) / sectors;
        if (ring == 0) return glm::dvec3{0, 1, 0};
        if (ring == rings) return glm::dvec3{0, -1, 0};
        return glm::dvec3{std::sin(t) * std::sin(p), std::cos(t), std::sin(t) * std::cos(p)};
    };
    for (std::uint32_t r = 0; r < rings; ++r)
        for (std::uint32_t s = 0; s < sectors; ++s) {
            if (r == 0)
                b.triangle(at(0, 0), at(1, s), at(1, s + 1));
            else if (r + 1 == rings)
                b.triangle(at(r, s), at(rings, 0), at(r, s + 1));
            else
                b.quad(at(r, s), at(r + 1, s), at(r + 1, s + 1), at(r, s + 1));
        }
    return b.build();
}

Visibility run(const std::string& algorithm, const ScreenScene& screen,
               const ResolveOptions& options) {
    const Algorithm* found = find_algorithm(algorithm);
    if (found == nullptr) throw std::runtime_error("no algorithm " + algorithm);
    Visibility out;
    (void)must(resolve(*found, screen, options, out));
    return out;
}

std::uint64_t count_differences(const Visibility& a, const Visibility& b) {
    std::uint64_t differ = 0;
    for (std::size_t i = 0; i < a.ids.size(); ++i)
        differ += a.ids[i] != b.ids[i] || std::memcmp(&a.depth[i], &b.depth[i], sizeof(float)) != 0;
    return differ;
}

}  // namespace sightline::testing
