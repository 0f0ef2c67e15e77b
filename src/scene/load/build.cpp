#include "scene/load/build.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "scene/load/text.hpp"
#include "sightline/image.hpp"

namespace sightline::load {
namespace {

/// Memory that a triangle takes while its scene is finished: three indices each for corners and
/// normals, its place in the table of sheets, and the tables that join and pair. Positions, normals
/// and colours come on top.
constexpr std::size_t kBytesPerTriangle = 126;

/// How early the joiner of positions is told what comes, when it has more than fit into a cache.
constexpr std::size_t kCornersAhead = 24, kMostCached = 200'000;

/// What is noted of files stays short, however many there are.
constexpr std::size_t kMostNotes = 100;

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

/// What carries normals along with a transform, up to length: the inverse transpose, as cofactors
/// (so a flattening transform works too) with the sign of a mirror taken out.
glm::dmat3 normal_transform(const glm::dmat3& m) {
    const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]),
                               glm::cross(m[0], m[1]));
    return glm::determinant(m) < 0 ? -cofactors : cofactors;
}

double largest_of(const glm::dvec3& p) {
    return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

/// By how much a transform may move a point whose coordinates are off by 2^-24 of `largest`, along
/// an axis: floats are rounded to that.
double rounding_through(const glm::dmat4& m, double largest) {
    double stretch = 0;
    for (int axis = 0; axis < 3; ++axis)
        stretch =
            std::max(stretch, std::abs(m[0][axis]) + std::abs(m[1][axis]) + std::abs(m[2][axis]));
    return 0x1p-24 * stretch * largest;
}

const char* fault_of(const glm::dvec3& p) {
    for (int axis = 0; axis < 3; ++axis) {
        if (std::isnan(p[axis])) return "a coordinate that is not a number (NaN)";
    }
    const double largest = largest_of(p);
    if (std::isinf(largest)) return "an infinite coordinate";
    return largest > kLargestCoordinate ? "a coordinate beyond 1e30" : nullptr;
}

/// Makes room for `size` elements at once, without losing geometric growth over many calls.
template <class Vector>
void reserve_more(Vector& vector, std::size_t size) {
    if (size > vector.capacity()) vector.reserve(std::max(size, 2 * vector.capacity()));
}

}  // namespace

void apply(const MaterialOverride& what, Material& material) {
    material.base_color = what.base_color.value_or(material.base_color);
    material.opacity = what.opacity.value_or(material.opacity);
    material.specular = what.specular.value_or(material.specular);
    material.shininess = what.shininess.value_or(material.shininess);
}

struct SceneBuilder::Instance {
    const SoupMesh& mesh;
    const Placement& placement;
    std::string name;
    glm::dmat4 transform;
    glm::dmat3 normal_matrix;
    bool mirrored;
    bool srgb;

    [[nodiscard]] glm::dvec3 placed(const glm::dvec3& stored) const {
        return glm::dvec3(transform * glm::dvec4(stored, 1.0));
    }
    /// Place in SoupMesh::corners of a polygon's corner k. A mirror turns fronts into backs, so
    /// there the corners run backwards; the first stays the first.
    [[nodiscard]] std::size_t corner(const Polygon& polygon, std::uint32_t k) const {
        return polygon.first_corner + (mirrored && k > 0 ? polygon.size - k : k);
    }
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
    return check_memory(triangles, placement);
}

Status SceneBuilder::check_memory(std::uint64_t more_triangles, const Placement& placement) const {
    const std::uint64_t triangles = more_triangles + scene_.triangles.size();
    const std::uint64_t bytes = triangles * kBytesPerTriangle +
                                scene_.positions.size() * sizeof(scene_.positions[0]) +
                                scene_.normals.size() * sizeof(scene_.normals[0]) +
                                scene_.colors.size() * (sizeof(scene_.colors[0]) + sizeof(Corners));
    if (bytes <= memory_limit_) return success();
    return Error{ErrorKind::bad_input,
                 fmt::format("{}: {} triangles take more than {} MiB of memory; use a simpler "
                             "model",
                             placement.file, triangles, memory_limit_ >> 20)};
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

void SceneBuilder::append_notes(const Soup& soup, const Placement& placement) {
    const auto add = [&](std::string_view note) {
        const std::string line = fmt::format("{}: {}", placement.file, note);
        // A model that stands in a scene many times has its notes once.
        if (std::ranges::find(scene_.notes, line) != scene_.notes.end()) return;
        if (scene_.notes.size() < kMostNotes) scene_.notes.push_back(line);
    };
    for (const std::string& note : soup.notes) add(clean_text(note));
    if (soup.ignored_primitives > 0)
        add(fmt::format("points, lines and faces of fewer than three corners are not drawn: {}",
                        soup.ignored_primitives));
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
    append_notes(soup, placement);
    const auto drawn = std::ranges::count_if(soup.objects, [&](const SoupObject& object) {
        return !soup.meshes[object.mesh].polygon_sizes.empty();
    });
    for (const SoupObject& object : soup.objects) {
        const SoupMesh& mesh = soup.meshes[object.mesh];
        if (mesh.polygon_sizes.empty()) continue;
        std::string name = clean_text(object.name.empty() ? placement.default_name : object.name);
        if (placement.name) {
            const std::string own = clean_text(*placement.name);
            name = drawn == 1 ? own : fmt::format("{}/{}", own, name);
        }
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

Scene SceneBuilder::take() {
    Scene scene = std::move(scene_);
    *this = SceneBuilder(memory_limit_);  // what was needed to build it is not to stay beside it
    return scene;
}

Status SceneBuilder::append_object(const Instance& instance) {
    const SoupMesh& mesh = instance.mesh;
    Object object;
    object.name = instance.name;
    object.first_triangle = scene_.triangle_count();
    object.first_polygon = polygons_;
    object.polygon_count = static_cast<std::uint32_t>(mesh.polygon_sizes.size());
    object.material = material_of(mesh, instance.placement);
    const std::size_t normals_before = scene_.normals.size();
    fill_attributes(mesh);
    largest_float_ = 0;
    if (Status added = append_polygons(instance); !added) return added;
    if (Status fits = check_memory(0, instance.placement); !fits) return fits;
    scene_.rounding =
        std::max(scene_.rounding, rounding_through(instance.transform, largest_float_));
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
void SceneBuilder::fill_attributes(const SoupMesh& mesh) {
    if (!mesh.normals.empty()) {
        scene_.triangle_normals.resize(scene_.triangles.size(), Corners{kNone});
    }
    if (!mesh.colors.empty()) {
        scene_.triangle_colors.resize(scene_.triangles.size(), Corners{kNone});
    }
}

Status SceneBuilder::append_polygons(const Instance& instance) {
    const SoupMesh& mesh = instance.mesh;
    placed_positions_.assign(mesh.position_count(), kNone);
    placed_normals_.assign(mesh.normals.size(), kNone);
    placed_colors_.assign(mesh.colors.size(), kNone);
    const std::size_t triangles =
        scene_.triangles.size() + mesh.corners.size() - 2 * mesh.polygon_sizes.size();
    reserve_more(scene_.triangles, triangles);
    reserve_more(scene_.triangle_polygon, triangles);
    reserve_more(scene_.polygon_edges, triangles);
    // Where each corner has a vertex of its own, about six of them are at one place.
    const std::size_t own = mesh.position_count() == mesh.corners.size() ? 4 : 1;
    PositionJoiner joiner(scene_.positions,
                          std::min(mesh.position_count(), mesh.corners.size()) / own);
    const bool is_large = mesh.position_count() > kMostCached;
    Polygon polygon{0, 0, 0};
    for (const std::uint32_t size : mesh.polygon_sizes) {
        polygon.size = size;
        if (is_large)
            expect_vertices(instance, {polygon.first_corner + kCornersAhead, size, 0}, joiner);
        if (Status added = append_polygon(instance, polygon, joiner); !added) return added;
        polygon.first_corner += size;
        ++polygon.number;
        ++polygons_;
    }
    return success();
}

/// The joiner's memory is slow, so it is told early what will come.
void SceneBuilder::expect_vertices(const Instance& instance, const Polygon& coming,
                                   const PositionJoiner& joiner) const {
    const SoupMesh& mesh = instance.mesh;
    const std::size_t end = std::min(coming.first_corner + coming.size, mesh.corners.size());
    for (std::size_t c = coming.first_corner; c < end; ++c) {
        const std::uint32_t v = mesh.corners[c];
        if (v < placed_positions_.size() && placed_positions_[v] == kNone)
            joiner.expect(instance.placed(mesh.position(v)));
    }
}

Status SceneBuilder::append_polygon(const Instance& instance, const Polygon& polygon,
                                    PositionJoiner& joiner) {
    const auto vertex = [&](std::uint32_t k) {
        return instance.mesh.corners[instance.corner(polygon, k)];
    };
    for (std::uint32_t k = 0; k < polygon.size; ++k) {
        const std::uint32_t v = vertex(k);
        if (v < placed_positions_.size() && placed_positions_[v] != kNone) continue;
        if (Status placed = place_vertex(instance, v, joiner); !placed) return placed;
    }
    if (polygon.size == 3) {
        append_triangle(instance, polygon, {0, 1, 2}, 0b111);
        return success();
    }
    polygon_positions_.clear();
    for (std::uint32_t k = 0; k < polygon.size; ++k) {
        polygon_positions_.push_back(scene_.positions[placed_positions_[vertex(k)]]);
    }
    const auto shape = triangulator_.triangulate(polygon_positions_, triangles_);
    if (shape == Triangulator::Shape::too_complex) {
        return Error{
            ErrorKind::bad_input,
            fmt::format("{}: object '{}' has a polygon of {} corners that is too entangled "
                        "to triangulate; triangulate the model before",
                        instance.placement.file, instance.name, polygon.size)};
    }
    if (shape == Triangulator::Shape::concave) ++scene_.counts.concave_polygons;
    find_polygon_edges(polygon_positions_, triangles_, edge_bits_);
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
        append_triangle(instance, polygon, triangles_[i], edge_bits_[i]);
    }
    return success();
}

Status SceneBuilder::place_vertex(const Instance& instance, std::uint32_t vertex,
                                  PositionJoiner& joiner) {
    const SoupMesh& mesh = instance.mesh;
    if (vertex >= mesh.position_count()) {
        return Error{
            ErrorKind::bad_input,
            fmt::format("{}: object '{}' refers to vertex {}, but has only {}; the file is "
                        "damaged, export it again",
                        instance.placement.file, instance.name, vertex, mesh.position_count())};
    }
    const glm::dvec3 stored = mesh.position(vertex);
    const glm::dvec3 position = instance.placed(stored);
    const char* const own_fault = fault_of(stored);
    const char* const fault = own_fault != nullptr ? own_fault : fault_of(position);
    if (fault != nullptr) {
        return Error{
            ErrorKind::bad_input,
            fmt::format("{}: vertex {} of object '{}' has {}; {}", instance.placement.file, vertex,
                        instance.name, fault,
                        own_fault != nullptr ? "repair or rescale the model"
                                             : "it comes from the transforms of the object; use "
                                               "smaller numbers there")};
    }
    if (!mesh.positions.empty()) largest_float_ = std::max(largest_float_, largest_of(stored));
    placed_positions_[vertex] = joiner.add(position);
    return success();
}

/// Number of a unit normal in the scene; kNone for one without a length.
std::uint32_t SceneBuilder::place_normal(const Instance& instance, std::uint32_t normal) {
    if (normal >= placed_normals_.size()) return kNone;
    std::uint32_t& placed = placed_normals_[normal];
    if (placed != kNone) return placed;
    const glm::dvec3 turned = instance.normal_matrix * glm::dvec3(instance.mesh.normals[normal]);
    const double length = std::sqrt(glm::dot(turned, turned));
    if (!(length > 0) || !std::isfinite(length)) return kNone;
    placed = static_cast<std::uint32_t>(scene_.normals.size());
    scene_.normals.emplace_back(turned / length);
    return placed;
}

std::uint32_t SceneBuilder::place_color(const Instance& instance, std::uint32_t vertex) {
    std::uint32_t& placed = placed_colors_[vertex];
    if (placed != kNone) return placed;
    const glm::vec4& color = instance.mesh.colors[vertex];
    placed = static_cast<std::uint32_t>(scene_.colors.size());
    scene_.colors.emplace_back(linear_color(glm::vec3(color), instance.srgb),
                               linear_channel(color.w, false));
    return placed;
}

void SceneBuilder::append_triangle(const Instance& instance, const Polygon& polygon,
                                   const PolygonTriangle& triangle, std::uint8_t edge_bits) {
    const SoupMesh& mesh = instance.mesh;
    std::array<std::size_t, 3> corner;  // in the mesh
    for (std::size_t k = 0; k < 3; ++k) corner[k] = instance.corner(polygon, triangle[k]);
    const auto vertex = [&](std::size_t k) { return mesh.corners[corner[k]]; };
    scene_.triangles.emplace_back(placed_positions_[vertex(0)], placed_positions_[vertex(1)],
                                  placed_positions_[vertex(2)]);
    scene_.triangle_polygon.push_back(polygons_);
    scene_.polygon_edges.push_back(edge_bits);
    if (!mesh.normals.empty()) {
        const auto& of_corner = mesh.normal_corners.empty() ? mesh.corners : mesh.normal_corners;
        Corners normals{};
        for (std::size_t k = 0; k < 3; ++k)
            normals[static_cast<int>(k)] = place_normal(
                instance, mesh.has_polygon_normals ? polygon.number : of_corner[corner[k]]);
        // A triangle has normals at all its corners or at none.
        if (normals.x == kNone || normals.y == kNone || normals.z == kNone)
            normals = Corners{kNone};
        scene_.triangle_normals.push_back(normals);
    }
    if (!mesh.colors.empty()) {
        const std::uint32_t a = place_color(instance, vertex(0)),
                            b = place_color(instance, vertex(1)),
                            c = place_color(instance, vertex(2));
        scene_.triangle_colors.emplace_back(a, b, c);
    }
}

}  // namespace sightline::load
