// Small meshes and files for the tests of loading.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sightline/load.hpp"
#include "sightline/scene.hpp"

namespace sightline::scene_test {

/// Outward-facing unit cube from the origin, shifted; 12 triangles, joined corners.
inline void append_cube(Scene& scene, const glm::dvec3& shift) {
    const auto base = static_cast<std::uint32_t>(scene.positions.size());
    for (unsigned i = 0; i < 8; ++i) {
        scene.positions.push_back(shift + glm::dvec3(i & 1u, (i >> 1) & 1u, (i >> 2) & 1u));
    }
    constexpr unsigned kQuads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& q : kQuads) {
        scene.triangles.emplace_back(base + q[0], base + q[1], base + q[2]);
        scene.triangles.emplace_back(base + q[0], base + q[2], base + q[3]);
    }
}

/// Makes all triangles of a scene one object of triangular polygons.
inline void make_one_object(Scene& scene) {
    const std::uint32_t n = scene.triangle_count();
    scene.triangle_polygon.resize(n);
    for (std::uint32_t t = 0; t < n; ++t) scene.triangle_polygon[t] = t;
    scene.polygon_edges.assign(n, 7);
    scene.materials.resize(1);
    Object object;
    object.name = "object";
    object.triangle_count = object.polygon_count = n;
    scene.objects = {object};
}

inline Scene cube_scene() {
    Scene scene;
    append_cube(scene, {0, 0, 0});
    make_one_object(scene);
    return scene;
}

inline Result<Scene> load_one(const std::string& path, const LoadOptions& options = {}) {
    const std::vector<std::string> paths{path};
    return load_scene(paths, options);
}

inline Result<Scene> load_text(const std::string& text, const std::string& format) {
    LoadOptions options;
    options.format = format;
    return load_scene_from_memory(std::as_bytes(std::span(text)), "input." + format, options);
}

/// The scene, or a failed test and an empty scene.
inline Scene loaded(Result<Scene> result) {
    if (result) return std::move(result).value();
    ADD_FAILURE() << result.error().message;
    return {};
}

/// The message of an error after checking that it is one line.
inline std::string message_of(const Result<Scene>& result) {
    if (result.ok()) {
        ADD_FAILURE() << "loaded, but should not";
        return "";
    }
    EXPECT_EQ(result.error().message.find('\n'), std::string::npos);
    return result.error().message;
}

/// A binary or text file's bytes from plain values.
template <class... Values>
std::string raw(Values... values) {
    std::string bytes;
    (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
    return bytes;
}

}  // namespace sightline::scene_test
