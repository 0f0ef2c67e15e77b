// Moving objects: their places in a frame, and the box of all frames.
#include "scene/motion.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "math/frame.hpp"
#include "scene/bounds.hpp"
#include "scene/finish.hpp"

namespace sightline {
namespace {

/// Objects first .. end-1.
struct ObjectRange {
    std::uint32_t first, end;
};

ObjectRange objects_of(const Motion& motion) {
    return {motion.first_object, motion.first_object + motion.object_count};
}

/// Calls visit(triangle) for the triangles of some objects.
template <class Visit>
void for_each_triangle(const Scene& scene, ObjectRange objects, const Visit& visit) {
    for (std::uint32_t o = objects.first; o < objects.end; ++o) {
        const Object& object = scene.objects[o];
        for (std::uint32_t i = 0; i < object.triangle_count; ++i) visit(object.first_triangle + i);
    }
}

/// Calls visit(quadric) for the numbers of the quadrics among some objects.
template <class Visit>
void for_each_quadric(const Scene& scene, ObjectRange objects, const Visit& visit) {
    const std::size_t first = scene.objects.size() - scene.quadrics.size();
    for (std::size_t o = std::max<std::size_t>(first, objects.first); o < objects.end; ++o) {
        visit(o - first);
    }
}

/// The different ones among the indices of the triangles' corners; `corners` may be empty.
std::vector<std::uint32_t> used_by(const Scene& scene, ObjectRange objects,
                                   const AlignedVector<Corners>& corners) {
    std::vector<std::uint32_t> used;
    if (corners.empty()) return used;
    for_each_triangle(scene, objects, [&](std::uint32_t t) {
        for (int k = 0; k < 3; ++k) {
            if (corners[t][k] != kNone) used.push_back(corners[t][k]);
        }
    });
    std::ranges::sort(used);
    used.erase(std::unique(used.begin(), used.end()), used.end());
    return used;
}

glm::vec3 turned(const glm::vec3& normal, const math::Frame& frame) {
    const glm::dvec3 n = frame.normal(glm::dvec3(normal));
    const double length = std::sqrt(glm::dot(n, n));
    return length > 0 && std::isfinite(length) ? glm::vec3(n / length) : normal;
}

/// A mirror turns fronts into backs, so the corners run backwards; the first stays the first.
void turn_round(Scene& scene, std::uint32_t t) {
    const auto swap = [t](AlignedVector<Corners>& corners) {
        if (!corners.empty()) std::swap(corners[t].y, corners[t].z);
    };
    swap(scene.triangles);
    swap(scene.triangle_normals);
    swap(scene.triangle_colors);
    if (scene.polygon_edges.empty()) return;
    // Sides 0 and 2 change places, side 1 turns round.
    const unsigned edges = scene.polygon_edges[t];
    scene.polygon_edges[t] =
        static_cast<std::uint8_t>((edges & 2) | (edges & 1) << 2 | (edges >> 2 & 1));
}

void move(Scene& scene, ObjectRange objects, const glm::dmat4& by) {
    const math::Frame frame(by);
    for (const std::uint32_t p : used_by(scene, objects, scene.triangles)) {
        scene.positions[p] = frame.point(scene.positions[p]);
    }
    for (const std::uint32_t n : used_by(scene, objects, scene.triangle_normals)) {
        scene.normals[n] = turned(scene.normals[n], frame);
    }
    if (frame.determinant() < 0) {
        for_each_triangle(scene, objects, [&](std::uint32_t t) { turn_round(scene, t); });
    }
    for_each_quadric(scene, objects, [&](std::size_t k) {
        scene.quadrics[k] = transformed(scene.quadrics[k], by);
    });
}

/// Which objects move, one byte each.
std::vector<std::uint8_t> moving_objects(const Scene& scene) {
    std::vector<std::uint8_t> moving(scene.objects.size(), 0);
    for (const Motion& motion : scene.motions) {
        const ObjectRange objects = objects_of(motion);
        std::fill(moving.begin() + objects.first, moving.begin() + objects.end, std::uint8_t{1});
    }
    return moving;
}

Box bounds_at_rest(const Scene& scene, ObjectRange objects) {
    const std::vector<std::uint32_t> used = used_by(scene, objects, scene.triangles);
    Box box = bounds_of_points(
        static_cast<std::uint32_t>(used.size()),
        [&](std::uint32_t i) -> const glm::dvec3& { return scene.positions[used[i]]; });
    for_each_quadric(scene, objects,
                     [&](std::size_t k) { box = joined(box, bounds_of(scene.quadrics[k])); });
    return box;
}

Box bounds_of_motion(const Scene& scene, const Motion& motion) {
    Box box;
    const ObjectRange objects = objects_of(motion);
    const std::vector<std::uint32_t> used = used_by(scene, objects, scene.triangles);
    for (const glm::dmat4& by : motion.frames) {
        const math::Frame frame(by);
        const auto point = [&](std::uint32_t i) { return frame.point(scene.positions[used[i]]); };
        box = joined(box, bounds_of_points(static_cast<std::uint32_t>(used.size()), point));
        for_each_quadric(scene, objects, [&](std::size_t k) {
            box = joined(box, bounds_of(transformed(scene.quadrics[k], by)));
        });
    }
    return box;
}

}  // namespace

Box reach_of(const Scene& scene) {
    if (scene.motions.empty()) return scene.bounds;
    Box box;
    const std::vector<std::uint8_t> moving = moving_objects(scene);
    for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
        if (moving[o] == 0) box = joined(box, bounds_at_rest(scene, {o, o + 1}));
    }
    for (const Motion& motion : scene.motions) box = joined(box, bounds_of_motion(scene, motion));
    return box;
}

Scene posed(const Scene& scene, std::uint32_t frame) {
    Scene result = scene;
    if (scene.motions.empty()) return result;
    result.motions.clear();
    for (const Motion& motion : scene.motions) {
        if (motion.frames.empty()) continue;
        const std::size_t last = motion.frames.size() - 1;
        move(result, objects_of(motion), motion.frames[std::min<std::size_t>(frame, last)]);
    }
    finish_posed_scene(result);
    result.reach = scene.reach;
    return result;
}

std::vector<std::uint8_t> moving_triangles(const Scene& scene) {
    std::vector<std::uint8_t> moving;
    if (scene.motions.empty()) return moving;
    moving.resize(scene.triangle_count(), 0);
    for (const Motion& motion : scene.motions) {
        for_each_triangle(scene, objects_of(motion), [&](std::uint32_t t) { moving[t] = 1; });
    }
    return moving;
}

}  // namespace sightline
