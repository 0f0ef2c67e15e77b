// A general quadric through a lattice, tetrahedron by tetrahedron.
//
// Source: A. Doi, A. Koide, "An Efficient Method of Triangulating Equi-Valued Surfaces by Using
// Tetrahedral Cells", 1991; the six tetrahedra around the diagonal of a cell are those of
// H. Freudenthal, 1942, and agree between neighbouring cells. How this version differs: along a
// line a quadric is a quadratic, so every vertex lies on the surface and not between two samples.
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <unordered_map>
#include <utility>

#include "scene/quadric_mesh.hpp"

namespace sightline {
namespace {

class Marcher {
public:
    Marcher(const Quadric& quadric, std::uint32_t cells)
        : quadric_(quadric), cells_(cells), side_(cells + 1) {
        values_.reserve(std::size_t{side_} * side_ * side_);
        for (std::uint32_t n = 0; n < side_ * side_ * side_; ++n)
            values_.push_back(quadric.value_at(node(n)));
    }

    QuadricMesh run() {
        // The ways from the lowest to the highest corner of a cell, one axis after another.
        constexpr std::array<std::array<unsigned, 2>, 6> kWays = {
            {{1, 3}, {1, 5}, {2, 3}, {2, 6}, {4, 5}, {4, 6}}};
        for (std::uint32_t z = 0; z < cells_; ++z)
            for (std::uint32_t y = 0; y < cells_; ++y)
                for (std::uint32_t x = 0; x < cells_; ++x)
                    for (const auto& way : kWays)
                        tetrahedron({corner(x, y, z, 0), corner(x, y, z, way[0]),
                                     corner(x, y, z, way[1]), corner(x, y, z, 7)});
        return std::move(mesh_);
    }

private:
    /// Bit k of `which`: the far side along axis k.
    [[nodiscard]] std::uint32_t corner(std::uint32_t x, std::uint32_t y, std::uint32_t z,
                                       unsigned which) const {
        return ((z + (which >> 2 & 1u)) * side_ + y + (which >> 1 & 1u)) * side_ + x + (which & 1u);
    }

    [[nodiscard]] glm::dvec3 node(std::uint32_t n) const {
        const glm::dvec3 share = glm::dvec3(n % side_, n / side_ % side_, n / side_ / side_) /
                                 static_cast<double>(cells_);
        return quadric_.clip.lo + share * quadric_.clip.extent();
    }

    [[nodiscard]] bool negative(std::uint32_t n) const { return values_[n] < 0; }

    void tetrahedron(const std::array<std::uint32_t, 4>& nodes) {
        std::array<std::uint32_t, 4> in{}, out{};
        std::size_t ins = 0, outs = 0;
        for (const std::uint32_t n : nodes) (negative(n) ? in[ins++] : out[outs++]) = n;
        if (ins == 1)
            triangle(crossing(in[0], out[0]), crossing(in[0], out[1]), crossing(in[0], out[2]));
        if (ins == 3)
            triangle(crossing(in[0], out[0]), crossing(in[1], out[0]), crossing(in[2], out[0]));
        if (ins != 2) return;
        const std::uint32_t a = crossing(in[0], out[0]), b = crossing(in[0], out[1]),
                            c = crossing(in[1], out[1]), d = crossing(in[1], out[0]);
        triangle(a, b, c);
        triangle(a, c, d);
    }

    /// Where the surface crosses the line between a negative node and another.
    std::uint32_t crossing(std::uint32_t in, std::uint32_t out) {
        const std::uint64_t key = std::uint64_t{std::min(in, out)} << 32 | std::max(in, out);
        const auto fresh = static_cast<std::uint32_t>(mesh_.points.size());
        const auto [entry, is_new] = crossings_.try_emplace(key, fresh);
        if (is_new) mesh_.points.push_back(point_between(in, out));
        return entry->second;
    }

    /// The values at both ends and in the middle determine the quadratic; its root is found from
    /// the formula that does not cancel. The value is < 0 at t = 0 and >= 0 at t = 1.
    [[nodiscard]] glm::dvec3 point_between(std::uint32_t in, std::uint32_t out) const {
        const glm::dvec3 p = node(in), w = node(out) - p;
        const double c = values_[in], end = values_[out];
        const double b = 0.5 * glm::dot(quadric_.gradient_at(p), w);
        const double a = end - c - 2 * b;
        const double root = std::sqrt(std::max(0.0, b * b - a * c));
        // a t^2 + 2 b t + c = 0 rises through 0 once on the way.
        const double t = b > 0 ? -c / (b + root) : (root - b) / a;
        return p + (t >= 0 && t <= 1 ? t : c / (c - end)) * w;
    }

    /// Turned so that its front is where the polynomial grows.
    void triangle(std::uint32_t i, std::uint32_t j, std::uint32_t k) {
        const glm::dvec3 &a = mesh_.points[i], &b = mesh_.points[j], &c = mesh_.points[k];
        const glm::dvec3 gradient = quadric_.gradient_at((a + b + c) / 3.0);
        if (glm::dot(glm::cross(b - a, c - a), gradient) < 0) std::swap(j, k);
        mesh_.triangles.emplace_back(i, j, k);
    }

    const Quadric& quadric_;
    std::uint32_t cells_, side_;
    std::vector<double> values_;
    std::unordered_map<std::uint64_t, std::uint32_t> crossings_;
    QuadricMesh mesh_;
};

}  // namespace

QuadricMesh march_quadric(const Quadric& quadric, std::uint32_t cells) {
    return Marcher(quadric, cells).run();
}

}  // namespace sightline
