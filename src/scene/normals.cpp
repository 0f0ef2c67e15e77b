// Vertex normals: the mean of the face normals around a vertex, each weighted with the angle that
// its face spans there (G. Thürmer, C. A. Wüthrich, "Computing Vertex Normals from Polygonal
// Facets", Journal of Graphics Tools 3(1), 1998), so that a triangulation's diagonals don't matter.
// Added here: the faces around a vertex form groups, joined across each edge whose two faces meet
// at no more than the crease angle, and each group has a normal of its own.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "math/elementary.hpp"
#include "scene/joined_mesh.hpp"
#include "sightline/scene.hpp"

namespace sightline {
namespace {

/// Slack on the cosine of the crease angle (0.003 degrees at 0), so that the halves of a flat quad,
/// whose normals differ by rounding, are smooth at a crease angle of 0.
constexpr double kCosineSlack = 1e-9;
/// At an edge of more than two faces each is compared with this many of those that follow.
constexpr std::size_t kFanLimit = 16;

glm::dvec3 unit_or_zero(const glm::dvec3& v) {
    const double length = std::sqrt(glm::dot(v, v));
    return length > 0 ? v / length : glm::dvec3{0, 0, 0};
}

/// One corner of a drawn face, among those around a vertex.
struct Wedge {
    std::uint32_t triangle;
    int corner;
    glm::dvec3 face_normal;
    std::size_t group;  ///< an earlier wedge of the same group; itself in the first one
};

/// A side of a wedge: an edge from the vertex to a neighbour.
struct Spoke {
    std::uint32_t neighbour;
    std::size_t wedge;
};

class NormalMaker {
public:
    NormalMaker(const JoinedMesh& mesh, double crease_angle_degrees);
    /// Calls write(triangle, corner, group_begins, normal) for every corner of a drawn face: once
    /// with group_begins for each normal, then for the other corners that share it.
    template <class Write>
    void make(const Write& write);

private:
    void gather(const CornersOfVertices& around, std::size_t vertex);
    void join_groups();
    [[nodiscard]] std::size_t leader(std::size_t wedge);
    [[nodiscard]] double angle(const Wedge& wedge) const;
    [[nodiscard]] glm::dvec3 group_normal(std::size_t first, std::size_t end) const;

    const JoinedMesh& mesh_;
    double least_cosine_;
    std::vector<glm::dvec3> face_normals_;  ///< zero for faces that are not drawn
    std::vector<Wedge> wedges_;             ///< around the vertex at hand
    std::vector<Spoke> spokes_;
};

NormalMaker::NormalMaker(const JoinedMesh& mesh, double crease_angle_degrees)
    : mesh_(mesh),
      least_cosine_(math::cos_degrees(std::clamp(crease_angle_degrees, 0.0, 180.0)) -
                    kCosineSlack) {
    face_normals_.reserve(mesh.triangles.size());
    for (const Corners& t : mesh.triangles) {
        const glm::dvec3 &a = mesh.points[t.x], &b = mesh.points[t.y], &c = mesh.points[t.z];
        face_normals_.push_back(unit_or_zero(glm::cross(b - a, c - a)));
    }
}

void NormalMaker::gather(const CornersOfVertices& around, std::size_t vertex) {
    wedges_.clear();
    spokes_.clear();
    for (std::uint64_t i = around.first[vertex]; i < around.first[vertex + 1]; ++i) {
        const auto triangle = static_cast<std::uint32_t>(around.corners[i] / 3);
        const int corner = static_cast<int>(around.corners[i] % 3);
        const glm::dvec3& normal = face_normals_[triangle];
        if (normal == glm::dvec3{0, 0, 0}) continue;
        const Corners& t = mesh_.triangles[triangle];
        const std::size_t wedge = wedges_.size();
        wedges_.push_back({triangle, corner, normal, wedge});
        spokes_.push_back({t[(corner + 1) % 3], wedge});
        spokes_.push_back({t[(corner + 2) % 3], wedge});
    }
}

std::size_t NormalMaker::leader(std::size_t wedge) {
    while (wedges_[wedge].group != wedge) {
        wedge = wedges_[wedge].group = wedges_[wedges_[wedge].group].group;
    }
    return wedge;
}

/// Joins the wedges on both sides of each smooth spoke, and sorts the wedges by group.
void NormalMaker::join_groups() {
    std::ranges::sort(spokes_, [](const Spoke& a, const Spoke& b) {
        return a.neighbour != b.neighbour ? a.neighbour < b.neighbour : a.wedge < b.wedge;
    });
    for (std::size_t i = 0; i < spokes_.size(); ++i) {
        const std::size_t end = std::min(spokes_.size(), i + 1 + kFanLimit);
        for (std::size_t j = i + 1; j < end && spokes_[j].neighbour == spokes_[i].neighbour; ++j) {
            const Wedge &a = wedges_[spokes_[i].wedge], &b = wedges_[spokes_[j].wedge];
            if (glm::dot(a.face_normal, b.face_normal) < least_cosine_) continue;
            const std::size_t p = leader(spokes_[i].wedge), q = leader(spokes_[j].wedge);
            wedges_[std::max(p, q)].group = std::min(p, q);
        }
    }
    // A leader stands before its followers, so one ascending pass makes every path one step long.
    for (Wedge& wedge : wedges_) wedge.group = wedges_[wedge.group].group;
    std::ranges::stable_sort(wedges_, {}, &Wedge::group);
}

double NormalMaker::angle(const Wedge& wedge) const {
    const Corners& t = mesh_.triangles[wedge.triangle];
    const glm::dvec3& vertex = mesh_.points[t[wedge.corner]];
    const glm::dvec3 a = unit_or_zero(mesh_.points[t[(wedge.corner + 1) % 3]] - vertex);
    const glm::dvec3 b = unit_or_zero(mesh_.points[t[(wedge.corner + 2) % 3]] - vertex);
    return math::acos_degrees(std::clamp(glm::dot(a, b), -1.0, 1.0));
}

glm::dvec3 NormalMaker::group_normal(std::size_t first, std::size_t end) const {
    glm::dvec3 sum{0, 0, 0};
    for (std::size_t w = first; w < end; ++w) sum += angle(wedges_[w]) * wedges_[w].face_normal;
    // Faces that cancel each other leave the first one's normal.
    const bool cancelled = glm::dot(sum, sum) < 1e-12;
    return cancelled ? wedges_[first].face_normal : unit_or_zero(sum);
}

template <class Write>
void NormalMaker::make(const Write& write) {
    const CornersOfVertices around(mesh_);
    for (std::size_t v = 0; v < mesh_.points.size(); ++v) {
        gather(around, v);
        join_groups();
        for (std::size_t first = 0, end = 0; first < wedges_.size(); first = end) {
            while (end < wedges_.size() && wedges_[end].group == wedges_[first].group) ++end;
            const glm::vec3 normal(group_normal(first, end));
            for (std::size_t w = first; w < end; ++w) {
                write(wedges_[w].triangle, wedges_[w].corner, w == first, normal);
            }
        }
    }
}

}  // namespace

void make_normals(Scene& scene, double crease_angle_degrees, bool replace) {
    if (replace) {
        for (Object& object : scene.objects) object.has_file_normals = false;
    }
    if (std::ranges::none_of(scene.objects, &Object::has_file_normals)) {
        scene.normals.clear();
        scene.triangle_normals.clear();
    }
    scene.triangle_normals.resize(scene.triangles.size(), Corners{kNone});
    ObjectJoiner joiner(scene);
    for (const Object& object : scene.objects) {
        Corners* const written = scene.triangle_normals.data() + object.first_triangle;
        std::vector<std::uint8_t> keep(object.triangle_count, 0);
        for (std::uint32_t t = 0; t < object.triangle_count; ++t) {
            keep[t] = object.has_file_normals && written[t].x != kNone ? 1 : 0;
        }
        if (std::ranges::count(keep, 0) == 0) continue;
        const JoinedMesh mesh = joiner.join(object);
        std::uint32_t index = kNone;
        NormalMaker(mesh, crease_angle_degrees)
            .make([&](std::uint32_t t, int corner, bool begins, const glm::vec3& normal) {
                if (begins) index = kNone;
                if (keep[t] != 0) return;
                if (index == kNone) {
                    index = static_cast<std::uint32_t>(scene.normals.size());
                    scene.normals.push_back(normal);
                }
                written[t][corner] = index;
            });
    }
}

}  // namespace sightline
