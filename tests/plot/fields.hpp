// Surfaces for tests of plots.
#pragma once

#include <string>
#include <vector>

#include "plot/field.hpp"
#include "support/scenes.hpp"

namespace sightline::testing {

/// Of an equation, or of an expression in x, y and z.
inline Field field(const std::string& text) {
    if (text.find('=') == std::string::npos) return field_of(must(Expression::parse(text)), text);
    return field_of(must(parse_formula(text)).value, text);
}

inline const std::string kSphere = "x^2 + y^2 + z^2 = 1";
inline const std::string kTorus = "(sqrt(x^2 + z^2) - 2)^2 + y^2 = 0.5";

inline Box cube(double half) { return {glm::dvec3(-half), glm::dvec3(half)}; }

inline std::vector<double> planes(double half, int count) {
    std::vector<double> at;
    for (int k = 0; k < count; ++k) at.push_back(half * (2.0 * k / (count - 1) - 1));
    return at;
}

}  // namespace sightline::testing
