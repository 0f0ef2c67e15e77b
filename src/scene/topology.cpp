// Closed objects. Each edge must join exactly two faces that run along it in opposite directions:
// the forward edges (from the lower to the higher vertex) are grouped by their lower vertex, then
// every backward edge must find exactly one of them, which nobody else has found. Faces that share
// an edge form parts; each part must enclose a positive volume, or it is inside out.
//
// What fails is looked at once more: without the copies of equal faces, and with those turned that
// are there both ways round. If it fails again, positions may have to be joined.
#include "scene/topology.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "scene/equal_faces.hpp"
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
    /// Of each face the number of its set; the sets are numbered in the order of their first faces.
    /// The sets themselves are gone then.
    std::vector<std::uint32_t> numbers() {
        for (std::uint32_t face = 0; face < parent_.size(); ++face) parent_[face] = root(face);
        // A root stands before its faces, so its number is there when they ask for it.
        std::uint32_t count = 0;
        for (std::uint32_t face = 0; face < parent_.size(); ++face)
            parent_[face] = parent_[face] == face ? count++ : parent_[parent_[face]];
        return std::move(parent_);
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
        bool is_drawn = false;
    };
    std::vector<Edge>().swap(edges_);
    std::vector<std::uint64_t>().swap(first_);
    std::vector<Sum> sums;
    const std::vector<std::uint32_t> part_of = parts_.numbers();
    const glm::dvec3 origin = point(0, 0);
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
        if (is_dropped(t)) continue;
        const glm::dvec3 a = point(t, 0) - origin, b = point(t, 1) - origin,
                         c = point(t, 2) - origin;
        if (part_of[t] >= sums.size()) sums.resize(part_of[t] + std::size_t{1});
        Sum& sum = sums[part_of[t]];
        sum.volume += glm::dot(a, glm::cross(b, c));
        sum.is_drawn = true;
        sum.size += std::sqrt(glm::dot(a, a) * glm::dot(b, b)) * std::sqrt(glm::dot(c, c));
    }
    const double relative_error =
        (static_cast<double>(mesh_.triangles.size()) + 8) * std::numeric_limits<double>::epsilon();
    // What is dropped is a part by itself.
    return std::ranges::all_of(sums, [&](const Sum& sum) {
        return !sum.is_drawn || sum.volume > relative_error * sum.size;
    });
}

/// Judges one object after another.
class ObjectJudge {
public:
    /// `dropped` has one byte a triangle of the scene, or nothing when none is dropped.
    ObjectJudge(Scene& scene, bool joined, std::span<const std::uint8_t> dropped, double weld)
        : scene_(scene), joiner_(scene, joined), dropped_(dropped), weld_(weld) {
        scene.equal_faces.clear();
        scene.counts.equal_faces = 0;
    }

    Joins judge_all() {
        for (Object& object : scene_.objects) {
            object.closed = object.two_sided = false;
            if (object.triangle_count > 0) judge(object);
        }
        return std::move(joins_);
    }

private:
    void judge(Object& object) {
        const JoinedMesh mesh = joiner_.join(object);
        auto dropped = dropped_;
        if (!dropped.empty())
            dropped = dropped.subspan(object.first_triangle, object.triangle_count);
        object.closed = ClosednessTest(mesh, dropped).closed();
        if (object.closed) return;
        std::vector<std::uint8_t> copies;
        const EqualFaces equal = find_equal_faces(scene_, object, mesh);
        if (equal.count > 0) {
            note(equal, object);
            copies = without_copies(dropped, equal);
            dropped = copies;
            std::vector<Corners> turned;
            if (equal.two_sided) turned = turned_alike(mesh, equal.bits, dropped);
            const JoinedMesh distinct{
                mesh.points, equal.two_sided ? std::span<const Corners>(turned) : mesh.triangles};
            object.closed = ClosednessTest(distinct, dropped).closed();
        }
        if (!object.closed && weld_ > 0)
            find_joins(joiner_, object, mesh, dropped, scene_.rounding, weld_, joins_);
    }

    void note(const EqualFaces& equal, Object& object) {
        object.two_sided = equal.two_sided;
        scene_.counts.equal_faces += equal.count;
        scene_.equal_faces.resize(scene_.triangles.size(), 0);
        std::ranges::copy(equal.bits, scene_.equal_faces.begin() + object.first_triangle);
    }

    [[nodiscard]] static std::vector<std::uint8_t> without_copies(
        std::span<const std::uint8_t> dropped, const EqualFaces& equal) {
        std::vector<std::uint8_t> copies(equal.bits.size());
        for (std::size_t t = 0; t < copies.size(); ++t) {
            const bool is_copy = (equal.bits[t] & (kRepeated | kTurnedOver)) != 0;
            copies[t] = is_copy || (!dropped.empty() && dropped[t] != 0) ? 1 : 0;
        }
        return copies;
    }

    Scene& scene_;
    ObjectJoiner joiner_;
    std::span<const std::uint8_t> dropped_;
    double weld_;
    Joins joins_;
};

}  // namespace

void find_closed_objects(Scene& scene) {
    std::vector<std::uint8_t> dropped(scene.triangles.size());
    std::ranges::transform(scene.triangles, dropped.begin(), [&](const Corners& c) {
        const auto& p = scene.positions;
        return is_degenerate(p[c.x], p[c.y], p[c.z]) ? std::uint8_t{1} : std::uint8_t{0};
    });
    static_cast<void>(ObjectJudge(scene, false, dropped, 0).judge_all());
}

Joins find_closed_objects(Scene& scene, bool joined, double weld) {
    return ObjectJudge(scene, joined, scene.degenerate, weld).judge_all();
}

}  // namespace sightline
