// Growing scenes: 1-to-4 subdivision, repetition, random triangles. The arithmetic on positions is
// that of single precision throughout (see the header), in a fixed order of operations.
#include "sightline/generate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <string>
#include <unordered_map>
#include <utility>

#include "scene/finish.hpp"

namespace sightline {
namespace {

Error too_large(const char* what) {
    return {ErrorKind::bad_option,
            std::string(what) + " makes more than 2^30 triangles; ask for less"};
}

/// The middles of the sides of an indexed attribute, each made once.
template <class T, class Middle>
class SideMiddles {
public:
    SideMiddles(AlignedVector<T>& values, Middle middle, std::size_t expected)
        : values_(values), middle_(middle) {
        index_.reserve(expected);
    }
    std::uint32_t operator()(std::uint32_t a, std::uint32_t b) {
        if (a > b) std::swap(a, b);
        const auto fresh = static_cast<std::uint32_t>(values_.size());
        const auto [entry, is_new] = index_.try_emplace(std::uint64_t{a} << 32 | b, fresh);
        if (is_new) values_.push_back(middle_(values_[a], values_[b]));
        return entry->second;
    }

private:
    AlignedVector<T>& values_;
    Middle middle_;
    std::unordered_map<std::uint64_t, std::uint32_t> index_;
};

/// The four children of each triangle, in one index array; kNone (no attribute) is inherited.
template <class T, class Middle>
AlignedVector<Corners> split_corners(const AlignedVector<Corners>& corners,
                                     AlignedVector<T>& values, Middle middle) {
    AlignedVector<Corners> children;
    children.reserve(corners.size() * 4);
    SideMiddles<T, Middle> mid(values, middle, corners.size() * 3 / 2 + 16);
    for (const Corners& t : corners) {
        if (t.x == kNone || t.y == kNone || t.z == kNone) {
            children.insert(children.end(), 4, Corners(kNone));
            continue;
        }
        const std::uint32_t ab = mid(t.x, t.y), bc = mid(t.y, t.z), ca = mid(t.z, t.x);
        children.insert(children.end(),
                        {{t.x, ab, ca}, {ab, t.y, bc}, {ca, bc, t.z}, {ab, bc, ca}});
    }
    return children;
}

double middle_of(double a, double b) {
    return double{0.5f * (static_cast<float>(a) + static_cast<float>(b))};
}

glm::vec3 middle_normal(glm::vec3 a, glm::vec3 b) {
    const glm::vec3 sum = a + b;
    const float length = std::sqrt(sum.x * sum.x + sum.y * sum.y + sum.z * sum.z);
    return length > 0 ? sum / length : a;  // opposite normals have no middle
}

/// Sides of a child that lie on a side of the source polygon. Bit k: from corner k to k + 1.
std::array<std::uint8_t, 4> child_edges(std::uint8_t parent) {
    const auto bit = [&](unsigned side) { return (parent >> side) & 1u; };
    const auto bits = [](unsigned s0, unsigned s1, unsigned s2) {
        return static_cast<std::uint8_t>(s0 | s1 << 1 | s2 << 2);
    };
    return {bits(bit(0), 0, bit(2)), bits(bit(0), bit(1), 0), bits(0, bit(1), bit(2)), 0};
}

Scene subdivide_once(Scene scene) {
    scene.triangles =
        split_corners(scene.triangles, scene.positions, [](glm::dvec3 a, glm::dvec3 b) {
            return glm::dvec3(middle_of(a.x, b.x), middle_of(a.y, b.y), middle_of(a.z, b.z));
        });
    scene.triangle_normals = split_corners(scene.triangle_normals, scene.normals, middle_normal);
    scene.triangle_colors = split_corners(scene.triangle_colors, scene.colors,
                                          [](glm::vec4 a, glm::vec4 b) { return 0.5f * (a + b); });
    std::vector<std::uint32_t> polygons;
    for (const std::uint32_t polygon : scene.triangle_polygon)
        polygons.insert(polygons.end(), 4, polygon);
    scene.triangle_polygon = std::move(polygons);
    std::vector<std::uint8_t> edges;
    for (const std::uint8_t parent : scene.polygon_edges) {
        const auto children = child_edges(parent);
        edges.insert(edges.end(), children.begin(), children.end());
    }
    scene.polygon_edges = std::move(edges);
    for (Object& object : scene.objects) {
        object.first_triangle *= 4;
        object.triangle_count *= 4;
    }
    return scene;
}

/// Appends `part` moved by `offset`; its materials, lights and camera are those of `scene`.
void append_copy(Scene& scene, const Scene& part, glm::dvec3 offset) {
    const auto size = [](const auto& values) { return static_cast<std::uint32_t>(values.size()); };
    const std::uint32_t first_position = size(scene.positions),
                        first_triangle = size(scene.triangles);
    const std::uint32_t first_normal = size(scene.normals), first_color = size(scene.colors);
    const std::uint32_t first_polygon =
        scene.objects.empty()
            ? 0
            : scene.objects.back().first_polygon + scene.objects.back().polygon_count;
    const auto shifted = [](const Corners& c, std::uint32_t by) {
        return c.x == kNone ? c : c + by;
    };
    for (const glm::dvec3& p : part.positions) {
        const glm::vec3 moved = p + offset;  // rounds to float
        scene.positions.emplace_back(moved);
    }
    for (const Corners& c : part.triangles) scene.triangles.push_back(c + first_position);
    for (const Corners& c : part.triangle_normals) {
        scene.triangle_normals.push_back(shifted(c, first_normal));
    }
    for (const Corners& c : part.triangle_colors) {
        scene.triangle_colors.push_back(shifted(c, first_color));
    }
    for (const std::uint32_t p : part.triangle_polygon) {
        scene.triangle_polygon.push_back(p + first_polygon);
    }
    const auto append = [](auto& to, const auto& from) {
        to.insert(to.end(), from.begin(), from.end());
    };
    append(scene.normals, part.normals);
    append(scene.colors, part.colors);
    append(scene.polygon_edges, part.polygon_edges);
    const std::size_t meshes = part.objects.size() - part.quadrics.size();
    for (std::size_t o = 0; o < meshes; ++o) {
        Object object = part.objects[o];
        object.first_triangle += first_triangle;
        object.first_polygon += first_polygon;
        scene.objects.push_back(std::move(object));
    }
    scene.counts.concave_polygons += part.counts.concave_polygons;
    scene.counts.ignored_primitives += part.counts.ignored_primitives;
}

/// Appends the quadrics of `part`, moved by `offset`: they come after all triangles.
void append_quadrics(Scene& scene, const Scene& part, glm::dvec3 offset) {
    const std::size_t first = part.objects.size() - part.quadrics.size();
    for (std::size_t k = 0; k < part.quadrics.size(); ++k) {
        Quadric quadric = part.quadrics[k];
        quadric.frame[3] += glm::dvec4(offset, 0);
        Object object = part.objects[first + k];
        object.first_triangle = scene.triangle_count();
        object.first_polygon = scene.objects.empty() ? 0
                                                     : scene.objects.back().first_polygon +
                                                           scene.objects.back().polygon_count;
        scene.objects.push_back(std::move(object));
        scene.quadrics.push_back(quadric);
    }
}

/// A linear congruential generator (Knuth's MMIX), for numbers that are the same everywhere.
class Random {
public:
    explicit Random(std::uint32_t seed) : state_(seed) {}
    /// In [0, 1), a multiple of 2^-24.
    double next() {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<double>(state_ >> 40) * 0x1p-24;
    }
    glm::dvec3 point() {
        const double x = next(), y = next(), z = next();
        return {x, y, z};
    }
    /// A unit vector, every direction alike: a point of the unit ball, pushed out to the sphere.
    glm::dvec3 direction() {
        while (true) {
            const glm::dvec3 p = 2.0 * point() - 1.0;
            const double square = p.x * p.x + p.y * p.y + p.z * p.z;
            if (square > 0x1p-20 && square <= 1) return p / std::sqrt(square);
        }
    }
    /// An equilateral triangle about the origin with its corners on the unit sphere, turned at
    /// random.
    std::array<glm::dvec3, 3> triangle() {
        constexpr double kHalfRoot3 = 0.86602540378443864676;
        const glm::dvec3 normal = direction();
        glm::dvec3 across;
        double square = 0;
        do {  // until it is not along the normal
            across = glm::cross(normal, direction());
            square = glm::dot(across, across);
        } while (square < 0x1p-20);
        const glm::dvec3 first = across / std::sqrt(square);
        const glm::dvec3 side = kHalfRoot3 * glm::cross(normal, first);
        return {first, -0.5 * first + side, -0.5 * first - side};
    }

private:
    std::uint64_t state_;
};

/// The circumradius with which the triangles that `seed` makes cover the front of the box
/// `complexity` times over.
double common_radius(std::uint32_t count, std::uint32_t seed, const RandomBox& box) {
    Random random(seed);
    double area = 0;  // of all on the xy plane, with radius 1
    for (std::uint32_t t = 0; t < count; ++t) {
        const auto corners = random.triangle();
        const glm::dvec3 u = corners[1] - corners[0], v = corners[2] - corners[0];
        area += 0.5 * std::abs(u.x * v.y - u.y * v.x);
        random.point();  // where it will stand
    }
    const double wanted = std::sqrt(box.complexity * box.size.x * box.size.y / area);
    return std::min(wanted, 0.5 * std::min({box.size.x, box.size.y, box.size.z}));
}

}  // namespace

Result<Scene> subdivide(const Scene& scene, int times) {
    if (times < 0)
        return Error{ErrorKind::bad_option, "a mesh can't be subdivided less than 0 times"};
    std::uint64_t triangles = scene.triangle_count();
    for (int i = 0; i < times; ++i) {
        triangles *= 4;
        if (triangles > kMaxGeneratedTriangles) return too_large("subdividing so often");
    }
    Scene result = scene;
    for (int i = 0; i < times; ++i) result = subdivide_once(std::move(result));
    if (times > 0) finish_derived_scene(result);
    return result;
}

Result<Scene> repeat(const Scene& scene, const RepeatOptions& options) {
    if (options.copies == 0)
        return Error{ErrorKind::bad_option, "a scene can't be repeated 0 times"};
    if (std::uint64_t{scene.triangle_count()} * options.copies > kMaxGeneratedTriangles) {
        return too_large("repeating so often");
    }
    Scene result;
    result.materials = scene.materials;
    result.lights = scene.lights;
    result.camera = scene.camera;
    result.offset = scene.offset;
    result.rounding = scene.rounding;
    result.positions.reserve(scene.positions.size() * options.copies);
    result.triangles.reserve(scene.triangles.size() * options.copies);
    for (std::uint32_t i = 0; i < options.copies; ++i) {
        const std::uint32_t moved = options.farthest_first ? options.copies - 1 - i : i;
        append_copy(result, scene, static_cast<double>(moved) * options.step);
    }
    for (std::uint32_t i = 0; i < options.copies; ++i) {
        const std::uint32_t moved = options.farthest_first ? options.copies - 1 - i : i;
        append_quadrics(result, scene, static_cast<double>(moved) * options.step);
    }
    finish_derived_scene(result);
    return result;
}

Result<Scene> random_triangles(std::uint32_t count, std::uint32_t seed, const RandomBox& box) {
    if (count == 0) return Error{ErrorKind::bad_option, "a scene needs at least 1 triangle"};
    if (count > kMaxGeneratedTriangles) return too_large("generating so many");
    const double radius = common_radius(count, seed, box);
    Scene scene;
    scene.positions.reserve(std::size_t{3} * count);
    scene.triangles.reserve(count);
    Random random(seed);
    for (std::uint32_t t = 0; t < count; ++t) {
        auto corners = random.triangle();
        for (glm::dvec3& corner : corners) corner *= radius;
        const glm::dvec3 low = glm::min(corners[0], glm::min(corners[1], corners[2]));
        const glm::dvec3 high = glm::max(corners[0], glm::max(corners[1], corners[2]));
        const glm::dvec3 place = random.point() * (box.size - (high - low));
        for (const glm::dvec3& corner : corners) {
            const glm::vec3 rounded = place + (corner - low);  // rounds to float
            scene.positions.emplace_back(rounded);
        }
        scene.triangles.emplace_back(3 * t, 3 * t + 1, 3 * t + 2);
        scene.triangle_polygon.push_back(t);
    }
    scene.polygon_edges.assign(count, 7);
    scene.materials.emplace_back();
    Object object;
    object.name = "random";
    object.triangle_count = object.polygon_count = count;
    scene.objects.push_back(std::move(object));
    finish_scene(scene);
    return scene;
}

}  // namespace sightline
