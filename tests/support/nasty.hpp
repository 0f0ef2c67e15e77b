// Scenes made to be nasty: what algorithms that decide for areas and stretches at once get wrong.
#pragma once

#include <string_view>
#include <vector>

#include "support/scenes.hpp"

namespace sightline::testing {

struct NastyScene {
    std::string_view name;
    Scene scene;
    bool entangled = false;  ///< nearly every polygon crosses nearly every other one
};

/// Deterministic; each has some hundred to some thousand triangles in [-1, 1]^3.
[[nodiscard]] std::vector<NastyScene> nasty_scenes();

/// A view along -z of [-1, 1]^2, so that x and y of the scene are those of the page.
[[nodiscard]] Camera page_camera(const Scene& scene, Resolution resolution);

}  // namespace sightline::testing
