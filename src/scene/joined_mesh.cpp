#include "scene/joined_mesh.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <glm/geometric.hpp>

namespace sightline {
namespace {

constexpr std::size_t kFirstSlots = 64;

}  // namespace

// The multiply-and-shift mixing of MurmurHash3 (Austin Appleby, public domain) after each
// coordinate.
std::uint64_t hash_of(const glm::dvec3& p) {
    std::uint64_t h = 0;
    for (int axis = 0; axis < 3; ++axis) {
        h = (h ^ std::bit_cast<std::uint64_t>(p[axis])) * 0xff51afd7ed558ccdull;
        h ^= h >> 32;
    }
    return h;
}

PositionJoiner::PositionJoiner(AlignedVector<glm::dvec3>& points, std::size_t expected)
    : points_(points),
      base_(points.size()),
      slots_(std::bit_ceil(std::max(kFirstSlots, 2 * expected)), kNone) {}

std::size_t PositionJoiner::first_slot_of(const glm::dvec3& position) const {
    return static_cast<std::size_t>(hash_of(position)) & (slots_.size() - 1);
}

std::size_t PositionJoiner::slot_of(const glm::dvec3& position) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = first_slot_of(position);
    while (slots_[slot] != kNone && points_[slots_[slot]] != position) slot = (slot + 1) & mask;
    return slot;
}

std::uint32_t PositionJoiner::add(glm::dvec3 position) {
    position += 0.0;  // -0 becomes +0, everything else stays
    const std::size_t slot = slot_of(position);
    if (slots_[slot] != kNone) return slots_[slot];
    const std::size_t index = points_.size();
    assert(index < kNone);
    points_.push_back(position);
    slots_[slot] = static_cast<std::uint32_t>(index);
    if (2 * (points_.size() - base_) > slots_.size()) grow();
    return static_cast<std::uint32_t>(index);
}

void PositionJoiner::expect(const glm::dvec3& position) const {
    __builtin_prefetch(&slots_[first_slot_of(position + 0.0)]);
}

void PositionJoiner::grow() {
    slots_.assign(4 * slots_.size(), kNone);
    for (std::size_t i = base_; i < points_.size(); ++i) {
        slots_[slot_of(points_[i])] = static_cast<std::uint32_t>(i);
    }
}

ObjectJoiner::ObjectJoiner(const Scene& scene, bool joined)
    : scene_(scene), is_joined_(joined), joined_(scene.positions.size(), kNone) {}

JoinedMesh ObjectJoiner::join(const Object& object) {
    // The only one has joined points already: those of the scene.
    if (is_joined_ && object.triangle_count == scene_.triangles.size())
        return {scene_.positions, scene_.triangles};
    points_.clear();
    triangles_.clear();
    PositionJoiner joiner(points_);
    const auto add = [&](const glm::dvec3& position) {
        if (!is_joined_) return joiner.add(position);
        points_.push_back(position);
        return static_cast<std::uint32_t>(points_.size() - 1);
    };
    triangles_.reserve(object.triangle_count);
    const auto end = object.first_triangle + object.triangle_count;
    for (std::uint32_t t = object.first_triangle; t < end; ++t) {
        Corners corners{};
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t position = scene_.triangles[t][k];
            std::uint32_t& joined = joined_[position];
            if (joined == kNone) joined = add(scene_.positions[position]);
            corners[k] = joined;
        }
        triangles_.push_back(corners);
    }
    for (std::uint32_t t = object.first_triangle; t < end; ++t) {
        for (int k = 0; k < 3; ++k) joined_[scene_.triangles[t][k]] = kNone;
    }
    return {points_, triangles_};
}

std::vector<std::uint32_t> ObjectJoiner::indices_of(const Object& object,
                                                    const JoinedMesh& mesh) const {
    std::vector<std::uint32_t> lowest(mesh.points.size(), kNone);
    for (std::uint32_t t = 0; t < object.triangle_count; ++t) {
        for (int k = 0; k < 3; ++k) {
            std::uint32_t& index = lowest[mesh.triangles[t][k]];
            index = std::min(index, scene_.triangles[object.first_triangle + t][k]);
        }
    }
    return lowest;
}

bool is_degenerate(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return a == b || b == c || c == a || glm::cross(b - a, c - a) == glm::dvec3{0, 0, 0};
}

CornersOfVertices::CornersOfVertices(const JoinedMesh& mesh)
    : first(mesh.points.size() + 1, 0), corners(3 * mesh.triangles.size()) {
    for (const Corners& t : mesh.triangles) {
        for (int k = 0; k < 3; ++k) ++first[t[k]];
    }
    std::uint64_t end = 0;
    for (std::uint64_t& f : first) f = end += f;
    // Filled from the back, which leaves every first[v] at its start and the corners ascending.
    for (std::size_t t = mesh.triangles.size(); t-- > 0;) {
        for (int k = 3; k-- > 0;) {
            corners[--first[mesh.triangles[t][k]]] = 3 * t + static_cast<std::uint64_t>(k);
        }
    }
}

}  // namespace sightline
