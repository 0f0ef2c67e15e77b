#include "scene/load/polygon_edges.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <map>
#include <utility>

#include "scene/joined_mesh.hpp"

namespace sightline::load {
namespace {

bool has_no_area(std::span<const glm::dvec3> corners, const PolygonTriangle& t) {
    return is_degenerate(corners[t[0]], corners[t[1]], corners[t[2]]);
}

/// Hands the marks of triangles without area on.
class MarkPasser {
public:
    MarkPasser(std::span<const glm::dvec3> corners, std::span<const PolygonTriangle> triangles,
               std::vector<std::uint8_t>& bits)
        : corners_(corners), triangles_(triangles), bits_(bits) {
        for (std::uint32_t t = 0; t < triangles.size(); ++t) {
            for (unsigned k = 0; k < 3; ++k) {
                sides_[{triangles[t][k], triangles[t][(k + 1) % 3]}] = {t, k};
            }
        }
    }

    void run() {
        for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
            if (has_no_area(corners_, triangles_[t])) open_.push_back(t);
        }
        while (!open_.empty()) {
            const std::uint32_t t = open_.back();
            open_.pop_back();
            for (unsigned k = 0; k < 3; ++k) {
                if (!is_marked(t, k) && is_covered(t, k)) mark(t, k);
            }
        }
    }

private:
    [[nodiscard]] const glm::dvec3& at(std::uint32_t t, unsigned k) const {
        return corners_[triangles_[t][k % 3]];
    }
    [[nodiscard]] bool is_marked(std::uint32_t t, unsigned k) const {
        return (bits_[t] >> (k % 3) & 1) != 0;
    }

    /// Whether marked sides of a triangle without area cover its side k.
    [[nodiscard]] bool is_covered(std::uint32_t t, unsigned k) const {
        const glm::dvec3 side = at(t, k + 1) - at(t, k), to_apex = at(t, k + 2) - at(t, k);
        const double apex = glm::dot(to_apex, side), end = glm::dot(side, side);
        const bool from_end = is_marked(t, k + 1), from_begin = is_marked(t, k + 2);
        if (apex <= 0) return from_end;
        return from_begin && (apex >= end || from_end);
    }

    /// And on the other side of it.
    void mark(std::uint32_t t, unsigned k) {
        bits_[t] |= static_cast<std::uint8_t>(1u << k);
        open_.push_back(t);
        const auto twin = sides_.find({triangles_[t][(k + 1) % 3], triangles_[t][k]});
        if (twin == sides_.end()) return;
        const auto [other, side] = twin->second;
        bits_[other] |= static_cast<std::uint8_t>(1u << side);
        if (has_no_area(corners_, triangles_[other])) open_.push_back(other);
    }

    std::span<const glm::dvec3> corners_;
    std::span<const PolygonTriangle> triangles_;
    std::vector<std::uint8_t>& bits_;
    std::vector<std::uint32_t> open_;  // triangles without area, to be looked at again
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<std::uint32_t, unsigned>> sides_;
};

}  // namespace

std::uint8_t polygon_edge_bits(const PolygonTriangle& triangle, std::uint32_t n) {
    unsigned bits = 0;
    for (unsigned k = 0; k < 3; ++k) {
        const std::uint32_t from = triangle[k], to = triangle[(k + 1) % 3];
        if ((from + 1 == n ? 0 : from + 1) == to) bits |= 1u << k;
    }
    return static_cast<std::uint8_t>(bits);
}

void find_polygon_edges(std::span<const glm::dvec3> corners,
                        std::span<const PolygonTriangle> triangles,
                        std::vector<std::uint8_t>& bits) {
    bits.clear();
    for (const PolygonTriangle& t : triangles) {
        bits.push_back(polygon_edge_bits(t, static_cast<std::uint32_t>(corners.size())));
    }
    const bool all_have_area = std::ranges::none_of(
        triangles, [&](const PolygonTriangle& t) { return has_no_area(corners, t); });
    if (!all_have_area) MarkPasser(corners, triangles, bits).run();
}

}  // namespace sightline::load
