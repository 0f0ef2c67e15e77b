// Which offset, and why subtracting it rounds nothing.
//
// Let s be the largest side of the scene's box and G the smallest power of two from 2 s on. Where
// the middle c of the box is at least 2 G from 0 along an axis, the offset o is the multiple of G
// next to c: |o - c| <= G / 2. Every coordinate p of the scene has |p - c| <= s / 2 <= G / 4, so
// (for c > 0)
//
//     o / 2 <= c / 2 + G / 4 <= c - G / 4 <= p <= c + G / 4 <= 2 c - G <= 2 o,
//
// because c >= 2 G; and of two doubles with o / 2 <= p <= 2 o the difference is a double (P.
// Sterbenz, "Floating-point computation", 1974, theorem 4.3.1). Adding o to it gives p again, for p
// is a double.
//
// o depends on the place in steps of G only: a scene that is moved by a multiple of G from a place
// about the origin gets its old coordinates back, bit for bit.
#include "scene/recentre.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "scene/bounds.hpp"
#include "scene/motion.hpp"

namespace sightline {
namespace {

// From this many G on a scene lies far away. Nearer ones keep their coordinates: what is relative
// to the largest coordinate (2^-22 of it, see sheets.cpp) is then below 2^-22 * 16 G < 2^-16 s, a
// 64th of a pixel of a picture 1,024 pixels wide that shows the whole scene.
constexpr double kFar = 16;
// Of an axis, whose coordinates are moved; see above.
constexpr double kFarAlongAxis = 2;

/// The smallest power of two that is not less. Precondition: positive, finite.
double power_of_two_from(double value) {
    int exponent = 0;
    const double fraction = std::frexp(value, &exponent);  // 1/2 <= fraction < 1
    return std::ldexp(1.0, fraction == 0.5 ? exponent - 1 : exponent);
}

/// That of the same movement between places relative to the offset: x -> A x + t becomes
/// x -> A x + ((A - 1) offset + t). Exact for a translation.
glm::dmat4 relative(glm::dmat4 frame, const glm::dvec3& offset) {
    for (int row = 0; row < 3; ++row) {
        double shift = 0;
        for (int column = 0; column < 3; ++column)
            shift += (frame[column][row] - (row == column ? 1 : 0)) * offset[column];
        frame[3][row] += shift;
    }
    return frame;
}

/// For the box at rest and, where something moves, for that of all frames too.
glm::dvec3 offset_of(const Scene& scene) {
    Box box = scene.bounds;
    for (const Quadric& quadric : scene.quadrics) box = joined(box, bounds_of(quadric));
    const glm::dvec3 at_rest = offset_for(box);
    if (scene.motions.empty() || at_rest == glm::dvec3(0)) return at_rest;
    return offset_for(joined(box, reach_of(scene)));
}

}  // namespace

glm::dvec3 offset_for(const Box& box) {
    glm::dvec3 offset{0, 0, 0};
    if (box.empty()) return offset;
    const glm::dvec3 sides = box.extent(), far = glm::max(glm::abs(box.lo), glm::abs(box.hi));
    const double size = std::max({sides.x, sides.y, sides.z});
    if (!(size > 0) || !std::isfinite(size)) return offset;
    const double step = power_of_two_from(2 * size);
    if (!(std::max({far.x, far.y, far.z}) >= kFar * step)) return offset;
    for (int axis = 0; axis < 3; ++axis) {
        const double middle = box.lo[axis] + 0.5 * sides[axis];
        if (!(std::abs(middle) >= kFarAlongAxis * step)) continue;
        // Doubles from 2^52 steps on are multiples of the step themselves.
        const double steps = middle / step;
        offset[axis] = std::abs(steps) < 0x1p52 ? std::nearbyint(steps) * step : middle;
    }
    return offset;
}

void move_to_offset(Scene& scene, const glm::dvec3& offset) {
    scene.offset = offset;
    if (offset == glm::dvec3(0)) return;
    using Range = tbb::blocked_range<std::size_t>;
    tbb::parallel_for(Range(0, scene.positions.size(), 4096), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) scene.positions[i] -= offset;
    });
    for (Quadric& quadric : scene.quadrics) quadric.frame[3] -= glm::dvec4(offset, 0);
    for (Light& light : scene.lights) light.position -= offset;
    for (Motion& motion : scene.motions)
        for (glm::dmat4& frame : motion.frames) frame = relative(frame, offset);
}

bool recentre(Scene& scene) {
    if (scene.offset != glm::dvec3(0)) return false;
    const glm::dvec3 offset = offset_of(scene);
    move_to_offset(scene, offset);
    return offset != glm::dvec3(0);
}

}  // namespace sightline
