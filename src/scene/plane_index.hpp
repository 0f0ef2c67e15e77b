// Many planes, to find those that may be coplanar with another one: a sorted row of 16 bytes each.
//
// Planes are added before the size of the whole scene is known; only the search needs it. A record
// holds in which cell of 2^-10 a normal lies, and the distance of the plane from a fixed point to
// 16 bits, so equal planes of one number are stored once, and what is found is a little more than
// what is coplanar.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "scene/sheets.hpp"

namespace sightline {

class PlaneIndex {
public:
    /// A plane by its unit normal and a point of it, under a number.
    void add(const glm::dvec3& normal, const glm::dvec3& point, std::uint32_t number);
    /// Equal planes of one number, among those added since the last call, become one.
    void tidy();
    /// After the last plane. O(n log n).
    void finish();

    [[nodiscard]] std::size_t size() const { return records_.size(); }

    /// Whether there is a plane of another number that may agree with this one in a scene of such a
    /// scale: their normals do, and all corners of a face in one of them lie in the other. No such
    /// plane is missed. O(log n). Precondition: all faces lie in the bounds of the scale.
    [[nodiscard]] bool has_other(const SheetScale& scale, const glm::dvec3& normal,
                                 const glm::dvec3& point, std::uint32_t number) const;
    /// For each number below `count`, whether that may hold of any of its planes. O(n log n).
    [[nodiscard]] std::vector<bool> shared_numbers(const SheetScale& scale,
                                                   std::uint32_t count) const;
    /// The numbers of all those planes, in ascending order, its own among them.
    void find(const SheetScale& scale, const glm::dvec3& normal, const glm::dvec3& point,
              std::vector<std::uint32_t>& numbers) const;

private:
    struct Record {
        std::uint64_t key;
        std::uint32_t number;
        std::uint32_t next_other;  ///< the first record behind it that has another number
    };

    /// A plane by its distance from the origin; `uncertain`: how far the coordinates of its normal
    /// may be off.
    struct Query {
        glm::dvec3 normal;
        double distance;
        double uncertain = 0;
    };

    [[nodiscard]] Query query(const glm::dvec3& normal, const glm::dvec3& point) const;
    [[nodiscard]] bool has_other(const SheetScale& scale, const Query& query,
                                 std::uint32_t number) const;
    /// visit(first, end) for ranges of records, until it answers true; returns whether it did.
    template <class Visit>
    bool any_range(const SheetScale& scale, const Query& query, const Visit& visit) const;

    std::optional<glm::dvec3> origin_;  // distances are measured from here: a point of the scene
    std::vector<Record> records_;
    std::size_t tidy_until_ = 0;
};

}  // namespace sightline
