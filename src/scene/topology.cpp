// Closed objects. Each edge must join exactly two faces that run along it in opposite directions:
// the forward edges (from the lower to the higher vertex) are grouped by their lower vertex, then
// every backward edge must find exactly one of them, which nobody else has found. Faces that share
// an edge form parts; each part must enclose a positive volume, or it is inside out.
#include "scene/topology.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "scene/joined_mesh.hpp"

namespace sightline {
namespace {

/// Disjoint sets of faces, with path halving.
class FaceSets {
public:
    explicit FaceSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }

    std::uint32_t root(std::uint32_t face) {
        while (parent_[face] != face) face = parent_[face] = parent_[parent_[face]];
        return face;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        a = root(a);
        b = root(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::uint32_t> parent_;
};

/// A forward edge, in the group of its lower vertex.
struct Edge {
    std::uint32_t higher;
    std::uint32_t face;  ///< kNone once its partner is found
};

class ClosednessTest {
public:
    /// `dropped`: one byte a triangle, or nothing when none is dropped.
    ClosednessTest(const JoinedMesh& mesh, std::span<const std::uint8_t> dropped)
        : mesh_(mesh), dropped_(dropped), parts_(mesh.triangles.size()) {}

    bool closed() { return gather_edges() && pair_edges() && volumes_positive(); }

private:
    [[nodiscard]] const glm::dvec3& point(std::uint32_t t, int k) const {
        return mesh_.points[mesh_.triangles[t][k]];
    }
    [[nodiscard]] bool is_dropped(std::uint32_t t) const {
        return !dropped_.empty() && dropped_[t] != 0;
    }
    /// Calls body(face, from, to) for each side of each drawn face while it answers true.
    template <class Body>
    bool each_side(const Body& body) const {
        for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
            if (is_dropped(t)) continue;
            const Corners& c = mesh_.triangles[t];
            for (int k = 0; k < 3; ++k) {
                if (!body(t, c[k], c[(k + 1) % 3])) return false;
            }
        }
        return true;
    }
    bool gather_edges();
    bool pair_edges();
    bool volumes_positive();

    const JoinedMesh& mesh_;
    std::span<const std::uint8_t> dropped_;
    FaceSets parts_;
    std::vector<std::uint64_t> first_;  ///< edges of vertex v: first_[v] .. first_[v + 1] - 1
    std::vector<Edge> edges_;
};

/// Groups the forward edges by their lower vertex, each group in order of the higher one. False
/// when one stands twice or the backward ones are not as many.
bool ClosednessTest::gather_edges() {
    first_.assign(mesh_.points.size() + 1, 0);
    std::uint64_t forward = 0, backward = 0;
    each_side([&](std::uint32_t, std::uint32_t from, std::uint32_t to) {
        if (from < to) ++first_[from];
        ++(from < to ? forward : backward);
        return true;
    });
    if (forward != backward || forward == 0) return false;
    std::uint64_t end = 0;
    for (std::uint64_t& f : first_) f = end += f;
    edges_.resize(forward);
    each_side([&](std::uint32_t face, std::uint32_t from, std::uint32_t to) {
        if (from < to) edges_[--first_[from]] = {to, face};
        return true;
    });
    for (std::size_t v = 0; v + 1 < first_.size(); ++v) {
        const auto group = std::span(edges_).subspan(first_[v], first_[v + 1] - first_[v]);
        std::ranges::sort(group, {}, &Edge::higher);
        if (std::ranges::adjacent_find(group, {}, &Edge::higher) != group.end()) return false;
    }
    return true;
}

bool ClosednessTest::pair_edges() {
    return each_side([&](std::uint32_t face, std::uint32_t from, std::uint32_t to) {
        if (from < to) return true;
        const auto group = std::span(edges_).subspan(first_[to], first_[to + 1] - first_[to]);
        const auto partner = std::ranges::lower_bound(group, from, {}, &Edge::higher);
        if (partner == group.end() || partner->higher != from || partner->face == kNone) {
            return false;
        }
        parts_.join(face, partner->face);
        partner->face = kNone;
        return true;
    });
}

bool ClosednessTest::volumes_positive() {
    // Each term is six times the volume of a tetrahedron on the first point. A sum of n terms that
    // are good to a few units of 2^-52 is good to (n + 8) 2^-52 of the sum of their sizes; a part
    // that does not clearly enclose anything (two faces back to back) does not count as closed.
    struct Sum {
        double volume = 0, size = 0;
    };
    std::vector<Sum> sums(mesh_.triangles.size());
    const glm::dvec3 origin = mesh_.points[0];
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
        if (is_dropped(t)) continue;
        const glm::dvec3 a = point(t, 0) - origin, b = point(t, 1) - origin,
                         c = point(t, 2) - origin;
        Sum& sum = sums[parts_.root(t)];
        sum.volume += glm::dot(a, glm::cross(b, c));
        sum.size += std::sqrt(glm::dot(a, a) * glm::dot(b, b)) * std::sqrt(glm::dot(c, c));
    }
    const double relative_error =
        (static_cast<double>(mesh_.triangles.size()) + 8) * std::numeric_limits<double>::epsilon();
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
        if (is_dropped(t) || parts_.root(t) != t) continue;
        if (!(sums[t].volume > relative_error * sums[t].size)) return false;
    }
    return true;
}

/// `dropped` has one byte a triangle of the scene, or nothing when none is dropped.
void find_closed(Scene& scene, bool joined, std::span<const std::uint8_t> dropped) {
    ObjectJoiner joiner(scene, joined);
    for (Object& object : scene.objects) {
        const auto mine = dropped.empty()
                              ? dropped
                              : dropped.subspan(object.first_triangle, object.triangle_count);
        object.closed = ClosednessTest(joiner.join(object), mine).closed();
    }
}

}  // namespace

void find_closed_objects(Scene& scene) {
    std::vector<std::uint8_t> dropped(scene.triangles.size());
    std::ranges::transform(scene.triangles, dropped.begin(), [&](const Corners& c) {
        const auto& p = scene.positions;
        return is_degenerate(p[c.x], p[c.y], p[c.z]) ? std::uint8_t{1} : std::uint8_t{0};
    });
    find_closed(scene, false, dropped);
}

void find_closed_objects(Scene& scene, bool joined) {
    find_closed(scene, joined, scene.degenerate);
}

}  // namespace sightline
