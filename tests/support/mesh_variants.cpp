#include "support/mesh_variants.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sightline::testing {
namespace {

double radius_of(const Solid& solid) {
    glm::dvec3 lo(1e300), hi(-1e300);
    for (const PlainFace& face : solid)
        for (const glm::dvec3& p : face.corners) {
            lo = glm::min(lo, p);
            hi = glm::max(hi, p);
        }
    return 0.5 * glm::distance(lo, hi);
}

/// The face as another program might write it down once more.
PlainFace copy_of(PlainFace face, bool turned, Random& random) {
    if (turned) std::ranges::reverse(face.corners);
    const auto n = static_cast<std::uint32_t>(face.corners.size());
    std::rotate(face.corners.begin(), face.corners.begin() + random.below(n), face.corners.end());
    return face;
}

Solid with_copies(const Solid& clean, bool turned, Random& random) {
    Solid all = clean;
    for (const PlainFace& face : clean) all.push_back(copy_of(face, turned, random));
    for (std::size_t k = 0; k < clean.size(); ++k)
        if (random.chance(0.5)) std::swap(all[k], all[clean.size() + k]);
    return all;
}

Solid perturbed(Solid solid, Random& random) {
    const double reach = 0.45 * kWeldTolerance * radius_of(solid) / std::sqrt(3.0);
    for (PlainFace& face : solid)
        for (glm::dvec3& p : face.corners) p += random.point(reach);
    return solid;
}

/// A frame of four quads around columns that are divided into rows, each for itself.
void divide(const PlainFace& face, Random& random, Solid& to) {
    const auto& c = face.corners;
    const auto at = [&](double s, double t) {
        return (1 - t) * ((1 - s) * c[0] + s * c[1]) + t * ((1 - s) * c[3] + s * c[2]);
    };
    const auto quad = [&](double s0, double t0, double s1, double t1) {
        to.push_back({{at(s0, t0), at(s1, t0), at(s1, t1), at(s0, t1)}, face.origin});
    };
    const double lo = random.uniform(0.1, 0.3), hi = random.uniform(0.6, 0.9);
    to.push_back({{c[0], c[1], at(hi, lo), at(lo, lo)}, face.origin});
    to.push_back({{c[1], c[2], at(hi, hi), at(hi, lo)}, face.origin});
    to.push_back({{c[2], c[3], at(lo, hi), at(hi, hi)}, face.origin});
    to.push_back({{c[3], c[0], at(lo, lo), at(lo, hi)}, face.origin});
    const std::uint32_t columns = 2 + random.below(3);
    const auto part = [&](std::uint32_t k, std::uint32_t n) { return lo + (hi - lo) * k / n; };
    for (std::uint32_t k = 0; k < columns; ++k) {
        const std::uint32_t rows = 1 + random.below(4);
        for (std::uint32_t r = 0; r < rows; ++r)
            quad(part(k, columns), part(r, rows), part(k + 1, columns), part(r + 1, rows));
    }
}

}  // namespace

Solid box_solid(glm::dvec3 lo, glm::dvec3 hi) {
    const auto at = [&](int k) {
        return glm::dvec3((k & 1) != 0 ? hi.x : lo.x, (k & 2) != 0 ? hi.y : lo.y,
                          (k & 4) != 0 ? hi.z : lo.z);
    };
    constexpr int kQuads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                  {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    Solid solid;
    for (const auto& q : kQuads)
        solid.push_back(
            {{at(q[0]), at(q[1]), at(q[2]), at(q[3])}, static_cast<std::uint32_t>(solid.size())});
    return solid;
}

Solid star_solid(std::uint32_t n, double inner, double height) {
    const auto at = [&](std::uint32_t k, double z) {
        const double angle = std::acos(-1.0) * k / n, r = k % 2 == 0 ? 1 : inner;
        return glm::dvec3(r * std::cos(angle), r * std::sin(angle), z);
    };
    Solid solid;
    const auto add = [&](std::vector<glm::dvec3> corners) {
        solid.push_back({std::move(corners), static_cast<std::uint32_t>(solid.size())});
    };
    for (std::uint32_t k = 0; k < 2 * n; ++k) {
        const std::uint32_t next = (k + 1) % (2 * n);
        add({at(k, 0), at(next, 0), at(next, height), at(k, height)});
        // The lids as triangles around their middles.
        add({glm::dvec3(0, 0, height), at(k, height), at(next, height)});
        add({glm::dvec3(0, 0, 0), at(next, 0), at(k, 0)});
    }
    return solid;
}

Solid torus_solid(double radius, double tube, std::uint32_t around, std::uint32_t across) {
    const double turn = 2 * std::acos(-1.0);
    const auto at = [&](std::uint32_t a, std::uint32_t c) {
        const double u = turn * (a % around) / around, v = turn * (c % across) / across;
        const double r = radius + tube * std::cos(v);
        return glm::dvec3(r * std::cos(u), r * std::sin(u), tube * std::sin(v));
    };
    Solid solid;
    for (std::uint32_t a = 0; a < around; ++a)
        for (std::uint32_t c = 0; c < across; ++c)
            solid.push_back({{at(a, c), at(a + 1, c), at(a + 1, c + 1), at(a, c + 1)},
                             static_cast<std::uint32_t>(solid.size())});
    return solid;
}

std::string name_of(Variant variant) {
    constexpr const char* kNames[] = {"clean",     "doubled",         "both sides",
                                      "perturbed", "perturbed twice", "T-junctions"};
    return kNames[static_cast<int>(variant)];
}

Solid varied(const Solid& clean, Variant variant, Random& random) {
    switch (variant) {
        case Variant::clean:
            break;
        case Variant::doubled:
            return with_copies(clean, false, random);
        case Variant::both_sides:
            return with_copies(clean, true, random);
        case Variant::perturbed:
            return perturbed(clean, random);
        case Variant::perturbed_twice:
            return perturbed(with_copies(clean, random.chance(0.5), random), random);
        case Variant::t_junctions: {
            Solid solid;
            for (const PlainFace& face : clean) {
                if (face.corners.size() == 4)
                    divide(face, random, solid);
                else
                    solid.push_back(face);
            }
            return solid;
        }
    }
    return clean;
}

Scene scene_of(const Solid& solid) {
    Scene scene = SceneBuilder().scene;
    for (const PlainFace& face : solid) {
        const auto base = static_cast<std::uint32_t>(scene.positions.size());
        const auto n = static_cast<std::uint32_t>(face.corners.size());
        for (const glm::dvec3& p : face.corners) scene.positions.push_back(p);
        for (std::uint32_t k = 1; k + 1 < n; ++k) {
            scene.triangles.emplace_back(base, base + k, base + k + 1);
            scene.triangle_polygon.push_back(scene.objects[0].polygon_count);
            scene.polygon_edges.push_back(
                static_cast<std::uint8_t>((k == 1 ? 1 : 0) | 2 | (k + 2 == n ? 4 : 0)));
        }
        ++scene.objects[0].polygon_count;
    }
    scene.objects[0].triangle_count = scene.triangle_count();
    return scene;
}

}  // namespace sightline::testing
