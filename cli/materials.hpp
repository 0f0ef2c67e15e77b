// Changing how a loaded scene looks: --opacity and --holdout.
#pragma once

#include <string>
#include <vector>

#include "options.hpp"
#include "sightline/scene.hpp"

namespace sightline::cli {

/// One --opacity: of a material or an object, or of everything when the name is empty.
struct OpacityRule {
    std::string name;
    float opacity = 1;
};

[[nodiscard]] std::vector<OpacityRule> read_opacity(OptionReader& reader);

/// Applies rules in order. Error (bad_option): a name that no material and no object has.
[[nodiscard]] Status apply_opacity(Scene& scene, const std::vector<OpacityRule>& rules);

/// --holdout: materials and objects that hide what is behind them and are left out themselves.
/// Error (bad_option): as of apply_opacity().
[[nodiscard]] Status apply_holdouts(Scene& scene, const std::vector<std::string>& names);

}  // namespace sightline::cli
