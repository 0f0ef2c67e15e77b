// A reader of our own on any bytes: what it hands over keeps every statement made on a soup, with
// all indices in range, and becomes a scene or an error of one line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string_view>

#include "scene/finish.hpp"
#include "scene/load/build.hpp"
#include "scene/load/reader.hpp"
#include "scene_check.hpp"
#include "sightline/scene.hpp"

namespace sightline::fuzz {

inline void check_mesh(const load::SoupMesh& mesh) {
    require(!mesh.polygon_sizes.empty() && mesh.position_count() > 0);
    require(mesh.positions.empty() || mesh.precise_positions.empty());
    for (const std::uint32_t size : mesh.polygon_sizes) require(size >= 3);
    require(std::accumulate(mesh.polygon_sizes.begin(), mesh.polygon_sizes.end(),
                            std::uint64_t{0}) == mesh.corners.size());
    for (const std::uint32_t corner : mesh.corners) require(corner < mesh.position_count());
    require(mesh.colors.empty() || mesh.colors.size() == mesh.position_count());
    if (mesh.has_polygon_normals) {
        require(mesh.normal_corners.empty() && mesh.normals.size() == mesh.polygon_sizes.size());
        return;
    }
    if (mesh.normal_corners.empty()) {
        require(mesh.normals.empty() || mesh.normals.size() == mesh.position_count());
        return;
    }
    require(mesh.normal_corners.size() == mesh.corners.size());
    for (const std::uint32_t normal : mesh.normal_corners) {
        require(normal == kNone || normal < mesh.normals.size());
    }
}

inline int check_reader(std::string_view format, const std::uint8_t* data, std::size_t size) {
    constexpr std::size_t kMemory = std::size_t{64} << 20;
    const load::ReadContext context("input", "", 20, kMemory);
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    const Result<load::Soup> soup = load::read_own_format(format, bytes, context);
    if (!soup) {
        check_message(soup.error());
        return 0;
    }
    std::uint64_t triangles = 0;
    for (const load::SoupMesh& mesh : soup->meshes) {
        check_mesh(mesh);
        require(mesh.material == kNone || mesh.material < soup->materials.size());
        triangles += mesh.corners.size() - 2 * mesh.polygon_sizes.size();
    }
    for (const load::SoupObject& object : soup->objects) require(object.mesh < soup->meshes.size());
    load::SceneBuilder builder(kMemory);
    load::Placement placement;
    placement.file = "input";
    if (const Status built = builder.append(*soup, placement); !built) {
        check_message(built.error());
        return 0;
    }
    Scene scene = builder.take();
    require(scene.triangle_count() == triangles);
    finish_joined_scene(scene);
    check(scene);
    return 0;
}

}  // namespace sightline::fuzz
