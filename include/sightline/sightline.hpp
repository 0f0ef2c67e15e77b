// Everything of the library: scene, camera, canonical screen scene, visibility, order, shading,
// pictures and how they are joined, drawings.
#pragma once

#include "sightline/bsp.hpp"           // IWYU pragma: export
#include "sightline/camera.hpp"        // IWYU pragma: export
#include "sightline/composite.hpp"     // IWYU pragma: export
#include "sightline/drawing.hpp"       // IWYU pragma: export
#include "sightline/error.hpp"         // IWYU pragma: export
#include "sightline/formula.hpp"       // IWYU pragma: export
#include "sightline/fragments.hpp"     // IWYU pragma: export
#include "sightline/height_map.hpp"    // IWYU pragma: export
#include "sightline/image.hpp"         // IWYU pragma: export
#include "sightline/load.hpp"          // IWYU pragma: export
#include "sightline/order.hpp"         // IWYU pragma: export
#include "sightline/plot.hpp"          // IWYU pragma: export
#include "sightline/scene.hpp"         // IWYU pragma: export
#include "sightline/screen_scene.hpp"  // IWYU pragma: export
#include "sightline/sections.hpp"      // IWYU pragma: export
#include "sightline/shading.hpp"       // IWYU pragma: export
#include "sightline/stream.hpp"        // IWYU pragma: export
#include "sightline/vector.hpp"        // IWYU pragma: export
#include "sightline/visibility.hpp"    // IWYU pragma: export
