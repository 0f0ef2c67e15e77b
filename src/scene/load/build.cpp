#include "scene/load/build.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "scene/load/text.hpp"
#include "sightline/image.hpp"

namespace sightline::load {
namespace {

/// Memory that a triangle takes in a finished scene and while it is finished: three indices each
/// for corners, normals and colours, half a position, its sheet, and the tables that join and pair.
constexpr std::size_t kBytesPerTriangle = 128;

/// Linear light of a colour from a file. Display colours have 8 bits in practice, so the table for
/// those serves.
float linear_channel(float value, bool srgb) {
    const float clamped = value > 0 ? std::min(value, 1.0f) : 0.0f;  // NaN becomes 0
    return srgb ? from_srgb8(static_cast<std::uint8_t>(std::lround(255.0f * clamped))) : clamped;
}

glm::vec3 linear_color(const glm::vec3& color, bool srgb) {
    return {linear_channel(color.x, srgb), linear_channel(color.y, srgb),
            linear_channel(color.z, srgb)};
}

void apply(const MaterialOverride& what, Material& material) {
    material.base_color = what.base_color.value_or(material.base_color);
    material.opacity = what.opacity.value_or(material.opacity);
    material.specular = what.specular.value_or(material.specular);
    material.shininess = what.shininess.value_or(material.shininess);
}

/// What carries normals along with a transform, up to length: the inverse transpose, as cofactors
/// (so a flattening transform works too) with the sign of a mirror taken out.
glm::dmat3 normal_transform(const glm::dmat3& m) {
    const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]),
                               glm::cross(m[0], m[1]));
    return glm::determinant(m) < 0 ? -cofactors : cofactors;
}

const char* fault_of(const glm::dvec3& p) {
    double largest = 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (std::isnan(p[axis])) return "a coordinate that is not a number (NaN)";
        largest = std::max(largest, std::abs(p[axis]));
    }
    if (std::isinf(largest)) return "an infinite coordinate";
    return largest > kLargestCoordinate ? "a coordinate beyond 1e30" : nullptr;
}

}  // namespace

struct SceneBuilder::Instance {
    const SoupMesh& mesh;
    const Placement& placement;
    std::string name;
    glm::dmat4 transform;
    glm::dmat3 normal_matrix;
    bool mirrored;
    bool srgb;
};

Status SceneBuilder::check_size(const Soup& soup, const Placement& placement) const {
    std::uint64_t triangles = 0;
    for (const SoupObject& object : soup.objects) {
        const SoupMesh& mesh = soup.meshes[object.mesh];
        triangles += mesh.corners.size() - 2 * mesh.polygon_sizes.size();
        // 2^32 - 2 triangles in all; positions stay below that too, as each has a corner.
        if (triangles + scene_.triangles.size() > kNone - 1u) {
            return Error{ErrorKind::bad_input,
                         fmt::format("{}: more than 4,294,967,294 triangles; use a simpler model",
                                     placement.file)};
        }
    }
    if (triangles == 0) {
        return Error{
            ErrorKind::bad_input,
            fmt::format("{}: no triangles in it ({} points and lines, which are not drawn); "
                        "use a model with faces",
                        placement.file, soup.ignored_primitives)};
    }
    if ((triangles + scene_.triangles.size()) > memory_limit_ / kBytesPerTriangle) {
        return Error{
            ErrorKind::bad_input,
            fmt::format("{}: {} triangles take more than {} MiB of memory; raise the memory "
                        "limit or use a simpler model",
                        placement.file, triangles, memory_limit_ >> 20)};
    }
    return success();
}

void SceneBuilder::append_materials(const Soup& soup, const Placement& placement) {
    first_material_ = static_cast<std::uint32_t>(scene_.materials.size());
    for (const Material& from_file : soup.materials) {
        Material material = from_file;
        material.name = clean_text(from_file.name);
        material.base_color = linear_color(from_file.base_color, soup.srgb_colors);
        material.opacity = linear_channel(from_file.opacity, false);
        apply(placement.material, material);
        scene_.materials.push_back(std::move(material));
    }
}

std::uint32_t SceneBuilder::material_of(const SoupMesh& mesh, const Placement& placement) {
    if (mesh.material != kNone) return first_material_ + mesh.material;
    Material material;
    if (!mesh.colors.empty()) material.base_color = {1, 1, 1};  // it multiplies the colours
    apply(placement.material, material);
    const auto& all = scene_.materials;
    const auto same = std::find_if(all.begin() + first_material_, all.end(), [&](const auto& m) {
        return m.name.empty() && m.base_color == material.base_color &&
               m.opacity == material.opacity && m.specular == material.specular &&
               m.shininess == material.shininess;
    });
    const auto index = static_cast<std::uint32_t>(same - all.begin());
    if (same == all.end()) scene_.materials.push_back(material);
    return index;
}

Status SceneBuilder::append(const Soup& soup, const Placement& placement) {
    if (Status size = check_size(soup, placement); !size) return size;
    append_materials(soup, placement);
    scene_.counts.ignored_primitives += soup.ignored_primitives;
    const auto drawn = std::ranges::count_if(soup.objects, [&](const SoupObject& object) {
        return !soup.meshes[object.mesh].polygon_sizes.empty();
    });
    for (const SoupObject& object : soup.objects) {
        const SoupMesh& mesh = soup.meshes[object.mesh];
        if (mesh.polygon_sizes.empty()) continue;
        std::string name = clean_text(object.name.empty() ? placement.default_name : object.name);
        if (placement.name) name = drawn == 1 ? *placement.name : *placement.name + "/" + name;
        const glm::dmat4 transform = placement.transform * object.transform;
        const glm::dmat3 linear(transform);
        const Instance instance{mesh,
                                placement,
                                std::move(name),
                                transform,
                                normal_transform(linear),
                                glm::determinant(linear) < 0,
                                soup.srgb_colors};
        if (Status added = append_object(instance); !added) return added;
    }
    return success();
}

Status SceneBuilder::append_object(const Instance& instance) {
    const SoupMesh& mesh = instance.mesh;
    Object object;
    object.name = instance.name;
    object.first_triangle = scene_.triangle_count();
    object.first_polygon = polygons_;
    object.polygon_count = static_cast<std::uint32_t>(mesh.polygon_sizes.size());
    object.material = material_of(mesh, instance.placement);
    if (vertices_.size() < mesh.positions.size()) vertices_.resize(mesh.positions.size());
    const std::size_t normals_before = scene_.normals.size();
    fill_attributes(instance);

    PositionJoiner joiner(scene_.positions);
    std::span<const std::uint32_t> rest = mesh.corners;
    for (const std::uint32_t size : mesh.polygon_sizes) {
        Status added = append_polygon(instance, rest.first(size), joiner);
        if (!added) return added;
        rest = rest.subspan(size);
    }
    for (const std::uint32_t vertex : mesh.corners) vertices_[vertex] = {};
    object.triangle_count = scene_.triangle_count() - object.first_triangle;
    object.has_file_normals = scene_.normals.size() > normals_before;
    if (!scene_.triangle_normals.empty()) {
        scene_.triangle_normals.resize(scene_.triangles.size(), Corners{kNone});
    }
    if (!scene_.triangle_colors.empty()) {
        scene_.triangle_colors.resize(scene_.triangles.size(), Corners{kNone});
    }
    scene_.objects.push_back(std::move(object));
    return success();
}

/// Indices of attributes exist for every triangle as soon as one object has the attribute.
void SceneBuilder::fill_attributes(const Instance& instance) {
    if (!instance.mesh.normals.empty()) {
        scene_.triangle_normals.resize(scene_.triangles.size(), Corners{kNone});
    }
    if (!instance.mesh.colors.empty()) {
        scene_.triangle_colors.resize(scene_.triangles.size(), Corners{kNone});
    }
}

Status SceneBuilder::append_polygon(const Instance& instance,
                                    std::span<const std::uint32_t> corners,
                                    PositionJoiner& joiner) {
    polygon_.assign(corners.begin(), corners.end());
    // A mirror turns fronts into backs; the first corner stays the first.
    if (instance.mirrored) std::reverse(polygon_.begin() + 1, polygon_.end());
    polygon_positions_.clear();
    for (const std::uint32_t vertex : polygon_) {
        if (Status placed = place_vertex(instance, vertex, joiner); !placed) return placed;
        polygon_positions_.push_back(scene_.positions[vertices_[vertex].position]);
    }
    const auto shape = triangulator_.triangulate(polygon_positions_, triangles_);
    if (shape == Triangulator::Shape::too_complex) {
        return Error{
            ErrorKind::bad_input,
            fmt::format("{}: object '{}' has a polygon of {} corners that is too entangled "
                        "to triangulate; triangulate the model before",
                        instance.placement.file, instance.name, polygon_.size())};
    }
    if (shape == Triangulator::Shape::concave) ++scene_.counts.concave_polygons;
    for (const PolygonTriangle& triangle : triangles_) {
        append_triangle(triangle, static_cast<std::uint32_t>(polygon_.size()));
        append_attributes(instance, triangle);
    }
    ++polygons_;
    return success();
}

Status SceneBuilder::place_vertex(const Instance& instance, std::uint32_t vertex,
                                  PositionJoiner& joiner) {
    const SoupMesh& mesh = instance.mesh;
    if (vertex >= mesh.positions.size()) {
        return Error{
            ErrorKind::bad_input,
            fmt::format("{}: object '{}' refers to vertex {}, but has only {}; the file is "
                        "damaged, export it again",
                        instance.placement.file, instance.name, vertex, mesh.positions.size())};
    }
    Vertex& placed = vertices_[vertex];
    if (placed.position != kNone) return success();
    const glm::dvec3 stored(mesh.positions[vertex]);
    const glm::dvec3 position(instance.transform * glm::dvec4(stored, 1.0));
    const char* fault = fault_of(stored);
    if (fault == nullptr) fault = fault_of(position);
    if (fault != nullptr) {
        return Error{ErrorKind::bad_input,
                     fmt::format("{}: vertex {} of object '{}' has {}; repair or rescale the model",
                                 instance.placement.file, vertex, instance.name, fault)};
    }
    placed.position = joiner.add(position);
    if (!mesh.normals.empty()) {
        const glm::dvec3 normal = instance.normal_matrix * glm::dvec3(mesh.normals[vertex]);
        const double length = std::sqrt(glm::dot(normal, normal));
        if (length > 0 && std::isfinite(length)) {
            placed.normal = static_cast<std::uint32_t>(scene_.normals.size());
            scene_.normals.emplace_back(normal / length);
        }
    }
    if (!mesh.colors.empty()) {
        const glm::vec4& color = mesh.colors[vertex];
        placed.color = static_cast<std::uint32_t>(scene_.colors.size());
        scene_.colors.emplace_back(linear_color(glm::vec3(color), instance.srgb),
                                   linear_channel(color.w, false));
    }
    return success();
}

void SceneBuilder::append_triangle(const PolygonTriangle& triangle, std::uint32_t corners) {
    const auto position = [&](std::size_t k) { return vertices_[polygon_[triangle[k]]].position; };
    scene_.triangles.emplace_back(position(0), position(1), position(2));
    scene_.triangle_polygon.push_back(polygons_);
    scene_.polygon_edges.push_back(polygon_edge_bits(triangle, corners));
}

void SceneBuilder::append_attributes(const Instance& instance, const PolygonTriangle& triangle) {
    const auto corner = [&](std::size_t k) -> const Vertex& {
        return vertices_[polygon_[triangle[k]]];
    };
    if (!instance.mesh.normals.empty()) {
        Corners normals(corner(0).normal, corner(1).normal, corner(2).normal);
        // A triangle has normals at all its corners or at none.
        if (normals.x == kNone || normals.y == kNone || normals.z == kNone)
            normals = Corners{kNone};
        scene_.triangle_normals.push_back(normals);
    }
    if (!instance.mesh.colors.empty()) {
        scene_.triangle_colors.emplace_back(corner(0).color, corner(1).color, corner(2).color);
    }
}

}  // namespace sightline::load
