// Scenes for tests: small, hostile and reproducible from a seed.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <initializer_list>
#include <string>
#include <vector>

#include "sightline/sightline.hpp"

namespace sightline::testing {

/// A small generator of our own (splitmix64), so that a seed means the same scene everywhere.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    std::uint64_t next();
    /// In [0, n).
    std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(next() % n); }
    /// In [lo, hi).
    double uniform(double lo, double hi);
    glm::dvec3 point(double extent = 1);
    bool chance(double p) { return uniform(0, 1) < p; }

private:
    std::uint64_t state_;
};

/// Collects polygons as one object of one matt grey material.
class SceneBuilder {
public:
    SceneBuilder();
    /// A fan; corners are this polygon's own.
    SceneBuilder& polygon(std::initializer_list<glm::dvec3> corners);
    SceneBuilder& triangle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) { return polygon({a, b, c}); }
    SceneBuilder& quad(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d) {
        return polygon({a, b, c, d});
    }
    /// Twelve triangles, fronts outside.
    SceneBuilder& box(glm::dvec3 lo, glm::dvec3 hi);
    /// One for each corner so far, polygon by polygon.
    void vertex_normals(const std::vector<glm::vec3>& normals);
    void vertex_colors(const std::vector<glm::vec4>& colors);

    /// Finished, with equal corners joined.
    [[nodiscard]] Scene build() const;
    [[nodiscard]] std::size_t size() const { return scene.triangles.size(); }

    Scene scene;  ///< to be changed at will; not finished
};

/// A scene with a mixture of what hurts: coplanar walls and decals, crossing and touching faces,
/// shared edges and vertices, slivers and needles, copies, corners on sample points.
[[nodiscard]] Scene hostile_scene(std::uint64_t seed);

/// A view of it: any projection, sometimes with the eye among the faces.
[[nodiscard]] Camera hostile_camera(const Scene& scene, std::uint64_t seed, Resolution resolution);

/// The scene with its triangles in another order; order[new id] = old id.
[[nodiscard]] Scene shuffled(const Scene& scene, std::uint64_t seed,
                             std::vector<std::uint32_t>& order);

/// A closed sphere of latitude and longitude quads.
[[nodiscard]] Scene sphere_scene(std::uint32_t rings, std::uint32_t sectors);

/// The value of a Result, or a failed test.
template <class T>
T must(Result<T> result) {
    if (!result.ok()) throw std::runtime_error(result.error().message);
    return std::move(result).value();
}

/// Runs a registered algorithm by name.
[[nodiscard]] Visibility run(const std::string& algorithm, const ScreenScene& screen,
                             const ResolveOptions& options = {});

/// Samples whose id or depth differ.
[[nodiscard]] std::uint64_t count_differences(const Visibility& a, const Visibility& b);

}  // namespace sightline::testing
