// Faces are compared as polygons, so it doesn't matter where a copy begins or how it is cut into
// triangles. The hash of a face is the sum over its corners, in whatever order; most faces find no
// other one with theirs and are done with.
#include "scene/equal_faces.hpp"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <utility>

#include "scene/seen_filter.hpp"

namespace sightline {
namespace {

std::uint64_t key_of(std::uint32_t from, std::uint32_t to) {
    return std::uint64_t{from} << 32 | to;
}

class EqualFaceFinder {
public:
    EqualFaceFinder(const Scene& scene, const Object& object, const JoinedMesh& mesh)
        : scene_(scene), first_(object.first_triangle), mesh_(mesh) {}

    EqualFaces find() {
        std::vector<Face> faces = suspects();
        std::ranges::sort(faces, [](const Face& f, const Face& g) {
            return f.hash != g.hash ? f.hash < g.hash : f.begin < g.begin;
        });
        for (std::size_t i = 0, end = 0; i < faces.size(); i = end) {
            while (end < faces.size() && faces[end].hash == faces[i].hash) ++end;
            if (end - i > 1) compare(std::span(faces).subspan(i, end - i));
        }
        return std::move(found_);
    }

private:
    /// The triangles begin .. end - 1 of one polygon.
    struct Face {
        std::uint64_t hash;
        std::uint32_t begin, end;
    };
    /// The first one of equal faces, and its sides.
    struct Leader {
        Face face;
        std::vector<std::uint64_t> sides;
    };

    /// body(from, to) for each side of the polygon, as its triangles run through them.
    template <class Body>
    void each_side(std::uint32_t begin, std::uint32_t end, const Body& body) const {
        for (std::uint32_t t = begin; t < end; ++t) {
            const Corners& c = mesh_.triangles[t];
            const unsigned edges = scene_.polygon_edges[first_ + t];
            for (int k = 0; k < 3; ++k)
                if ((edges >> k & 1u) != 0) body(c[k], c[k == 2 ? 0 : k + 1]);
        }
    }

    /// body(face) for each polygon.
    template <class Body>
    void each_face(const Body& body) const {
        const auto n = static_cast<std::uint32_t>(mesh_.triangles.size());
        for (std::uint32_t begin = 0, end = 0; begin < n; begin = end) {
            const std::uint32_t polygon = scene_.triangle_polygon[first_ + begin];
            while (end < n && scene_.triangle_polygon[first_ + end] == polygon) ++end;
            std::uint64_t hash = 0;
            each_side(begin, end, [&](std::uint32_t from, std::uint32_t) { hash += mixed(from); });
            body(Face{hash, begin, end});
        }
    }

    /// Faces whose hash is there twice, and a few by chance.
    [[nodiscard]] std::vector<Face> suspects() const {
        SeenFilter seen(mesh_.triangles.size());
        std::vector<std::uint64_t> again;
        std::vector<Face> faces;
        faces.reserve(mesh_.triangles.size());
        each_face([&](const Face& face) {
            if (seen.add(face.hash)) again.push_back(face.hash);
            faces.push_back(face);
        });
        SeenFilter repeated(again.size());
        for (const std::uint64_t hash : again) repeated.add(hash >> 20);
        std::erase_if(faces, [&](const Face& face) { return !repeated.has(face.hash >> 20); });
        return faces;
    }

    [[nodiscard]] std::vector<std::uint64_t> sides_of(const Face& face, bool turned) const {
        std::vector<std::uint64_t> sides;
        each_side(face.begin, face.end, [&](std::uint32_t from, std::uint32_t to) {
            sides.push_back(turned ? key_of(to, from) : key_of(from, to));
        });
        std::ranges::sort(sides);
        return sides;
    }

    /// Whether as many sides begin at each corner as end there: not so of a mere part of a polygon.
    [[nodiscard]] static bool are_loops(std::span<const std::uint64_t> sides) {
        std::vector<std::uint32_t> from, to;
        for (const std::uint64_t side : sides) {
            from.push_back(static_cast<std::uint32_t>(side >> 32));
            to.push_back(static_cast<std::uint32_t>(side));
        }
        std::ranges::sort(to);
        return sides.size() >= 3 && from == to;
    }

    /// Faces of one hash, in ascending order: almost always equal ones.
    void compare(std::span<const Face> faces) {
        std::vector<Leader> leaders;
        for (const Face& face : faces) {
            std::vector<std::uint64_t> sides = sides_of(face, false);
            if (!are_loops(sides)) continue;
            const std::vector<std::uint64_t> turned = sides_of(face, true);
            const auto leader = std::ranges::find_if(leaders, [&](const Leader& other) {
                return other.sides == sides || other.sides == turned;
            });
            if (leader == leaders.end())
                leaders.push_back({face, std::move(sides)});
            else
                mark(leader->face, face, leader->sides != sides);
        }
    }

    void mark(const Face& first, const Face& copy, bool turned) {
        found_.bits.resize(mesh_.triangles.size(), 0);
        ++found_.count;
        found_.two_sided = found_.two_sided || turned;
        const bool repeated = !turned || (found_.bits[first.begin] & kBothSides) != 0;
        for (std::uint32_t t = copy.begin; t < copy.end; ++t)
            found_.bits[t] =
                static_cast<std::uint8_t>((turned ? kTurnedOver : 0) | (repeated ? kRepeated : 0));
        if (!turned) return;
        for (std::uint32_t t = first.begin; t < first.end; ++t) found_.bits[t] = kBothSides;
    }

    const Scene& scene_;
    std::uint32_t first_;  // triangle of the scene
    const JoinedMesh& mesh_;
    EqualFaces found_;
};

/// Turns free faces by going from neighbour to neighbour, those that can't be turned first.
class FaceTurner {
public:
    FaceTurner(const JoinedMesh& mesh, const std::vector<std::uint8_t>& bits,
               std::span<const std::uint8_t> dropped)
        : mesh_(mesh),
          bits_(bits),
          dropped_(dropped),
          neighbours_(mesh.triangles.size(), {kNoLink, kNoLink, kNoLink}),
          reached_(mesh.triangles.size(), 0),
          turned_(mesh.triangles.size(), 0) {}

    std::vector<Corners> run() {
        find_neighbours();
        std::vector<std::uint32_t> queue;
        const auto n = static_cast<std::uint32_t>(mesh_.triangles.size());
        for (std::uint32_t t = 0; t < n; ++t)
            if (is_drawn(t) && bits_[t] != kBothSides) reach(t, queue);
        spread(queue);
        for (std::uint32_t t = 0; t < n; ++t) {
            if (!is_drawn(t) || reached_[t] != 0) continue;
            queue.clear();
            reach(t, queue);
            spread(queue);
            if (volume(queue) < 0)
                for (const std::uint32_t face : queue) turned_[face] ^= 1;
        }
        std::vector<Corners> triangles(mesh_.triangles.begin(), mesh_.triangles.end());
        for (std::uint32_t t = 0; t < n; ++t)
            if (turned_[t] != 0) std::swap(triangles[t].y, triangles[t].z);
        return triangles;
    }

private:
    struct Side {
        std::uint64_t key;
        std::uint32_t face;
        std::uint8_t k;
        bool forward;
    };
    /// Face across a side, and whether both run along it the same way: bit 0.
    using Link = std::uint64_t;
    static constexpr Link kNoLink = ~Link{0};

    [[nodiscard]] bool is_drawn(std::uint32_t t) const { return dropped_[t] == 0; }

    void find_neighbours() {
        std::vector<Side> sides;
        for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
            if (!is_drawn(t)) continue;
            const Corners& c = mesh_.triangles[t];
            for (std::uint8_t k = 0; k < 3; ++k) {
                const std::uint32_t from = c[k], to = c[k == 2 ? 0 : k + 1];
                sides.push_back({key_of(std::min(from, to), std::max(from, to)), t, k, from < to});
            }
        }
        std::ranges::sort(sides, [](const Side& s, const Side& r) {
            return s.key != r.key ? s.key < r.key : s.face < r.face;
        });
        for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
            while (end < sides.size() && sides[end].key == sides[i].key) ++end;
            if (end - i != 2) continue;
            const Side &s = sides[i], &r = sides[i + 1];
            const Link same = s.forward == r.forward ? 1 : 0;
            neighbours_[s.face][s.k] = Link{r.face} << 1 | same;
            neighbours_[r.face][r.k] = Link{s.face} << 1 | same;
        }
    }
    void reach(std::uint32_t face, std::vector<std::uint32_t>& queue) {
        reached_[face] = 1;
        queue.push_back(face);
    }
    void spread(std::vector<std::uint32_t>& queue) {
        for (std::size_t i = 0; i < queue.size(); ++i) {
            for (const Link link : neighbours_[queue[i]]) {
                if (link == kNoLink) continue;
                const auto other = static_cast<std::uint32_t>(link >> 1);
                if (reached_[other] != 0) continue;
                turned_[other] = static_cast<std::uint8_t>(turned_[queue[i]] ^ (link & 1));
                reach(other, queue);
            }
        }
    }
    [[nodiscard]] double volume(const std::vector<std::uint32_t>& faces) const {
        double sum = 0;
        const glm::dvec3 origin = mesh_.points[mesh_.triangles[faces[0]].x];
        for (const std::uint32_t t : faces) {
            const Corners& c = mesh_.triangles[t];
            const double part =
                glm::dot(mesh_.points[c.x] - origin,
                         glm::cross(mesh_.points[c.y] - origin, mesh_.points[c.z] - origin));
            sum += turned_[t] != 0 ? -part : part;
        }
        return sum;
    }

    const JoinedMesh& mesh_;
    const std::vector<std::uint8_t>& bits_;
    std::span<const std::uint8_t> dropped_;
    std::vector<std::array<Link, 3>> neighbours_;
    std::vector<std::uint8_t> reached_, turned_;
};

}  // namespace

EqualFaces find_equal_faces(const Scene& scene, const Object& object, const JoinedMesh& mesh) {
    return EqualFaceFinder(scene, object, mesh).find();
}

std::vector<Corners> turned_alike(const JoinedMesh& mesh, const std::vector<std::uint8_t>& bits,
                                  std::span<const std::uint8_t> dropped) {
    return FaceTurner(mesh, bits, dropped).run();
}

}  // namespace sightline
