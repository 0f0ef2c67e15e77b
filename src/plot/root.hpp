// A root of a field on a line.
#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "plot/field.hpp"

namespace sightline {

/// A piece of a line whose ends have different signs; 0 counts as positive.
struct Bracket {
    glm::dvec3 from{}, to{};
    double at_from = 0, at_to = 0;  ///< finite
};

/// Where on the piece, 0..1, the field is 0, as exactly as doubles allow. Nothing where it changes
/// its sign without being 0: at a pole or a jump. Values up to `noise` count as rounding.
[[nodiscard]] std::optional<double> find_root(Evaluator& value, const Bracket& bracket,
                                              double noise);

/// A size of values that is usual in a sample: the lower quartile of the finite ones that are not
/// 0; 0 when there are none.
[[nodiscard]] double usual_size(Evaluator& value, glm::dvec3 lo, glm::dvec3 hi);

/// Values below this part of the usual size are rounding.
inline constexpr double kNoise = 1e-12;

}  // namespace sightline
