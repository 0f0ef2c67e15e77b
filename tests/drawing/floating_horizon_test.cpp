// The floating horizon against exact hidden lines of the same triangles.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <map>

#include "drawing/pages.hpp"
#include "sightline/plot.hpp"

namespace sightline {
namespace {

using Height = std::function<double(double x, double z)>;

std::vector<double> nodes(double from, double to, std::size_t cells) {
    std::vector<double> out;
    for (std::size_t k = 0; k <= cells; ++k)
        out.push_back(from + (to - from) * static_cast<double>(k) / static_cast<double>(cells));
    return out;
}

/// Every `step`-th line inside is drawn.
HeightGrid grid_of(const std::vector<Height>& heights, double size, std::size_t cells,
                   std::size_t step) {
    HeightGrid grid;
    grid.x = nodes(-size, size, cells);
    grid.z = nodes(-0.8 * size, 0.9 * size, cells - 3);
    const auto uses = [&](std::size_t count) {
        std::vector<LineUse> out(count, LineUse::none);
        for (std::size_t k = step; k + 1 < count; k += step) out[k] = LineUse::curve;
        return out;
    };
    grid.column_use = uses(grid.x.size());
    grid.row_use = uses(grid.z.size());
    for (const Height& height : heights) {
        HeightLayer layer;
        for (const double z : grid.z)
            for (const double x : grid.x) layer.y.push_back(height(x, z));
        grid.layers.push_back(std::move(layer));
    }
    return grid;
}

/// The same triangles, with the lowest node of the cell of each.
struct Mesh {
    Scene scene;
    std::vector<glm::uvec3> nodes;  // of each triangle
};

Mesh mesh_of(const HeightGrid& grid) {
    Mesh mesh;
    Scene& scene = mesh.scene;
    const auto columns = static_cast<std::uint32_t>(grid.x.size());
    for (const HeightLayer& layer : grid.layers) {
        const auto base = static_cast<std::uint32_t>(scene.positions.size());
        Object object;
        object.first_triangle = object.first_polygon = scene.triangle_count();
        for (std::size_t k = 0; k < grid.z.size(); ++k)
            for (std::size_t i = 0; i < columns; ++i)
                scene.positions.emplace_back(grid.x[i], layer.y[k * columns + i], grid.z[k]);
        for (std::uint32_t k = 0; k + 1 < grid.z.size(); ++k) {
            for (std::uint32_t i = 0; i + 1 < columns; ++i) {
                const std::uint32_t a = k * columns + i, b = a + 1, c = a + columns, d = c + 1;
                for (const glm::uvec3& t : {glm::uvec3(a, d, b), glm::uvec3(a, c, d)}) {
                    scene.triangles.push_back(t + base);
                    scene.triangle_polygon.push_back(scene.triangle_count() - 1);
                    mesh.nodes.push_back(t);
                }
            }
        }
        object.triangle_count = object.polygon_count =
            scene.triangle_count() - object.first_triangle;
        scene.objects.push_back(object);
    }
    scene.polygon_edges.assign(scene.triangle_count(), 7);
    scene.materials.resize(1);
    finish_scene(scene);
    return mesh;
}

/// Visible length by object and curve, rows first.
using Lengths = std::map<std::pair<std::uint32_t, std::uint32_t>, double>;

/// The number of the curve that two triangles share a part of; kNone for a diagonal.
std::uint32_t curve_between(const HeightGrid& grid, const Mesh& mesh, glm::uvec2 triangles) {
    const auto columns = static_cast<std::uint32_t>(grid.x.size());
    std::vector<std::uint32_t> shared;
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            if (mesh.nodes[triangles.x][a] == mesh.nodes[triangles.y][b])
                shared.push_back(mesh.nodes[triangles.x][a]);
    if (shared.size() != 2) return kNone;
    const auto number = [](const std::vector<LineUse>& uses, std::size_t at) {
        if (uses[at] == LineUse::none) return kNone;
        return static_cast<std::uint32_t>(std::count(
            uses.begin(), uses.begin() + static_cast<std::ptrdiff_t>(at), LineUse::curve));
    };
    const auto rows = static_cast<std::uint32_t>(
        std::count(grid.row_use.begin(), grid.row_use.end(), LineUse::curve));
    if (shared[0] / columns == shared[1] / columns)
        return number(grid.row_use, shared[0] / columns);
    if (shared[0] % columns != shared[1] % columns) return kNone;
    const std::uint32_t column = number(grid.column_use, shared[0] % columns);
    return column == kNone ? kNone : rows + column;
}

double length(const DrawnLines& lines, std::size_t k) {
    return std::hypot(lines.to[k].x - lines.from[k].x, lines.to[k].y - lines.from[k].y);
}

Lengths exact_lengths(const HeightGrid& grid, const Mesh& mesh, const Camera& camera,
                      bool visible) {
    TraceOptions options;
    options.edges = kMeshEdges;
    options.hidden = true;
    const ScreenScene page = testing::page(mesh.scene, camera);
    const Drawing drawing = testing::must(trace(page, options));
    Lengths out;
    for (std::size_t k = 0; k < drawing.lines.size(); ++k) {
        if ((drawing.lines.visible[k] != 0) != visible) continue;
        if (drawing.lines.polygons[k].y == kNone) continue;
        const std::uint32_t curve = curve_between(grid, mesh, drawing.lines.polygons[k]);
        if (curve != kNone) out[{drawing.lines.object[k], curve}] += length(drawing.lines, k);
    }
    return out;
}

Lengths horizon_lengths(const HeightGrid& grid, const Camera& camera, bool visible) {
    PlotOptions options;
    options.hidden = true;
    options.tolerance = 0;
    const Drawing drawing = testing::must(floating_horizon(grid, camera, options));
    Lengths out;
    for (std::size_t k = 0; k < drawing.lines.size(); ++k)
        if ((drawing.lines.visible[k] != 0) == visible)
            out[{drawing.lines.object[k], drawing.lines.polygons[k].x}] += length(drawing.lines, k);
    return out;
}

/// The corners of a curve in space.
std::vector<glm::dvec3> corners_of(const HeightGrid& grid, std::uint32_t object,
                                   std::uint32_t curve) {
    std::vector<glm::dvec3> out;
    const std::vector<double>& y = grid.layers[object].y;
    std::uint32_t number = 0;
    for (std::size_t k = 0; k < grid.z.size(); ++k) {
        if (grid.row_use[k] == LineUse::none || number++ != curve) continue;
        for (std::size_t i = 0; i < grid.x.size(); ++i)
            out.emplace_back(grid.x[i], y[grid.node(i, k)], grid.z[k]);
    }
    for (std::size_t i = 0; i < grid.x.size(); ++i) {
        if (grid.column_use[i] == LineUse::none || number++ != curve) continue;
        for (std::size_t k = 0; k < grid.z.size(); ++k)
            out.emplace_back(grid.x[i], y[grid.node(i, k)], grid.z[k]);
    }
    return out;
}

/// Whether a triangle is in front of a point: A. Moeller, B. Trumbore, 1997, in double precision.
bool is_hidden(const Scene& scene, glm::dvec3 p, glm::dvec3 to_eye) {
    for (const Corners t : scene.triangles) {
        const glm::dvec3 a = scene.positions[t.x], u = scene.positions[t.y] - a,
                         v = scene.positions[t.z] - a, h = glm::cross(to_eye, v);
        const double det = glm::dot(u, h);
        if (std::abs(det) < 1e-14) continue;
        const glm::dvec3 s = p - a, q = glm::cross(s, u);
        const double at_u = glm::dot(s, h) / det, at_v = glm::dot(to_eye, q) / det;
        if (at_u < 0 || at_v < 0 || at_u + at_v > 1) continue;
        if (glm::dot(v, q) / det > 1e-7) return true;
    }
    return false;
}

/// Visible or hidden length of a curve, by lines of sight from very many of its points.
double sampled_length(const HeightGrid& grid, const Mesh& mesh, const Camera& camera,
                      std::pair<std::uint32_t, std::uint32_t> curve, bool visible) {
    constexpr int kSamples = 20;  // of a piece
    const std::vector<glm::dvec3> corners = corners_of(grid, curve.first, curve.second);
    double sum = 0;
    for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
        const double pixels =
            glm::length(camera.pixel_of(corners[k + 1]) - camera.pixel_of(corners[k]));
        for (int n = 0; n < kSamples; ++n) {
            const glm::dvec3 p = corners[k] + (n + 0.5) / kSamples * (corners[k + 1] - corners[k]);
            if (is_hidden(mesh.scene, p, -camera.view_vector(p)) != visible)
                sum += pixels / kSamples;
        }
    }
    return sum;
}

/// Each curve to a thousandth of its length, visible and hidden. The page of exact hidden lines is
/// fine, but a grid: where a surface is seen at a grazing angle, lines of sight decide instead.
void expect_same(const HeightGrid& grid, const Mesh& mesh, const Camera& camera,
                 const std::string& what) {
    const Lengths found[2] = {horizon_lengths(grid, camera, false),
                              horizon_lengths(grid, camera, true)};
    int asked = 0;
    for (const bool visible : {true, false}) {
        Lengths exact = exact_lengths(grid, mesh, camera, visible);
        for (std::uint32_t object = 0; object < grid.layers.size(); ++object) {
            for (std::uint32_t n = 0; n < 200; ++n) {
                const std::pair curve(object, n);
                const auto length_of = [&](const Lengths& all) {
                    return all.contains(curve) ? all.at(curve) : 0.0;
                };
                const double whole = length_of(found[0]) + length_of(found[1]),
                             ours = length_of(found[visible ? 1 : 0]);
                if (std::abs(ours - length_of(exact)) <= 1e-3 * std::max(whole, 1.0)) continue;
                ++asked;
                EXPECT_NEAR(ours, sampled_length(grid, mesh, camera, curve, visible), 1e-3 * whole)
                    << what << (visible ? ", visible" : ", hidden") << ", curve " << n;
            }
        }
    }
    EXPECT_LE(asked, 4) << what;
}

const std::vector<std::pair<std::string, Height>> kFunctions = {
    {"ripple",
     [](double x, double z) {
         const double r = std::hypot(x, z);
         return r < 1e-9 ? 5.0 : 5 * std::sin(r) / r;
     }},
    {"monkey saddle", [](double x, double z) { return (x * x * x - 3 * x * z * z) / 150; }},
    {"waves", [](double x, double z) { return 1.5 * std::sin(x) * std::cos(1.3 * z); }},
    {"dome", [](double x, double z) { return 6 * std::exp(-(x * x + z * z) / 12); }},
    {"ridge", [](double x, double z) { return 3 / (1 + std::abs(x + 0.4 * z)); }},
};

double terrain(double x, double z) {
    double y = 0, scale = 1;
    for (int k = 0; k < 5; ++k, scale *= 0.5)
        y += scale * std::sin(1.1 * x / scale + 2 * k) * std::cos(0.9 * z / scale - k);
    return 1.6 * y;
}

std::vector<std::pair<std::string, CameraOptions>> views() {
    std::vector<std::pair<std::string, CameraOptions>> out;
    const auto add = [&](const std::string& name, Projection projection, glm::dvec3 direction) {
        CameraOptions options;
        options.projection = projection;
        options.direction = direction;
        out.emplace_back(name, options);
    };
    add("along z", Projection::orthographic, {0, -0.5, -1});
    add("along z from below", Projection::orthographic, {0.01, 0.4, -1});
    add("isometric", Projection::orthographic, {-1, -0.9, -1});
    add("across", Projection::orthographic, {1, -0.3, 0.2});
    add("from behind", Projection::orthographic, {0.4, -0.2, 1});
    add("from above", Projection::orthographic, {0, -1, -0.001});
    add("perspective", Projection::perspective, {-0.3, -0.5, -1});
    add("perspective from the side", Projection::perspective, {1, -0.2, -0.3});
    add("perspective from above", Projection::perspective, {0.1, -1, -0.2});
    add("cavalier", Projection::cavalier, {0, 0, -1});
    return out;
}

TEST(FloatingHorizon, SeesWhatExactHiddenLinesSee) {
    const std::size_t cells = testing::amount(160, 64, 20), step = 7;
    std::vector<std::pair<std::string, Height>> surfaces = kFunctions;
    surfaces.emplace_back("terrain", terrain);
    for (const auto& [surface, height] : surfaces) {
        const HeightGrid grid = grid_of({height}, 9, cells, step);
        const Mesh mesh = mesh_of(grid);
        for (const auto& [view, options] : views()) {
            const Camera camera =
                testing::must(make_camera(options, mesh.scene.bounds, {1024, 768}));
            expect_same(grid, mesh, camera, surface + ", " + view);
        }
    }
}

TEST(FloatingHorizon, SurfacesThatCrossHideEachOther) {
    const HeightGrid grid =
        grid_of({kFunctions[0].second, [](double x, double z) { return 0.25 * x + 0.1 * z + 0.3; },
                 terrain},
                9, testing::amount(100, 50, 20), 7);
    const Mesh mesh = mesh_of(grid);
    for (const auto& [view, options] : views()) {
        const Camera camera = testing::must(make_camera(options, mesh.scene.bounds, {1024, 768}));
        expect_same(grid, mesh, camera, view);
    }
}

TEST(FloatingHorizon, OfSurfacesThatCoincideTheFirstIsSeen) {
    const HeightGrid one = grid_of({terrain}, 9, 30, 5),
                     two = grid_of({terrain, terrain}, 9, 30, 5);
    for (const auto& [view, options] : views()) {
        const Camera camera = testing::must(make_camera(options, one.bounds(), {1024, 768}));
        const Lengths alone = horizon_lengths(one, camera, true),
                      both = horizon_lengths(two, camera, true);
        double second = 0;
        for (const auto& [curve, length] : both) {
            if (curve.first == 0) {
                EXPECT_NEAR(length, alone.at(curve), 1e-6) << view;
            } else {
                second += length;
            }
        }
        EXPECT_LT(second, 1) << view;
    }
}

TEST(FloatingHorizon, AnEyeAmongTheHillsSeesAllAround) {
    const HeightGrid grid = grid_of({terrain}, 9, 60, 7);
    const Mesh mesh = mesh_of(grid);
    for (int turn = 0; turn < 8; ++turn) {
        CameraOptions options;
        options.eye = glm::dvec3(0.3, 4.1, 0.7);
        const double angle = 0.8 * turn;
        options.direction = glm::dvec3(std::cos(angle), -0.1 * turn, std::sin(angle));
        options.fov = 70;
        options.near_plane = 1e-3;
        const Camera camera = testing::must(make_camera(options, mesh.scene.bounds, {1024, 768}));
        expect_same(grid, mesh, camera, "turn " + std::to_string(turn));
    }
}

TEST(FloatingHorizon, DoesNotDependOnThreads) {
    const HeightGrid grid = grid_of({terrain, kFunctions[1].second}, 9, 50, 5);
    const Camera camera = testing::must(make_camera({}, grid.bounds(), {640, 480}));
    PlotOptions options;
    options.threads = 1;
    const Drawing one = testing::must(floating_horizon(grid, camera, options));
    options.threads = 7;
    const Drawing seven = testing::must(floating_horizon(grid, camera, options));
    EXPECT_EQ(one.lines.from, seven.lines.from);
    EXPECT_EQ(one.lines.to, seven.lines.to);
    EXPECT_EQ(one.lines.kind, seven.lines.kind);
}

}  // namespace
}  // namespace sightline
