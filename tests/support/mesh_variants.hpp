// One solid, written down in the ways in which files have it: faces there twice or once for each
// side, faces that do not share their vertices, corners that differ in their last bits.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "support/scenes.hpp"

namespace sightline::testing {

/// A polygon with its corners, and the face of the clean solid that it is or is a part of.
struct PlainFace {
    std::vector<glm::dvec3> corners;
    std::uint32_t origin = 0;
};
using Solid = std::vector<PlainFace>;

/// Fronts outside.
[[nodiscard]] Solid box_solid(glm::dvec3 lo, glm::dvec3 hi);
/// A right prism over a star of 2n corners: not convex for n > 2.
[[nodiscard]] Solid star_solid(std::uint32_t n, double inner, double height);
[[nodiscard]] Solid torus_solid(double radius, double tube, std::uint32_t around,
                                std::uint32_t across);

enum class Variant { clean, doubled, both_sides, perturbed, perturbed_twice, t_junctions };
inline constexpr Variant kVariants[] = {Variant::clean,           Variant::doubled,
                                        Variant::both_sides,      Variant::perturbed,
                                        Variant::perturbed_twice, Variant::t_junctions};
[[nodiscard]] std::string name_of(Variant variant);

/// Copies begin at any corner and stand before or after what they copy. Perturbed corners are off
/// by less than half of kWeldTolerance. T-junctions are only inside of faces of four corners: the
/// edges of the solid stay whole.
[[nodiscard]] Solid varied(const Solid& clean, Variant variant, Random& random);

/// One object of one grey material; every face has positions of its own. Not finished.
[[nodiscard]] Scene scene_of(const Solid& solid);

}  // namespace sightline::testing
