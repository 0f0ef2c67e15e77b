#include "scene/sheet_joiner.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace sightline {

void SheetJoiner::add(const Scene& scene, TriangleRun run, std::uint32_t part,
                      const FacePlane& plane, std::uint32_t seed,
                      std::span<const std::uint32_t> members) {
    const auto corner = [&](std::uint32_t t, int k) {
        return scene.positions[scene.triangles[t][k]];
    };
    nodes_.push_back({part,
                      plane,
                      {corner(seed, 0), corner(seed, 1), corner(seed, 2)},
                      static_cast<std::uint32_t>(members_.size()),
                      static_cast<std::uint32_t>(members.size())});
    for (const std::uint32_t t : members) {
        members_.push_back(t - run.first);
        for (int k = 0; k < 3; ++k) corners_.push_back(corner(t, k));
    }
}

// By the seed's area, then by its place; the part decides only between copies of one face.
bool SheetJoiner::comes_before(std::uint32_t a, std::uint32_t b) const {
    const SheetNode &m = nodes_[a], &n = nodes_[b];
    if (m.plane.area2 != n.plane.area2) return m.plane.area2 > n.plane.area2;
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 &p = m.seed[k], &q = n.seed[k];
        const auto pt = std::tie(p.x, p.y, p.z), qt = std::tie(q.x, q.y, q.z);
        if (pt != qt) return pt < qt;
    }
    return a < b;
}

bool SheetJoiner::takes(const SheetNode& seed, const SheetNode& other) const {
    return seed.part != other.part && are_parallel(seed.plane.normal, other.plane.normal) &&
           std::ranges::all_of(corners(other), [&](const glm::dvec3& corner) {
               return scale_.holds(seed.plane, corner);
           });
}

std::vector<std::vector<std::uint32_t>> SheetJoiner::join() const {
    PlaneIndex index;
    for (std::uint32_t i = 0; i < nodes_.size(); ++i)
        index.add(nodes_[i].plane.normal, nodes_[i].seed[0], i);
    index.finish();
    std::vector<std::uint32_t> order(nodes_.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) { return comes_before(a, b); });
    std::vector<std::vector<std::uint32_t>> groups;
    std::vector<bool> taken(nodes_.size());
    std::vector<std::uint32_t> near;
    for (const std::uint32_t seed : order) {
        if (taken[seed]) continue;
        const SheetNode& node = nodes_[seed];
        index.find(scale_, node.plane.normal, node.seed[0], near);
        std::erase_if(near, [&](std::uint32_t n) { return taken[n] || !takes(node, nodes_[n]); });
        if (near.empty()) continue;
        near.push_back(seed);
        for (const std::uint32_t n : near) taken[n] = true;
        groups.push_back(near);
    }
    return groups;
}

void join_sheets_of_parts(Scene& scene, const SheetScale& scale,
                          const std::vector<TriangleRun>& parts,
                          const std::vector<std::uint32_t>& seeds) {
    Sheets& sheets = scene.sheets;
    std::vector<std::uint32_t> first_sheet;
    PlaneIndex index;
    const auto add = [&](std::uint32_t face, std::uint32_t part) {
        const FacePlane plane = plane_of_face(scene, scale, face);
        if (plane.is_usable())
            index.add(plane.normal, scene.positions[scene.triangles[face].x], part);
    };
    std::uint32_t s = 0;
    for (std::uint32_t part = 0; part < parts.size(); ++part) {
        first_sheet.push_back(s);
        const std::uint32_t end = parts[part].first + parts[part].count;
        for (; s < seeds.size() && seeds[s] < end; ++s) add(seeds[s], part);
        for (std::uint32_t t = parts[part].first; t < end; ++t)
            if (sheets.of(t) == kNone) add(t, part);
        index.tidy();
    }
    index.finish();
    SheetJoiner joiner(scale);
    for (std::uint32_t part = 0; part < parts.size(); ++part)
        joiner.add_part(scene, parts[part], part, seeds, first_sheet[part],
                        [&](const FacePlane& plane, const glm::dvec3& point) {
                            return index.has_other(scale, plane.normal, point, part);
                        });
    auto number = static_cast<std::uint32_t>(sheets.first.size());
    for (const auto& group : joiner.join()) {
        if (sheets.of_triangle.empty()) sheets.of_triangle.assign(scene.triangles.size(), kNone);
        for (const std::uint32_t n : group) {
            const SheetNode& node = joiner.nodes()[n];
            for (const std::uint32_t t : joiner.members(node))
                sheets.of_triangle[parts[node.part].first + t] = number;
        }
        ++number;
    }
}

}  // namespace sightline
