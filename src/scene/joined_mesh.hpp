// An object's triangles on joined positions: corners at equal positions share one index.
//
// Positions are equal when their bits are, after -0 has become +0: the tolerance is none, so
// joining never moves a point and never depends on an order.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sightline/scene.hpp"

namespace sightline {

/// Appends distinct positions to a vector: a hash table over what it has appended itself.
class PositionJoiner {
public:
    /// `points` must outlive the joiner; what it holds already takes no part in the joining.
    /// Quickest when no more than `expected` positions are added.
    explicit PositionJoiner(AlignedVector<glm::dvec3>& points, std::size_t expected = 0);

    /// Index in `points` of this position, appended when new. Amortised O(1).
    /// Precondition: finite; fewer than 2^32 - 1 points.
    std::uint32_t add(glm::dvec3 position);
    /// Asks the processor to have at hand what add() will need for this position soon.
    void expect(const glm::dvec3& position) const;

private:
    void grow();
    [[nodiscard]] std::size_t first_slot_of(const glm::dvec3& position) const;
    [[nodiscard]] std::size_t slot_of(const glm::dvec3& position) const;

    AlignedVector<glm::dvec3>& points_;
    std::size_t base_;                  ///< first point of this joiner
    std::vector<std::uint32_t> slots_;  ///< index of a point, or kNone; a power of two long
};

/// Spreads the bits of three doubles over 64 bits.
[[nodiscard]] std::uint64_t hash_of(const glm::dvec3& p);

/// Triangles of one object on joined points. The arrays are somebody else's.
struct JoinedMesh {
    std::span<const glm::dvec3> points;  ///< not all of them need be used
    std::span<const Corners> triangles;  ///< in the object's order
};

/// Joins the objects of a scene one after another with one piece of scratch memory. Not
/// thread-safe.
class ObjectJoiner {
public:
    /// `joined`: equal positions of an object share an index in the scene already.
    explicit ObjectJoiner(const Scene& scene, bool joined = false);
    /// Valid until the next call, and as long as the scene's positions and triangles stay.
    [[nodiscard]] JoinedMesh join(const Object& object);
    /// The lowest index that each point of the object's mesh has in the scene.
    [[nodiscard]] std::vector<std::uint32_t> indices_of(const Object& object,
                                                        const JoinedMesh& mesh) const;

private:
    const Scene& scene_;
    bool is_joined_;
    AlignedVector<glm::dvec3> points_;
    AlignedVector<Corners> triangles_;
    std::vector<std::uint32_t> joined_;  ///< of each scene position, or kNone between two calls
};

/// Two corners equal, or a cross product of two sides that is exactly zero in doubles.
[[nodiscard]] bool is_degenerate(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

/// Corners grouped by the vertex they stand at: those of vertex v are
/// corners[first[v]] .. corners[first[v + 1] - 1], in ascending order; corner k of triangle t is
/// 3 t + k.
struct CornersOfVertices {
    std::vector<std::uint64_t> first;
    std::vector<std::uint64_t> corners;

    CornersOfVertices(const JoinedMesh& mesh);
};

}  // namespace sightline
