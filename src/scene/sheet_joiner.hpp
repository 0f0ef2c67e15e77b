// Joining the sheets of several parts of a scene (files).
//
// Within a part, sheets are found face by face (sheets.hpp). Between parts they are joined as
// wholes: a sheet, or a face without one, joins that with the largest seed of which the plane holds
// all its corners. So who joins parts needs to know of each only what may lie in a plane with
// another part, and parts may be looked at one at a time; and a scene of one part is not concerned.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/plane_index.hpp"
#include "scene/sheets.hpp"

namespace sightline {

/// A sheet of one part, or a face that has none.
struct SheetNode {
    std::uint32_t part = 0;
    FacePlane plane;                     ///< of the largest face
    std::array<glm::dvec3, 3> seed{};    ///< its corners
    std::uint32_t first = 0, count = 0;  ///< members, in SheetJoiner::members()
};

class SheetJoiner {
public:
    explicit SheetJoiner(const SheetScale& scale) : scale_(scale) {}

    /// Adds what is_shared(plane, a point of it) says may lie in a plane with another part: sheets
    /// and single faces of a part, whose sheets find_part_sheets() has found as those from number
    /// `first_sheet` on.
    template <class IsShared>
    void add_part(const Scene& scene, TriangleRun run, std::uint32_t part,
                  std::span<const std::uint32_t> seeds, std::uint32_t first_sheet,
                  const IsShared& is_shared) {
        const Sheets& sheets = scene.sheets;
        for (std::size_t s = first_sheet; s < sheets.first.size(); ++s) {
            const std::size_t end =
                s + 1 < sheets.first.size() ? sheets.first[s + 1] : sheets.members.size();
            const std::uint32_t seed = seeds[s];
            if (seed < run.first || seed - run.first >= run.count) break;  // of the next part
            add_if(scene, run, part, seed,
                   std::span(sheets.members).subspan(sheets.first[s], end - sheets.first[s]),
                   is_shared);
        }
        for (std::uint32_t t = run.first; t < run.first + run.count; ++t)
            if (sheets.of(t) == kNone) add_if(scene, run, part, t, std::span(&t, 1), is_shared);
    }

    /// Groups of two and more nodes that lie in one plane, of different parts; numbers of nodes.
    [[nodiscard]] std::vector<std::vector<std::uint32_t>> join() const;

    [[nodiscard]] const std::vector<SheetNode>& nodes() const { return nodes_; }
    /// Triangles of a node, numbered from the first of their part.
    [[nodiscard]] std::span<const std::uint32_t> members(const SheetNode& node) const {
        return std::span(members_).subspan(node.first, node.count);
    }
    /// Three corners for each of them.
    [[nodiscard]] std::span<const glm::dvec3> corners(const SheetNode& node) const {
        return std::span(corners_).subspan(3 * std::size_t{node.first},
                                           3 * std::size_t{node.count});
    }

private:
    template <class IsShared>
    void add_if(const Scene& scene, TriangleRun run, std::uint32_t part, std::uint32_t seed,
                std::span<const std::uint32_t> members, const IsShared& is_shared) {
        const FacePlane plane = plane_of_face(scene, scale_, seed);
        if (plane.is_usable() && is_shared(plane, scene.positions[scene.triangles[seed].x]))
            add(scene, run, part, plane, seed, members);
    }
    void add(const Scene& scene, TriangleRun run, std::uint32_t part, const FacePlane& plane,
             std::uint32_t seed, std::span<const std::uint32_t> members);
    [[nodiscard]] bool comes_before(std::uint32_t a, std::uint32_t b) const;
    [[nodiscard]] bool takes(const SheetNode& seed, const SheetNode& other) const;

    SheetScale scale_;
    std::vector<SheetNode> nodes_;
    std::vector<std::uint32_t> members_;
    std::vector<glm::dvec3> corners_;
};

}  // namespace sightline
