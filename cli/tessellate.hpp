// Triangles for the algorithms that take nothing else.
#pragma once

#include <string_view>

#include "progress.hpp"
#include "sightline/scene.hpp"

namespace sightline::cli {

/// Tessellates the quadrics of a scene, if it has any, and says so in one line unless `quiet`.
/// `who` begins the line, as in "'warnock' takes triangles only".
void tessellate_for(std::string_view who, Scene& scene, bool quiet, Progress& progress);

}  // namespace sightline::cli
