// Half-edges (the sides of triangles) are grouped by their lower vertex with a counting sort, and
// each small group is sorted by the other vertex: equal neighbours are one edge.
#include "drawing/edges.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "drawing/sheet_cover.hpp"
#include "math/arena.hpp"
#include "math/elementary.hpp"
#include "scene/joined_mesh.hpp"
#include "view/facing.hpp"

namespace sightline {
namespace {

constexpr std::uint32_t kGrain = 4096;  // vertices or triangles that a task takes at a time

/// Side k of a triangle, in the group of its lower vertex.
struct HalfEdge {
    std::uint32_t higher;  ///< vertex
    std::uint32_t face;
    std::uint8_t side;
    bool forward;  ///< runs from the lower to the higher vertex
};

class EdgeFinder {
public:
    EdgeFinder(const ScreenScene& page, EdgeKinds kinds, double crease_angle_degrees)
        : page_(page),
          scene_(page.scene()),
          kinds_(kinds),
          // As for normals: what is flat but for rounding is no crease, at 0 degrees too.
          least_cosine_(math::cos_degrees(crease_angle_degrees) - 1e-9) {}

    SceneEdges find() {
        join_positions();
        find_facing();
        group_half_edges();
        return collect();
    }

private:
    /// Edges found among the vertices of a task.
    struct Found {
        std::vector<SceneEdge> edges;
        std::vector<std::uint32_t> faces;
    };

    template <class Body>
    static void for_ranges(std::size_t n, const Body& body) {
        const auto count = static_cast<std::uint32_t>((n + kGrain - 1) / kGrain);
        tbb::parallel_for(std::uint32_t{0}, count, [&](std::uint32_t task) {
            const std::size_t begin = std::size_t{task} * kGrain;
            body(task, static_cast<std::uint32_t>(begin),
                 static_cast<std::uint32_t>(std::min<std::size_t>(n, begin + kGrain)));
        });
    }
    [[nodiscard]] unsigned equal_bits(std::uint32_t t) const {
        return scene_.equal_faces.empty() ? 0 : scene_.equal_faces[t];
    }
    /// Of equal faces the first one stands for all.
    [[nodiscard]] bool dropped(std::uint32_t t) const {
        return (!scene_.degenerate.empty() && scene_.degenerate[t] != 0) ||
               (equal_bits(t) & (kRepeated | kTurnedOver)) != 0;
    }
    [[nodiscard]] std::uint32_t vertex(std::uint32_t position) const {
        return joined_.empty() ? position : joined_[position];
    }
    [[nodiscard]] glm::dvec3 normal(std::uint32_t t) const {
        const Corners c = scene_.triangles[t];
        const glm::dvec3& a = scene_.positions[c.x];
        return glm::cross(scene_.positions[c.y] - a, scene_.positions[c.z] - a);
    }

    void join_positions();
    void find_facing();
    void group_half_edges();
    [[nodiscard]] SceneEdges collect();
    void cut_boundaries(SceneEdges& all) const;
    void collect_vertex(std::uint32_t v, Found& found);
    [[nodiscard]] std::optional<EdgeKind> kind_of(std::span<const HalfEdge> around) const;
    /// Whether a boundary may turn out to be EdgeKind::mesh.
    [[nodiscard]] bool may_be_covered(EdgeKind kind, std::uint32_t face) const {
        return kind == EdgeKind::boundary && kinds_.has(EdgeKind::mesh) &&
               scene_.sheets.of(face) != kNone;
    }
    [[nodiscard]] bool is_polygon_edge(std::span<const HalfEdge> around) const;
    [[nodiscard]] bool is_contour(std::span<const HalfEdge> around) const;
    [[nodiscard]] bool is_sharp(const HalfEdge& f, const HalfEdge& g) const;

    const ScreenScene& page_;
    const Scene& scene_;
    EdgeKinds kinds_;
    double least_cosine_;
    std::vector<std::uint32_t> joined_;   // of each position the first one that equals it, or empty
    std::vector<std::uint8_t> is_front_;  // of each triangle
    std::vector<std::uint32_t> first_;    // half-edges of vertex v: first_[v] .. first_[v + 1] - 1
    std::vector<HalfEdge> half_edges_;
};

// Within an object equal positions share an index already.
void EdgeFinder::join_positions() {
    if (scene_.objects.size() < 2) return;
    AlignedVector<glm::dvec3> points;
    PositionJoiner joiner(points, scene_.positions.size());
    std::vector<std::uint32_t> representative;
    joined_.resize(scene_.positions.size());
    for (std::uint32_t k = 0; k < scene_.positions.size(); ++k) {
        const std::uint32_t point = joiner.add(scene_.positions[k]);
        if (point == representative.size()) representative.push_back(k);
        joined_[k] = representative[point];
    }
}

void EdgeFinder::find_facing() {
    is_front_.resize(scene_.triangles.size());
    for_ranges(is_front_.size(), [&](std::uint32_t, std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t t = begin; t < end; ++t) {
            const Corners c = scene_.triangles[t];
            is_front_[t] = facing(page_.camera(), {scene_.positions[c.x], scene_.positions[c.y],
                                                   scene_.positions[c.z]}) == Facing::front;
        }
    });
}

void EdgeFinder::group_half_edges() {
    first_.assign(scene_.positions.size() + 1, 0);
    const auto each_side = [&](const auto& body) {
        for (std::uint32_t t = 0; t < scene_.triangle_count(); ++t) {
            if (dropped(t)) continue;
            const Corners c = scene_.triangles[t];
            const std::array<std::uint32_t, 3> v = {vertex(c.x), vertex(c.y), vertex(c.z)};
            for (std::uint8_t k = 0; k < 3; ++k) body(t, k, v[k], v[k == 2 ? 0 : k + 1]);
        }
    };
    each_side([&](std::uint32_t, std::uint8_t, std::uint32_t from, std::uint32_t to) {
        ++first_[std::min(from, to)];
    });
    std::uint32_t end = 0;
    for (std::uint32_t& f : first_) f = end += f;
    half_edges_.resize(end);
    each_side([&](std::uint32_t t, std::uint8_t k, std::uint32_t from, std::uint32_t to) {
        half_edges_[--first_[std::min(from, to)]] = {std::max(from, to), t, k, from < to};
    });
}

bool EdgeFinder::is_polygon_edge(std::span<const HalfEdge> around) const {
    return std::ranges::any_of(around, [&](const HalfEdge& h) {
        return (scene_.polygon_edges[h.face] >> h.side & 1) != 0;
    });
}

// Two faces that run along their edge in opposite directions show the same side where one goes on
// from the other; a file whose faces are turned at random has others as well.
bool EdgeFinder::is_contour(std::span<const HalfEdge> around) const {
    const auto shows_front = [&](const HalfEdge& h) { return is_front_[h.face] != 0; };
    if (around.size() == 2) {
        const HalfEdge &f = around[0], &g = around[1];
        if ((shows_front(f) == f.forward) != (shows_front(g) == g.forward)) return false;
    } else if (std::ranges::all_of(around, shows_front) ||
               std::ranges::none_of(around, shows_front)) {
        return false;
    }
    // Halves of a flat polygon show the same side, whatever rounding says when it is edge-on.
    const std::uint32_t sheet = scene_.sheets.of(around[0].face);
    return sheet == kNone || std::ranges::any_of(around, [&](const HalfEdge& h) {
               return scene_.sheets.of(h.face) != sheet;
           });
}

bool EdgeFinder::is_sharp(const HalfEdge& f, const HalfEdge& g) const {
    const glm::dvec3 n = normal(f.face), m = normal(g.face);
    const double cosine = glm::dot(n, m) / std::sqrt(glm::dot(n, n) * glm::dot(m, m));
    return (f.forward != g.forward ? cosine : -cosine) < least_cosine_;
}

std::optional<EdgeKind> EdgeFinder::kind_of(std::span<const HalfEdge> around) const {
    if (is_contour(around)) return EdgeKind::silhouette;
    if (!is_polygon_edge(around)) return std::nullopt;
    if (around.size() == 1) return EdgeKind::boundary;
    const std::uint32_t object = scene_.object_of(around[0].face);
    if (scene_.objects.size() > 1 && std::ranges::any_of(around, [&](const HalfEdge& h) {
            return scene_.object_of(h.face) != object;
        }))
        return EdgeKind::border;
    if (around.size() > 2 || is_sharp(around[0], around[1])) return EdgeKind::crease;
    return EdgeKind::mesh;
}

void EdgeFinder::collect_vertex(std::uint32_t v, Found& found) {
    const auto group = std::span(half_edges_).subspan(first_[v], first_[v + 1] - first_[v]);
    std::ranges::sort(group, [](const HalfEdge& e, const HalfEdge& f) {
        return e.higher != f.higher ? e.higher < f.higher : e.face < f.face;
    });
    for (std::size_t i = 0, end = 0; i < group.size(); i = end) {
        while (end < group.size() && group[end].higher == group[i].higher) ++end;
        const auto around = group.subspan(i, end - i);
        const std::optional<EdgeKind> kind = kind_of(around);
        if (!kind || !(kinds_.has(*kind) || may_be_covered(*kind, around[0].face))) continue;
        const bool culled = std::ranges::all_of(around, [&](const HalfEdge& h) {
            return page_.culled(h.face) && equal_bits(h.face) == 0;
        });
        found.edges.push_back({v, group[i].higher, static_cast<std::uint32_t>(found.faces.size()),
                               static_cast<std::uint32_t>(around.size()), *kind, culled});
        for (const HalfEdge& h : around) found.faces.push_back(h.face);
    }
}

SceneEdges EdgeFinder::collect() {
    const std::size_t n = scene_.positions.size();
    std::vector<Found> tasks((n + kGrain - 1) / kGrain);
    for_ranges(n, [&](std::uint32_t task, std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t v = begin; v < end; ++v) collect_vertex(v, tasks[task]);
    });
    SceneEdges all;
    for (const Found& found : tasks) {
        const auto shift = static_cast<std::uint32_t>(all.faces.size());
        for (SceneEdge edge : found.edges) {
            edge.first_face += shift;
            all.edges.push_back(edge);
        }
        all.faces.insert(all.faces.end(), found.faces.begin(), found.faces.end());
    }
    cut_boundaries(all);
    return all;
}

/// A boundary behind which its own sheet goes on is none.
void EdgeFinder::cut_boundaries(SceneEdges& all) const {
    std::vector<std::uint32_t> open;
    for (std::uint32_t e = 0; e < all.edges.size(); ++e)
        if (all.edges[e].kind == EdgeKind::boundary &&
            scene_.sheets.of(all.faces[all.edges[e].first_face]) != kNone)
            open.push_back(e);
    cut_covered_edges(scene_, open, all);
    std::erase_if(all.edges, [&](const SceneEdge& edge) { return !kinds_.has(edge.kind); });
}

}  // namespace

SceneEdges find_edges(const ScreenScene& page, EdgeKinds kinds, double crease_angle_degrees,
                      int threads) {
    return in_arena(threads, [&] { return EdgeFinder(page, kinds, crease_angle_degrees).find(); });
}

}  // namespace sightline
