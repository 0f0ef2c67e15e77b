// Candidates are the ends of open edges: sides of one face alone. On them only can a seam be, so a
// closed surface is never touched, however thin, and an open one pays for one pass over its faces.
//
// 1. Around a position inside of a surface every neighbour is met twice. So the exclusive or of the
//    hash values of its neighbours is 0 there; on an open edge it is not (but for a chance of 2^-64
//    each).
// 2. What has no other candidate near it is dismissed by a SeenFilter over a grid of wide cells,
//    and once more as long as that helps.
// 3. Of the rest the open edges are found exactly. Each has a reach: the tolerance, or a
//    sixteenth of the shortest open edge at it, so that what is as small as the tolerance keeps
//    its shape.
// 4. In ascending order each is joined to the lowest one before it that was not joined itself, or
//    stays. Those that stay are kept in a hash table of grids, one for each size of reach (M.
//    Teschner and others, "Optimized Spatial Hashing for Collision Detection of Deformable
//    Objects", 2003): they lie apart by about a cell, so few of them are in one.
#include "scene/weld.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "scene/seen_filter.hpp"
#include "scene/tolerance.hpp"

namespace sightline {
namespace {

struct Ball {
    glm::dvec3 centre;
    double radius;
};

/// visit(hash) for the cells of a grid that a ball meets; its diameter is a cell at most.
template <class Visit>
void each_cell(const Ball& ball, double cell, const Visit& visit) {
    // A cell is a power of two, and rounding keeps the order: nothing in the ball is missed.
    const glm::dvec3 low = glm::floor((ball.centre - ball.radius) / cell);
    const glm::dvec3 high = glm::floor((ball.centre + ball.radius) / cell);
    for (double x = low.x; x <= high.x; ++x)
        for (double y = low.y; y <= high.y; ++y)
            for (double z = low.z; z <= high.z; ++z) visit(hash_of({x, y, z}));
}

/// That of a point.
std::uint64_t cell_at(const glm::dvec3& point, double cell) {
    return hash_of(glm::floor(point / cell) + 0.0);
}

/// Points that were not joined, in grids.
class Kept {
public:
    explicit Kept(std::size_t expected)
        : heads_(std::bit_ceil(2 * expected + 1), kNone), mask_(heads_.size() - 1) {}

    void add(std::uint32_t point, const Ball& ball) {
        const double cell = cell_for(ball.radius);
        if (!std::ranges::count(cells_, cell)) cells_.push_back(cell);
        std::uint32_t& head = heads_[slot(cell_at(ball.centre, cell), cell)];
        entries_.push_back({point, head});
        head = static_cast<std::uint32_t>(entries_.size() - 1);
    }
    /// visit(point) for all that may be within both their own reach and that of the ball.
    template <class Visit>
    void near(const Ball& ball, const Visit& visit) const {
        for (const double cell : cells_) {
            each_cell({ball.centre, std::min(ball.radius, 0.5 * cell)}, cell,
                      [&](std::uint64_t hash) {
                          for (std::uint32_t e = heads_[slot(hash, cell)]; e != kNone;
                               e = entries_[e].next)
                              visit(entries_[e].point);
                      });
        }
    }

private:
    struct Entry {
        std::uint32_t point, next;
    };
    /// The least power of two that is larger than the diameter.
    [[nodiscard]] static double cell_for(double radius) {
        return std::ldexp(1.0, std::ilogb(radius) + 2);
    }
    [[nodiscard]] std::size_t slot(std::uint64_t hash, double cell) const {
        return static_cast<std::size_t>(mixed(hash + std::bit_cast<std::uint64_t>(cell)) & mask_);
    }

    std::vector<std::uint32_t> heads_;
    std::uint64_t mask_;
    std::vector<Entry> entries_;
    std::vector<double> cells_;  // of the grids
};

class Welder {
public:
    Welder(const ObjectJoiner& joiner, const Object& object, const JoinedMesh& mesh,
           std::span<const std::uint8_t> dropped, double rounding, double weld)
        : joiner_(joiner), object_(object), mesh_(mesh), dropped_(dropped) {
        Box box{mesh.points[mesh.triangles[0].x], mesh.points[mesh.triangles[0].x]};
        for (const Corners& c : mesh.triangles)
            for (int k = 0; k < 3; ++k)
                box = {glm::min(box.lo, mesh.points[c[k]]), glm::max(box.hi, mesh.points[c[k]])};
        origin_ = box.lo;
        tolerance_ = weld * size_of(box, rounding);
        least_ = kLeast * size_of(box, rounding);
    }

    /// Of each point the one it is joined to, itself mostly; empty when none is joined.
    std::vector<std::uint32_t> find() {
        if (!(tolerance_ > least_)) return {};
        std::vector<std::uint32_t> points = uneven_points();
        std::uint64_t seed = 0;
        for (std::size_t before = points.size() + 1; points.size() < before; ++seed) {
            before = points.size();
            keep_near(points, seed);
        }
        if (points.empty()) return {};
        find_reaches(points);
        std::erase_if(points, [&](std::uint32_t v) { return reach_[v] == 0; });
        if (!any_are_near(points)) return {};
        index_ = joiner_.indices_of(object_, mesh_);
        std::ranges::sort(points, {}, [&](std::uint32_t v) { return index_[v]; });
        return join(points);
    }
    /// Of each point, in the scene. After find() has found something.
    [[nodiscard]] const std::vector<std::uint32_t>& index() const { return index_; }

private:
    static constexpr double kEdgeShare = 1.0 / 16;
    static constexpr double kWideCell = 64;  // tolerances: most balls meet one only
    // Tolerances below this part of the size are none: doubles leave few bits of such differences.
    static constexpr double kLeast = 0x1p-46;

    [[nodiscard]] bool is_dropped(std::uint32_t t) const {
        return !dropped_.empty() && dropped_[t] != 0;
    }
    [[nodiscard]] glm::dvec3 point(std::uint32_t v) const { return mesh_.points[v] - origin_; }

    template <class Body>
    void each_face(const Body& body) const {
        for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
            if (!is_dropped(t)) body(mesh_.triangles[t]);
    }

    [[nodiscard]] std::vector<std::uint32_t> uneven_points() const {
        std::vector<std::uint64_t> sums(mesh_.points.size(), 0);
        each_face([&](const Corners& c) {
            const std::uint64_t x = mixed(c.x + 1u), y = mixed(c.y + 1u), z = mixed(c.z + 1u);
            sums[c.x] ^= y ^ z;
            sums[c.y] ^= z ^ x;
            sums[c.z] ^= x ^ y;
        });
        std::vector<std::uint32_t> points;
        for (std::uint32_t v = 0; v < sums.size(); ++v)
            if (sums[v] != 0) points.push_back(v);
        return points;
    }

    using WideCell = glm::i64vec3;
    struct Place {
        WideCell cell;
        glm::i8vec3 step;  // to which neighbours of the cell the ball of the point reaches
        std::uint64_t hash;
    };
    [[nodiscard]] Place place_of(std::uint32_t v, std::uint64_t seed) const {
        // The tolerance in cells, and a sixteenth more for the rounding of coordinates below 2^41.
        constexpr double kReach = 1.0625 / kWideCell;
        const glm::dvec3 at = point(v) / (kWideCell * tolerance_);
        Place place;
        std::uint64_t key = 0;
        for (int k = 0; k < 3; ++k) {
            const auto cell = static_cast<std::int64_t>(at[k]);
            const double within = at[k] - static_cast<double>(cell);
            place.cell[k] = cell;
            place.step[k] = static_cast<std::int8_t>((within > 1 - kReach) - (within < kReach));
            key ^= static_cast<std::uint64_t>(cell) << 21 * k;
        }
        place.hash = hash_of(key, seed);
        return place;
    }
    [[nodiscard]] static std::uint64_t hash_of(std::uint64_t key, std::uint64_t seed) {
        return mixed(key + seed * 0x9E3779B97F4A7C15u);
    }
    [[nodiscard]] static std::uint64_t hash_of(const WideCell& cell, std::uint64_t seed) {
        const glm::u64vec3 c(cell);
        return hash_of(c.x ^ c.y << 21 ^ c.z << 42, seed);
    }

    /// Dismisses what has no other one near it, and leaves a few of those by chance: other ones for
    /// another `seed`. In blocks, so that the memory of the filter is fetched ahead.
    void keep_near(std::vector<std::uint32_t>& points, std::uint64_t seed) const {
        constexpr std::size_t kBlock = 32;
        SeenFilter seen(points.size());
        std::vector<std::uint64_t> hashes;  // of each point's cell
        hashes.reserve(points.size());
        std::vector<std::uint64_t> cells;  // of those that may be near an earlier one, and around
        std::array<Place, kBlock> places;
        for (std::size_t begin = 0; begin < points.size(); begin += kBlock) {
            const std::size_t n = std::min(kBlock, points.size() - begin);
            for (std::size_t i = 0; i < n; ++i) {
                places[i] = place_of(points[begin + i], seed);
                hashes.push_back(places[i].hash);
                seen.fetch(places[i].hash);
            }
            for (const Place& place : std::span(places).first(n)) add(place, seed, seen, cells);
        }
        SeenFilter near(cells.size());
        for (const std::uint64_t cell : cells) near.add(cell >> 20);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (near.has(hashes[i] >> 20)) points[kept++] = points[i];
        points.resize(kept);
    }
    static void add(const Place& place, std::uint64_t seed, SeenFilter& seen,
                    std::vector<std::uint64_t>& cells) {
        bool is_near = seen.add(place.hash);
        const WideCell step(place.step);
        if (step != WideCell(0))
            each_towards(place.cell, step, [&](const WideCell& cell) {
                is_near = is_near || seen.has(hash_of(cell, seed));
            });
        if (!is_near) return;
        cells.push_back(place.hash);
        each_towards(place.cell, step,
                     [&](const WideCell& cell) { cells.push_back(hash_of(cell, seed)); });
    }
    /// visit(cell) for the neighbours on these sides.
    template <class Visit>
    static void each_towards(const WideCell& own, const WideCell& step, const Visit& visit) {
        for (int corner = 1; corner < 8; ++corner) {
            const WideCell part(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
            if (const WideCell away = part * step; away != WideCell(0)) visit(own + away);
        }
    }

    /// Sides of faces at these points.
    [[nodiscard]] std::vector<std::uint64_t> sides_at(const std::vector<std::uint32_t>& points) {
        std::vector<std::uint8_t> wanted(mesh_.points.size(), 0);
        for (const std::uint32_t v : points) wanted[v] = 1;
        std::vector<std::uint64_t> sides;
        each_face([&](const Corners& c) {
            for (int k = 0; k < 3; ++k) {
                const std::uint32_t a = c[k], b = c[k == 2 ? 0 : k + 1];
                if ((wanted[a] | wanted[b]) != 0)
                    sides.push_back(std::uint64_t{std::min(a, b)} << 32 | std::max(a, b));
            }
        });
        return sides;
    }

    void find_reaches(const std::vector<std::uint32_t>& points) {
        reach_.assign(mesh_.points.size(), 0);
        std::vector<std::uint64_t> sides = sides_at(points);
        std::ranges::sort(sides);
        for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
            while (end < sides.size() && sides[end] == sides[i]) ++end;
            if (end - i > 1) continue;
            const auto a = static_cast<std::uint32_t>(sides[i] >> 32);
            const auto b = static_cast<std::uint32_t>(sides[i]);
            const double reach =
                std::min(tolerance_, kEdgeShare * glm::distance(point(a), point(b)));
            for (const std::uint32_t v : {a, b})
                reach_[v] = reach_[v] > 0 ? std::min(reach_[v], reach) : reach;
        }
        for (double& reach : reach_)
            if (reach < least_) reach = 0;
    }

    [[nodiscard]] bool are_near(std::uint32_t v, std::uint32_t other) const {
        const glm::dvec3 way = point(other) - point(v);
        const double reach = std::min(reach_[v], reach_[other]);
        return glm::dot(way, way) <= reach * reach;
    }
    /// Whether there is anything to join: what else is needed takes its time and memory.
    [[nodiscard]] bool any_are_near(const std::vector<std::uint32_t>& points) const {
        Kept kept(points.size());
        for (const std::uint32_t v : points) {
            const Ball ball{point(v), reach_[v]};
            bool found = false;
            kept.near(ball, [&](std::uint32_t other) { found = found || are_near(v, other); });
            if (found) return true;
            kept.add(v, ball);
        }
        return false;
    }

    [[nodiscard]] std::vector<std::uint32_t> join(const std::vector<std::uint32_t>& points) const {
        std::vector<std::uint32_t> target(mesh_.points.size());
        for (std::uint32_t v = 0; v < target.size(); ++v) target[v] = v;
        const CornersOfVertices around(mesh_);
        Kept kept(points.size());
        bool any = false;
        for (const std::uint32_t v : points) {
            std::uint32_t best = v;
            kept.near({point(v), reach_[v]}, [&](std::uint32_t other) {
                if (best != v && index_[best] <= index_[other]) return;
                if (are_near(v, other) && !share_a_face(around, target, v, other)) best = other;
            });
            target[v] = best;
            any = any || best != v;
            if (best == v) kept.add(v, {point(v), reach_[v]});
        }
        if (!any) target.clear();
        return target;
    }

    /// Whether a face at v has another corner at this point, or one that was joined to it.
    [[nodiscard]] bool share_a_face(const CornersOfVertices& around,
                                    const std::vector<std::uint32_t>& target, std::uint32_t v,
                                    std::uint32_t other) const {
        for (std::uint64_t i = around.first[v]; i < around.first[v + 1]; ++i) {
            const Corners& c = mesh_.triangles[around.corners[i] / 3];
            if (target[c.x] == other || target[c.y] == other || target[c.z] == other) return true;
        }
        return false;
    }

    const ObjectJoiner& joiner_;
    const Object& object_;
    const JoinedMesh& mesh_;
    std::span<const std::uint8_t> dropped_;
    std::vector<std::uint32_t> index_;
    glm::dvec3 origin_{};
    double tolerance_ = 0, least_ = 0;
    std::vector<double> reach_;  // of each point; 0: it is not on an open edge
};

}  // namespace

void find_joins(const ObjectJoiner& joiner, const Object& object, const JoinedMesh& mesh,
                std::span<const std::uint8_t> dropped, double rounding, double weld, Joins& joins) {
    Welder welder(joiner, object, mesh, dropped, rounding, weld);
    const std::vector<std::uint32_t> target = welder.find();
    if (target.empty()) return;
    for (std::uint32_t v = 0; v < target.size(); ++v) joins.positions += target[v] != v ? 1 : 0;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t v = mesh.triangles[t][k];
            if (target[v] == v) continue;
            const std::uint64_t corner = std::uint64_t{3} * (object.first_triangle + t);
            joins.corners.push_back(
                {corner + static_cast<std::uint64_t>(k), welder.index()[target[v]]});
        }
    }
}

void apply(const Joins& joins, Scene& scene) {
    for (const Joins::Corner& c : joins.corners)
        scene.triangles[c.corner / 3][static_cast<int>(c.corner % 3)] = c.position;
    scene.counts.joined_positions += joins.positions;
}

void join_equal_positions(Scene& scene) {
    ObjectJoiner joiner(scene);
    for (const Object& object : scene.objects) {
        const JoinedMesh mesh = joiner.join(object);
        const std::vector<std::uint32_t> index = joiner.indices_of(object, mesh);
        for (std::uint32_t t = 0; t < object.triangle_count; ++t)
            for (int k = 0; k < 3; ++k)
                scene.triangles[object.first_triangle + t][k] = index[mesh.triangles[t][k]];
    }
}

}  // namespace sightline
